// Images for textures: files written here byte by byte, and the store that keeps their texels.
#include <gtest/gtest.h>

#include <cmath>

#include "common/image/codecs/image_io.h"
#include "common/scene/load/files/images/texture_store.h"
#include "common/texture/sample_texture.h"
#include "load/mesh_bytes.h"
#include "temp_folder.h"

namespace pt {
namespace {

Bytes texels_of(const TextureImage& image) {
  Bytes values;
  for (const std::byte b : image.texels) values.push_back(std::to_integer<int>(b));
  return values;
}

/// Two columns, two rows: red, green; blue, (10, 20, 30).
const Bytes corners = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 10, 20, 30, 255};

/// 24 bits, from the foot to the head.
std::string bmp_bytes() {
  MeshBytes bmp;
  bmp.text = "BM";
  bmp.put<std::uint32_t>(54 + 16).put<std::uint32_t>(0).put<std::uint32_t>(54);
  bmp.put<std::uint32_t>(40).put<std::int32_t>(2).put<std::int32_t>(2);
  bmp.put<std::uint16_t>(1).put<std::uint16_t>(24);
  for (int i = 0; i < 6; ++i) bmp.put<std::uint32_t>(0);
  // B G R, rows padded to four bytes
  return put_bytes(bmp, {255, 0, 0, 30, 20, 10, 0, 0, 0, 0, 255, 0, 255, 0, 0, 0}).text;
}

/// 32 bits with alpha, from the head to the foot, run-length encoded if asked for.
std::string tga_bytes(bool encoded) {
  MeshBytes tga;
  put_bytes(tga, {0, 0, encoded ? 10 : 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 32, 0x28});
  if (encoded) return put_bytes(tga, {0x83, 3, 2, 1, 4}).text;  // a run of four
  return put_bytes(tga, {3, 2, 1, 4, 7, 6, 5, 8, 11, 10, 9, 12, 15, 14, 13, 16}).text;
}

/// 8x8 pixels of grey 200, baseline, with Huffman tables of one code each: DC 72, no AC.
std::string jpeg_bytes() {
  MeshBytes jpeg;
  put_bytes(jpeg, {0xff, 0xd8, 0xff, 0xdb, 0, 67, 0});
  for (int i = 0; i < 64; ++i) jpeg.put<std::uint8_t>(8);
  put_bytes(jpeg, {0xff, 0xc0, 0, 11, 8, 0, 8, 0, 8, 1, 1, 0x11, 0});
  put_bytes(jpeg, {0xff, 0xc4, 0, 20, 0x00, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 7});
  put_bytes(jpeg, {0xff, 0xc4, 0, 20, 0x10, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  put_bytes(jpeg, {0xff, 0xda, 0, 8, 1, 1, 0x00, 0, 63, 0});
  return put_bytes(jpeg, {0x48, 0x7f, 0xff, 0xd9}).text;  // 0, 1001000, 0, then ones
}

std::string hdr_bytes() {
  MeshBytes hdr;
  hdr.text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
  return put_bytes(hdr, {128, 64, 32, 129, 200, 0, 0, 136}).text;
}

TEST(ImageFiles, EightBits) {
  const TextureImage bmp = decode_texture_image(bmp_bytes(), "bmp");
  EXPECT_EQ(bmp.format, TextureFormat::srgb8);
  EXPECT_EQ(bmp.width, 2u);
  EXPECT_EQ(bmp.height, 2u);
  EXPECT_EQ(texels_of(bmp), corners);

  const TextureImage tga = decode_texture_image(tga_bytes(false), "t", TextureFormat::linear8);
  EXPECT_EQ(tga.format, TextureFormat::linear8);
  EXPECT_EQ(texels_of(tga), (Bytes{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16}));
  EXPECT_EQ(texels_of(decode_texture_image(tga_bytes(true), "t")),
            (Bytes{1, 2, 3, 4, 1, 2, 3, 4, 1, 2, 3, 4, 1, 2, 3, 4}));

  const TextureImage jpeg = decode_texture_image(jpeg_bytes(), "jpeg");
  ASSERT_EQ(jpeg.texels.size(), 4u * 64);
  for (std::size_t i = 0; i < jpeg.texels.size(); ++i) {
    EXPECT_EQ(std::to_integer<int>(jpeg.texels[i]), i % 4 == 3 ? 255 : 200) << i;
  }
}

TEST(ImageFiles, PngIsReadAsStored) {
  const TempFolder folder;
  Image image{2, 1, {0.0f, 1.0f, 0.5f, 0.2f, 0.003f, 2.0f}};
  write_image(folder.file("a.png"), image, {});
  const TextureImage texture = read_texture_image(folder.file("a.png"));
  // 255 times the sRGB curve, rounded
  EXPECT_EQ(texels_of(texture), (Bytes{0, 255, 188, 255, 124, 10, 255, 255}));
}

TEST(ImageFiles, Floats) {
  const TextureImage hdr = decode_texture_image(hdr_bytes(), "hdr");
  EXPECT_EQ(hdr.format, TextureFormat::rgb32f);
  ASSERT_EQ(hdr.texels.size(), 24u);
  float values[6];
  std::memcpy(values, hdr.texels.data(), 24);
  EXPECT_EQ(std::vector<float>(values, values + 6),
            (std::vector<float>{1, 0.5f, 0.25f, 200, 0, 0}));

  const TempFolder folder;
  const Image image{1, 2, {1, 2, 3, 4, 5, 600000}};
  write_image(folder.file("a.exr"), image, {});
  const TextureImage exr = read_texture_image(folder.file("a.exr"));
  ASSERT_EQ(exr.texels.size(), 24u);
  std::memcpy(values, exr.texels.data(), 24);
  EXPECT_EQ(std::vector<float>(values, values + 6), image.rgb);
}

TEST(ImageFiles, RadianceOfAnyFormat) {
  const Image hdr = decode_radiance_image(hdr_bytes(), "hdr");
  EXPECT_EQ(hdr.width, 2);
  EXPECT_EQ(hdr.rgb, (std::vector<float>{1, 0.5f, 0.25f, 200, 0, 0}));
  const Image bmp = decode_radiance_image(bmp_bytes(), "bmp");
  ASSERT_EQ(bmp.rgb.size(), 12u);
  EXPECT_EQ(bmp.rgb[0], 1.0f);
  EXPECT_NEAR(bmp.rgb[10], std::pow((20 / 255.0 + 0.055) / 1.055, 2.4), 1e-6);
}

TEST(ImageFiles, BrokenFilesAreRefused) {
  const TempFolder folder;
  expect_error([&] { read_texture_image(folder.file("a.png")); }, "a.png: No such file");
  expect_error([&] { decode_texture_image("", "empty.jpg"); }, "cannot read empty.jpg: ");
  expect_error([&] { decode_texture_image("no image at all", "a.jpg"); }, "cannot read a.jpg: ");
  for (const std::string& good :
       {bmp_bytes(), tga_bytes(false), tga_bytes(true), jpeg_bytes(), hdr_bytes()}) {
    for (std::size_t size = 0; size < good.size(); ++size) {
      expect_error([&] { decode_texture_image(good.substr(0, size), "x"); }, "cannot read x: ");
    }
  }
}

TEST(ImageFiles, SizesThatTheFileCannotHoldAreRefused) {
  std::string tga = tga_bytes(true), bmp = bmp_bytes(), jpeg = jpeg_bytes();
  for (const std::size_t i : {12, 13, 14, 15}) tga[i] = '\xff';
  expect_error([&] { decode_texture_image(tga, "x"); }, "cannot hold the 65535x65535 pixels");
  const std::size_t frame = jpeg.find("\xff\xc0");
  for (const std::size_t i : {5, 7}) jpeg[frame + i] = '\xff';
  expect_error([&] { decode_texture_image(jpeg, "x"); }, "cannot hold the 65288x65288");
  bmp[20] = '\x7f';  // the fourth byte of the width
  expect_error([&] { decode_texture_image(bmp, "x"); }, "cannot read x: ");
}

// Found by fuzzing: a table of 16 * 255 codes, where 256 are the most, went past an array of
// stb_image, which had been the decoder.
TEST(ImageFiles, JpegTablesHaveTheirSize) {
  std::string jpeg = jpeg_bytes();
  const std::size_t table = jpeg.find("\xff\xc4");
  for (std::size_t i = 5; i < 21; ++i) jpeg[table + i] = '\xff';
  expect_error([&] { decode_texture_image(jpeg, "x"); }, "cannot read x: ");
}

// Found by fuzzing: runs of length 0, which are what stb_image reads after the end.
TEST(ImageFiles, HdrThatEndsWithinARun) {
  MeshBytes hdr;
  hdr.text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n";
  put_bytes(hdr, {2, 2, 0, 8, 0x88, 64, 0x88, 64, 4, 0, 1, 2, 3, 0, 0, 0});
  expect_error([&] { decode_texture_image(hdr.text, "x"); }, "corrupted");
}

class Store : public testing::Test {
 protected:
  Store() { write_text(folder_.file("a.bmp"), bmp_bytes()); }

  const TempFolder folder_;
  std::vector<Texture> textures_;
  std::vector<std::byte> texels_;
  TextureStore store_{textures_, texels_};
};

TEST_F(Store, TheSameFileSharesItsTexels) {
  const std::uint32_t first = store_.add_file(folder_.file("a.bmp"));
  EXPECT_EQ(store_.add_file(folder_.file("./a.bmp")), first);
  Texture clamped;
  clamped.wrap_u = TextureWrap::clamp;
  const std::uint32_t second = store_.add_file(folder_.file("a.bmp"), clamped);
  EXPECT_NE(second, first);
  EXPECT_EQ(textures_.at(second).offset, textures_.at(first).offset);
  EXPECT_EQ(texels_.size(), 16u);
  EXPECT_EQ(store_.add_memory(bmp_bytes(), "image 0", clamped), 2u);
  EXPECT_EQ(store_.add_memory("never decoded again", "image 0", clamped), 2u);
  Texture linear;
  linear.format = TextureFormat::linear8;
  EXPECT_EQ(textures_.at(store_.add_file(folder_.file("a.bmp"), linear)).format,
            TextureFormat::linear8);
  EXPECT_EQ(textures_.size(), 4u);
}

TEST_F(Store, TexelsAreAlignedAndFound) {
  TextureImage tiny{TextureFormat::linear8, 1, 1, std::vector<std::byte>(4, std::byte(51))};
  Texture look;
  look.color0 = Color(2.0f);
  const Texture& one = textures_.at(store_.add_image(tiny, look));
  EXPECT_NEAR(sample_texture(one, texels_.data(), {3, 4}).y, 0.4f, 1e-6f);
  look.filter = TextureFilter::nearest;
  const Texture& file = textures_.at(store_.add_file(folder_.file("a.bmp"), look));
  EXPECT_EQ(file.offset % 16, 0u);
  EXPECT_EQ(sample_texture(file, texels_.data(), {0.1f, 0.9f}), Color(2, 0, 0));
  EXPECT_EQ(sample_texture(file, texels_.data(), {0.1f, 0.1f}), Color(0, 0, 2));

  const Texture hdr = textures_.at(store_.add_memory(hdr_bytes(), "sky"));
  EXPECT_EQ(hdr.format, TextureFormat::rgb32f);
  EXPECT_EQ(sample_texture(hdr, texels_.data(), {0.25f, 0.5f}), Color(1, 0.5f, 0.25f));
}

TEST_F(Store, EqualCheckerboardsAreOne) {
  Texture board;
  board.kind = TextureKind::checkerboard;
  EXPECT_EQ(store_.add_plain(board), 0u);
  board.color1 = Color(0.5f);
  EXPECT_EQ(store_.add_plain(board), 1u);
  EXPECT_EQ(store_.add_plain(board), 1u);
}

}  // namespace
}  // namespace pt
