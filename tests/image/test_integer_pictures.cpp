// Pictures of integers as textures and as radiance: what each value of a file means, 16 bits among
// them, and how much of a small file is believed.
#include <gtest/gtest.h>

#include <cmath>

#include "common/image/codecs/image_codec.h"
#include "common/scene/load/files/images/texture_store.h"
#include "common/texture/sample_texture.h"
#include "load/mesh_bytes.h"
#include "load/png_bytes.h"
#include "temp_folder.h"

namespace pt {
namespace {

constexpr int grey = 0, rgb = 2, palette = 3, grey_alpha = 4, rgba = 6;  // colour types of PNG

float from_srgb(double code) {
  return static_cast<float>(code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4));
}

std::string bytes_of(const Bytes& bytes) {
  MeshBytes out;
  return put_bytes(out, bytes).text;
}

struct Picture {
  const char* what;
  std::string file;
  std::vector<double> first;  ///< R, G, B, A of the first texel, as shares of white
  bool is_float = false;      ///< as a texture
};

std::vector<Picture> pictures() {
  const auto png = [](int depth, int type, const Bytes& row, const std::string& more = "") {
    return png_file(1, 1, depth, type, bytes_of(row), more);
  };
  const double fine = 0x1234 / 65535.0, other = 0xfedc / 65535.0, third = 0x0001 / 65535.0;
  const std::string colors =
      png_chunk("PLTE", bytes_of({1, 2, 3, 10, 128, 250})) + png_chunk("tRNS", bytes_of({9, 51}));
  return {
      {"grey, 1 bit", png(1, grey, {0x80}), {1, 1, 1, 1}},
      {"grey, 2 bits", png(2, grey, {0x80}), {2 / 3.0, 2 / 3.0, 2 / 3.0, 1}},
      {"grey, 4 bits", png(4, grey, {0x50}), {1 / 3.0, 1 / 3.0, 1 / 3.0, 1}},
      {"grey, 8 bits", png(8, grey, {51}), {0.2, 0.2, 0.2, 1}},
      {"grey, 16 bits", png(16, grey, {0x12, 0x34}), {fine, fine, fine, 1}, true},
      {"grey and alpha", png(8, grey_alpha, {51, 102}), {0.2, 0.2, 0.2, 0.4}},
      {"grey and alpha, 16 bits",
       png(16, grey_alpha, {0x12, 0x34, 0xfe, 0xdc}),
       {fine, fine, fine, other},
       true},
      {"palette with alpha",
       png(8, palette, {1}, colors),
       {10 / 255.0, 128 / 255.0, 250 / 255.0, 0.2}},
      {"rgb", png(8, rgb, {51, 102, 255}), {0.2, 0.4, 1, 1}},
      {"rgb, 16 bits", png(16, rgb, {0x12, 0x34, 0xfe, 0xdc, 0, 1}), {fine, other, third, 1}, true},
      {"rgba", png(8, rgba, {51, 102, 255, 0}), {0.2, 0.4, 1, 0}},
      {"rgba, 16 bits",
       png(16, rgba, {0x12, 0x34, 0xfe, 0xdc, 0, 1, 0x12, 0x34}),
       {fine, other, third, fine},
       true},
      {"rgba, 16 bits in alpha alone",
       png(16, rgba, {51, 51, 102, 102, 255, 255, 0x12, 0x34}),
       {0.2, 0.4, 1, fine},
       true},
      {"16 bits that are 8", png(16, rgba, {51, 51, 102, 102, 255, 255, 0, 0}), {0.2, 0.4, 1, 0}},
      {"a colour that is transparent, 16 bits",
       png(16, rgb, {0x12, 0x34, 0xfe, 0xdc, 0, 1},
           png_chunk("tRNS", bytes_of({0x12, 0x34, 0xfe, 0xdc, 0, 1}))),
       {fine, other, third, 0},
       true},
      {"ppm", "P6 1 1 255\n" + bytes_of({51, 102, 255}), {0.2, 0.4, 1, 1}},
      {"ppm, 16 bits",
       "P6 1 1 65535\n" + bytes_of({0x12, 0x34, 0xfe, 0xdc, 0, 1}),
       {fine, other, third, 1},
       true},
      {"pgm, 10 bits",
       "P5 1 1 1023\n" + bytes_of({1, 0}),
       {256 / 1023.0, 256 / 1023.0, 256 / 1023.0, 1},
       true},
      {"tga",
       bytes_of({0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 32, 0x28, 255, 102, 51, 102}),
       {0.2, 0.4, 1, 0.4}},
      {"tga, grey",
       bytes_of({0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 8, 0x20, 51}),
       {0.2, 0.2, 0.2, 1}},
  };
}

/// The colour and alpha of the first texel, as a scene gets them.
struct Shown {
  Color color;
  float alpha;
  bool is_float;
};
Shown shown(const std::string& file, TextureFormat format) {
  std::vector<Texture> textures;
  std::vector<std::byte> texels;
  TextureStore store(textures, texels);
  store.add_memory("P5 1 1 255\nx", "another", {});  // so that offsets are not 0
  Texture look;
  look.format = format;
  look.color0 = Color(0.5f);
  const std::uint32_t color = store.add_memory(file, "picture", look);
  const std::uint32_t alpha = store.add_alpha_of(color);
  const Vec2 middle(0.5f);
  return {2.0f * sample_texture(textures.at(color), texels.data(), middle),
          alpha == no_texture ? 1.0f : sample_texture(textures.at(alpha), texels.data(), middle).x,
          textures.at(color).format == TextureFormat::rgb32f};
}

TEST(IntegerPictures, AreWhatTheirFilesSay) {
  for (const Picture& picture : pictures()) {
    SCOPED_TRACE(picture.what);
    const Shown plain = shown(picture.file, TextureFormat::linear8);
    const Shown curved = shown(picture.file, TextureFormat::srgb8);
    const Image radiance = decode_radiance_image(picture.file, "x");
    EXPECT_EQ(plain.is_float, picture.is_float);
    EXPECT_EQ(curved.is_float, picture.is_float);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(plain.color[i], picture.first[i], 5e-6);  // 10 bits are brought to 16
      // 8 bits are decoded by a polynomial (sample_texture.h).
      EXPECT_NEAR(curved.color[i], from_srgb(picture.first[i]), picture.is_float ? 5e-6 : 1e-5);
      EXPECT_NEAR(radiance.rgb[i], from_srgb(picture.first[i]), 5e-6);
    }
    EXPECT_NEAR(plain.alpha, picture.first[3], 1e-6);
    EXPECT_NEAR(curved.alpha, picture.first[3], 1e-6);
  }
}

