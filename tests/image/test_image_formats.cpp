// Files that other programs may write: each kind must read as the image that it holds.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/image/codecs/image_io.h"
#include "common/image/codecs/png_codec.h"
#include "temp_folder.h"

namespace pt {
namespace {

float from_srgb(double code) {
  return static_cast<float>(code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4));
}

void expect_near(const Image& image, const std::vector<float>& expected) {
  ASSERT_EQ(image.rgb.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(image.rgb[i], expected[i], 1e-6) << i;
}

struct PngKind {
  int color_type, bit_depth, width, height;
  std::string samples;  ///< packed as in the file
  int interlace = PNG_INTERLACE_NONE;
};

std::string png_bytes(const PngKind& kind) {
  const png_color palette[3] = {{0, 51, 255}, {102, 0, 0}, {255, 255, 255}};
  const png_byte palette_alpha[1] = {7};
  PngWriter writer;
  attempt(writer, [&](png_structp png, png_infop info) {
    png_set_IHDR(png, info, kind.width, kind.height, kind.bit_depth, kind.color_type,
                 kind.interlace, PNG_COMPRESSION_TYPE_BASE, PNG_FILTER_TYPE_BASE);
    if (kind.color_type == PNG_COLOR_TYPE_PALETTE) {
      png_set_PLTE(png, info, palette, 3);
      png_set_tRNS(png, info, palette_alpha, 1, nullptr);
    }
    png_write_info(png, info);
    const auto* samples = reinterpret_cast<png_const_bytep>(kind.samples.data());
    const std::size_t row_bytes = png_get_rowbytes(png, info);
    const int passes = png_set_interlace_handling(png);
    for (int pass = 0; pass < passes; ++pass) {
      for (int y = 0; y < kind.height; ++y) png_write_row(png, samples + y * row_bytes);
    }
    png_write_end(png, info);
  });
  return writer.session.output;
}

Image read_png(const PngKind& kind) {
  const TempFolder folder;
  write_text(folder.file("a.png"), png_bytes(kind));
  return read_image(folder.file("a.png"));
}

TEST(PngFormats, Gray) {
  const float dark = from_srgb(51 / 255.0);
  expect_near(read_png({PNG_COLOR_TYPE_GRAY, 8, 2, 1, "\x33\xff"}), {dark, dark, dark, 1, 1, 1});
  expect_near(read_png({PNG_COLOR_TYPE_GRAY, 1, 3, 1, "\xa0"}), {1, 1, 1, 0, 0, 0, 1, 1, 1});
  const float fine = from_srgb(0x1234 / 65535.0);
  expect_near(read_png({PNG_COLOR_TYPE_GRAY, 16, 1, 1, "\x12\x34"}), {fine, fine, fine});
}

TEST(PngFormats, AlphaIsDropped) {
  const float dark = from_srgb(51 / 255.0);
  expect_near(read_png({PNG_COLOR_TYPE_GRAY_ALPHA, 8, 1, 1, "\x33\x01"}), {dark, dark, dark});
  expect_near(read_png({PNG_COLOR_TYPE_RGBA, 8, 1, 1, {"\x33\xff\x00\x80", 4}}), {dark, 1, 0});
  expect_near(read_png({PNG_COLOR_TYPE_RGBA, 16, 1, 1, {"\x12\x34\xff\xff\x00\x00\x00\x01", 8}}),
              {from_srgb(0x1234 / 65535.0), 1, 0});
}

TEST(PngFormats, SixteenBitRgb) {
  expect_near(read_png({PNG_COLOR_TYPE_RGB, 16, 1, 1, {"\x00\x01\x80\x00\xab\xcd", 6}}),
              {from_srgb(1 / 65535.0), from_srgb(0x8000 / 65535.0), from_srgb(0xabcd / 65535.0)});
}

TEST(PngFormats, Palette) {
  const std::vector<float> expected = {
      0, from_srgb(51 / 255.0), 1, from_srgb(102 / 255.0), 0, 0, 1, 1, 1};
  expect_near(read_png({PNG_COLOR_TYPE_PALETTE, 8, 3, 1, {"\x00\x01\x02", 3}}), expected);
  expect_near(read_png({PNG_COLOR_TYPE_PALETTE, 2, 3, 1, "\x18"}), expected);
}

TEST(PngFormats, InterlacedEqualsPlain) {
  std::string samples(3 * 21 * 13, '\0');
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<char>(i * 7);
  PngKind kind{PNG_COLOR_TYPE_RGB, 8, 21, 13, samples};
  const Image plain = read_png(kind);
  kind.interlace = PNG_INTERLACE_ADAM7;
  EXPECT_EQ(read_png(kind).rgb, plain.rgb);
}

Image read_ppm(const std::string& header, const std::string& samples) {
  const TempFolder folder;
  write_text(folder.file("a.ppm"), header + samples);
  return read_image(folder.file("a.ppm"));
}

TEST(PpmFormats, HeadersWithCommentsAndAnyWhiteSpace) {
  const std::string samples("\x00\x80\xff", 3);
  const float middle = 128.0f * 128.0f / (255.0f * 255.0f);
  for (const char* header : {"P6 1 1 255\n", "P6\n# by hand\n1 1\n255\n",
                             "P6\t1\r\n#\n# 7 7\n1 # width\n255 ", "P6\n0001 1#\n255\n"}) {
    expect_near(read_ppm(header, samples), {0, middle, 1});
  }
  expect_near(read_ppm("P6 1 1 255\n", samples + "the next image"), {0, middle, 1});
  // The first sample may be a byte that looks like white space or a comment.
  expect_near(read_ppm("P6 1 1 255\n", "\n##"), {100 / 65025.0f, 1225 / 65025.0f, 1225 / 65025.0f});
}

TEST(PpmFormats, OtherMaximaAndTwoByteSamples) {
  expect_near(read_ppm("P6 1 1 1\n", {"\x00\x01\x01", 3}), {0, 1, 1});
  expect_near(read_ppm("P6 1 1 100\n", {"\x00\x32\x64", 3}), {0, 0.25f, 1});
  expect_near(read_ppm("P6 1 1 1000\n", {"\x00\x00\x01\xf4\x03\xe8", 6}), {0, 0.25f, 1});
  const double fine = 0x1234 / 65535.0;
  expect_near(read_ppm("P6 1 1 65535\n", {"\x00\x00\x12\x34\xff\xff", 6}),
              {0, static_cast<float>(fine * fine), 1});
}

TEST(PpmFormats, WrongHeaders) {
  const std::pair<const char*, const char*> cases[] = {
      {"P5 1 1 255\n", "not a binary PPM"},
      {"", "not a binary PPM"},
      {"P6", "truncated"},
      {"P6 1 1", "truncated"},
      {"P6 1 1 255", "truncated"},
      {"P6 # no end", "truncated"},
      {"P61 1 255\n", "expected a number"},
      {"P6 x 1 255\n", "expected a number"},
      {"P6 1 -1 255\n", "expected a number"},
      {"P6 0 1 255\n", "width out of range"},
      {"P6 1 65536 255\n", "height out of"},
      {"P6 1 1 65536\n", "maxval out of range"},
      {"P6 1 1 0\n", "maxval out of range"},
      {"P6 99999999999999999999 1 255\n", "width out of"},
      {"P6 1 1 255x", "white space"},
      {"P6 65535 65535 65535\n", "truncated"},
      {"P6 1 1 254\n\xff\xff\xff", "sample 255 exceeds"},
  };
  for (const auto& [text, reason] : cases) {
    expect_error([&, &t = text] { read_ppm(t, ""); }, reason);
  }
}

/// Writes 5x3 pixels at (-7, 9) with the given channels, each of value 1, 2, 3, ... by position.
template <class File = Imf::OutputFile>
Image read_exr(const std::vector<std::pair<std::string, Imf::Channel>>& channels,
               Imf::Compression compression = Imf::ZIP_COMPRESSION) {
  const TempFolder folder;
  const Imath::Box2i display({0, 0}, {99, 99}), window({-7, 9}, {-3, 11});
  Imf::Header header(display, window);
  header.compression() = compression;
  if constexpr (std::is_same_v<File, Imf::TiledOutputFile>) header.setTileDescription({4, 2});
  std::vector<std::vector<std::uint32_t>> data;  // room for any type
  Imf::FrameBuffer buffer;
  for (const auto& [name, channel] : channels) {
    header.channels().insert(name, channel);
    std::vector<std::uint32_t>& values = data.emplace_back(15);
    for (unsigned i = 0; i < 15; ++i) {
      if (channel.type == Imf::UINT) values[i] = i + 1;
      if (channel.type == Imf::FLOAT) values[i] = std::bit_cast<std::uint32_t>(i + 1.0f);
      if (channel.type == Imf::HALF) values[i] = Imath::half(i + 1.0f).bits();
    }
    buffer.insert(name, Imf::Slice::Make(channel.type, values.data(), window, 4, 20,
                                         channel.xSampling, channel.ySampling));
  }
  const std::string path = folder.file("a.exr");
  {
    File file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    if constexpr (std::is_same_v<File, Imf::TiledOutputFile>) {
      file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
      file.writePixels(3);
    }
  }
  return read_image(path);
}

void expect_counting(const Image& image) {
  ASSERT_EQ(image.width, 5);
  ASSERT_EQ(image.height, 3);
  for (int i = 0; i < 45; ++i) EXPECT_EQ(image.rgb[i], i / 3 + 1) << i;
}

const Imf::Channel half_channel(Imf::HALF), float_channel(Imf::FLOAT), uint_channel(Imf::UINT);

TEST(ExrFormats, AnyTypeOfChannelAmongOthers) {
  for (const Imf::Channel& type : {half_channel, float_channel, uint_channel}) {
    expect_counting(read_exr({{"R", type}, {"G", type}, {"B", type}}));
  }
  expect_counting(read_exr({{"A", half_channel},
                            {"R", half_channel},
                            {"G", float_channel},
                            {"B", uint_channel},
                            {"Z", float_channel}}));
}

TEST(ExrFormats, AnyLosslessCompressionAndTiles) {
  for (const Imf::Compression compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::PIZ_COMPRESSION,
        Imf::PXR24_COMPRESSION}) {
    const auto channels = {std::pair<std::string, Imf::Channel>{"R", float_channel},
                           {"G", float_channel},
                           {"B", float_channel}};
    expect_counting(read_exr(channels, compression));
    expect_counting(read_exr<Imf::TiledOutputFile>(channels, compression));
  }
}

// Tiles that are much higher than wide, or wider than high: 64 of them, well packed.
TEST(ExrFormats, TilesOfAnyShape) {
  for (const auto& [width, height] : {std::pair{1u, 64u}, {64u, 1u}}) {
    const TempFolder folder;
    const std::string path = folder.file("a.exr");
    Imf::Header header(64, 64);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.setTileDescription({width, height});
    const std::vector<float> half(64 * 64, 0.5f);
    Imf::FrameBuffer buffer;
    for (const char* channel : {"R", "G", "B"}) {
      header.channels().insert(channel, float_channel);
      buffer.insert(
          channel,
          Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(half.data())), 4, 256));
    }
    {
      Imf::TiledOutputFile file(path.c_str(), header);
      file.setFrameBuffer(buffer);
      file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    }
    const Image image = read_image(path);
    EXPECT_EQ(image.width, 64);
    EXPECT_EQ(image.rgb, std::vector<float>(3 * 64 * 64, 0.5f));
  }
}

TEST(ExrFormats, ChannelsThatAreNotPlainRgb) {
  expect_counting(read_exr({{"Y", half_channel}}));
  expect_counting(read_exr({{"A", half_channel}, {"Y", float_channel}}));
  expect_error(
      [] {
        read_exr({{"Y", half_channel}, {"RY", half_channel}});
      },
      "no channel R, only RY, Y");
  expect_error(
      [] {
        read_exr({{"R", half_channel}, {"B", half_channel}});
      },
      "no channel G, only B, R");
}

}  // namespace
}  // namespace pt
