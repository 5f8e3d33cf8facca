// The pixels of a PNG that all cores compress: zlib and libpng read what was written, it does not
// depend on the number of threads, and it is as small as what libpng writes.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>
#include <zlib.h>

#include <cmath>
#include <random>

#include "common/image/codecs/image_codec.h"
#include "common/image/codecs/png_codec.h"

namespace pt {
namespace {

/// A picture with edges, gradients and noise.
std::string picture(std::size_t width, std::size_t height) {
  std::mt19937 random(7);
  std::string samples;
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const bool is_edge = (x / 40 + y / 30) % 2 == 0;
      const std::size_t noise = y > height / 2 ? random() % 9 : 0;
      samples += static_cast<char>((x * 255 / width + noise) & 255);
      samples += static_cast<char>((is_edge ? 200 : y * 100 / height + noise) & 255);
      samples += static_cast<char>((x * y / 64 + noise) & 255);
    }
  }
  return samples;
}

std::string joined(const std::vector<std::string>& pieces) {
  std::string all;
  for (const std::string& piece : pieces) all += piece;
  return all;
}

/// By one core: libpng's own way.
std::string written_by_libpng(const std::string& samples, std::size_t width, std::size_t height) {
  PngWriter writer;
  attempt(writer, [&](png_structp png, png_infop info) {
    png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8,
                 PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_BASE,
                 PNG_FILTER_TYPE_BASE);
    png_write_info(png, info);
    const auto* row = reinterpret_cast<png_const_bytep>(samples.data());
    for (std::size_t y = 0; y < height; ++y, row += 3 * width) png_write_row(png, row);
    png_write_end(png, info);
  });
  return writer.session.output;
}

struct Size {
  std::size_t width, height;
};

constexpr Size sizes[] = {{1, 1}, {2, 3}, {7, 1}, {1, 500}, {101, 37}, {640, 480}, {1500, 400}};

TEST(PngRows, AreOneStreamOfZlib) {
  for (const auto& [width, height] : sizes) {
    for (const PngCompression& compression : {PngCompression(), PngCompression{1, false},
                                              PngCompression{9, true}, PngCompression{0, true}}) {
      const std::string stream =
          joined(compress_png_rows(picture(width, height), 3 * width, 3, compression));
      std::string filtered((3 * width + 1) * height + 1, '\0');
      uLongf length = filtered.size();
      ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(filtered.data()), &length,
                           reinterpret_cast<const Bytef*>(stream.data()), stream.size()),
                Z_OK)
          << width << "x" << height << ", level " << compression.level;
      EXPECT_EQ(length, filtered.size() - 1);
    }
  }
}

TEST(PngRows, AreReadByLibpng) {
  for (const auto& [width, height] : sizes) {
    const std::string samples = picture(width, height);
    Image image;
    image.width = static_cast<int>(width), image.height = static_cast<int>(height);
    for (const char c : samples) {
      const float x = static_cast<float>(static_cast<unsigned char>(c)) / 255.0f;
      image.rgb.push_back(x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f));
    }
    for (const std::string& bytes :
         {png_codec.encode(image, {{"key", "text"}}, {}), encode_png_fast(image, {})}) {
      const IntegerImage found = decode_png_integers(bytes);
      ASSERT_EQ(found.width, image.width);
      ASSERT_EQ(found.height, image.height);
      for (std::size_t i = 0; i < samples.size(); ++i) {
        ASSERT_EQ(static_cast<char>(found.rgba[i / 3 * 4 + i % 3]), samples[i]) << i;
      }
    }
  }
}

TEST(PngRows, DoNotDependOnTheNumberOfThreads) {
  const std::string samples = picture(1500, 400);
  const auto compress = [&] { return joined(compress_png_rows(samples, 4500, 3, {})); };
  const std::string expected = compress();
  tbb::task_arena one(1), two(2);
  EXPECT_EQ(one.execute(compress), expected);
  EXPECT_EQ(two.execute(compress), expected);
}

TEST(PngRows, AreHardlyLargerThanLibpngs) {
  for (const auto& [width, height] : {Size{640, 480}, Size{1500, 400}}) {
    const std::string samples = picture(width, height);
    const std::string stream = joined(compress_png_rows(samples, 3 * width, 3, {}));
    EXPECT_LE(static_cast<double>(stream.size()),
              1.07 * static_cast<double>(written_by_libpng(samples, width, height).size()));
  }
}

}  // namespace
}  // namespace pt