TEST(IntegerPictures, GreyOnesOfSixteenBitsAreFineAsWell) {
  const std::string file =
      png_file(1, 1, 16, rgba, bytes_of({0x12, 0x34, 0xfe, 0xdc, 0, 1, 0x40, 0}));
  const double r = 0x1234 / 65535.0, g = 0xfedc / 65535.0, b = 1 / 65535.0;
  struct Case {
    Color weights;
    double expected;
  };
  for (const Case& c : {Case{{1, 0, 0}, r}, Case{{0, 1, 0}, g}, Case{{0, 0, 1}, b},
                        Case{{0.25f, 0.5f, 0.25f}, 0.25 * r + 0.5 * g + 0.25 * b}}) {
    const TextureImage image =
        grey_image(decode_texture_image(file, "x", TextureFormat::linear8), c.weights);
    Color texel;
    ASSERT_EQ(image.texels.size(), sizeof texel);
    std::memcpy(&texel, image.texels.data(), sizeof texel);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(texel[i], c.expected, 1e-6);
    ASSERT_EQ(image.alpha.size(), 1u);
    EXPECT_NEAR(image.alpha[0], 0x4000 / 65535.0, 1e-6);
  }
}

TEST(IntegerPictures, NormalsOfSixteenBitsAreKnownFromHeights) {
  std::vector<Texture> textures;
  std::vector<std::byte> texels;
  TextureStore store(textures, texels);
  Texture look;
  look.format = TextureFormat::linear8;
  const auto add = [&](const Bytes& row, const char* name) {
    return store.add_memory(png_file(1, 1, 16, rgb, bytes_of(row)), name, look);
  };
  EXPECT_TRUE(store.is_normal_map(add({0x80, 1, 0x7f, 2, 0xff, 0xfe}, "normals")));
  EXPECT_FALSE(store.is_normal_map(add({0x80, 1, 0x80, 1, 0x80, 1}, "heights")));
}

TEST(IntegerPictures, RowsBeginAtTheHead) {
  const std::string file = png_file(1, 2, 16, grey, bytes_of({0x12, 0x34, 0xfe, 0xdc}));
  const TextureImage image = decode_texture_image(file, "x", TextureFormat::linear8);
  float first = 0;
  std::memcpy(&first, image.texels.data(), sizeof first);
  EXPECT_NEAR(first, 0x1234 / 65535.0, 1e-6);
  EXPECT_NEAR(decode_radiance_image(file, "x").rgb[0], from_srgb(0x1234 / 65535.0), 1e-6);
}

TEST(PictureLimits, AreOfPixelsAndOfMemory) {
  const auto check = [](std::int64_t width, std::int64_t height, std::size_t bytes) {
    check_image_size({width, height, 0, 0}, bytes);
  };
  check(65535, 1, 1);
  check(16384, 16384, 1);
  check(32768, 32768, 1u << 22);  // 256 pixels a byte
  expect_error([&] { check(16385, 16384, 1); },
               "16385x16384 pixels in 1 bytes; expected at most "
               "2^28 (16384x16384), or 256 for each byte");
  expect_error([&] { check(32768, 32768, (1u << 22) - 1); }, "expected at most 2^28");
  expect_error([&] { check(65536, 1, 1u << 30); }, "sides of 1 to 65535");
  expect_error(
      [&] {
        check_image_size({100, 100, 0, 1e18}, 10000);
      },
      "not enough memory: an image of 100x100 pixels needs");
}

TEST(PictureLimits, HoldForEveryFormat) {
  // Little files that would become gigabytes, whose formats allow it.
  const std::string bits = png_file(20000, 20000, 1, grey, std::string(20000 * 2500, '\0'));
  EXPECT_LT(bits.size(), 60000u);
  const std::string limit = "expected at most 2^28";
  expect_error([&] { decode_texture_image(bits, "x"); }, limit);
  expect_error([&] { decode_radiance_image(bits, "x"); }, limit);
  for (const char* header :
       {"P6 65535 65535 255\n", "P5 65535 65535 65535\n", "PF 65535 65535 -1\n"}) {
    expect_error([&] { decode_texture_image(header, "x"); }, "truncated");
  }
  MeshBytes tga;
  put_bytes(tga, {0, 0, 10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x20, 0x4e, 0x20, 0x4e, 24, 0});
  for (int i = 0; i < 300'000; ++i) put_bytes(tga, {0xff, 1, 2, 3});  // runs of 128
  expect_error([&] { decode_texture_image(tga.text, "x"); }, "20000x20000 pixels");
}

// A PFM of one number for each pixel, from its foot.
TEST(IntegerPictures, GreyPfm) {
  std::string bytes = "Pf\n1 2\n-1\n";
  for (const float v : {0.25f, 2.0f}) bytes.append(reinterpret_cast<const char*>(&v), sizeof v);
  EXPECT_EQ(decode_radiance_image(bytes, "x").rgb,
            (std::vector<float>{2, 2, 2, 0.25f, 0.25f, 0.25f}));
}

// OpenEXR allocates a table of all tiles before it reads one.
TEST(PictureLimits, HoldForTheTilesOfAnExr) {
  const TempFolder folder;
  write_image(folder.file("a.exr"), Image{1, 1, {1, 1, 1}}, {});
  std::string bytes = read_text(folder.file("a.exr"));
  using namespace std::string_literals;
  const std::string box = "dataWindow\0box2i\0\x10\0\0\0"s;
  bytes.replace(bytes.find(box) + box.size() + 8, 8, "\xff\x1f\0\0\xff\x1f\0\0"s);  // 8192 x 8192
  bytes.insert(bytes.find("compression\0"s), "tiles\0tiledesc\0\x09\0\0\0\1\0\0\0\1\0\0\0\0"s);
  bytes[5] = '\x02';
  expect_error([&] { decode_texture_image(bytes, "x"); }, "cannot hold the 67108864 tiles");
  // Tiles at the rims count, however little of them there is: 2731 x 4096 of 3 x 2 pixels.
  const std::string tiles = "\x09\0\0\0\1\0\0\0\1\0\0\0"s;
  bytes.replace(bytes.find(tiles), tiles.size(), "\x09\0\0\0\3\0\0\0\2\0\0\0"s);
  bytes.replace(bytes.find(box) + box.size() + 8, 8, "\xfe\x1f\0\0\xfe\x1f\0\0"s);  // 8191
  expect_error([&] { decode_texture_image(bytes, "x"); }, "cannot hold the 11186176 tiles");
}

}  // namespace
}  // namespace pt
