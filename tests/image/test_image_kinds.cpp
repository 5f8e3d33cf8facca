// Pictures for textures of rarer kinds: JPEG of four inks, PPM, PGM, PFM.
#include <gtest/gtest.h>

#include <bit>
#include <cstring>

#include "common/scene/load/files/images/image_files.h"
#include "load/mesh_bytes.h"
#include "temp_folder.h"

namespace pt {
namespace {

/// 8x8 equal pixels of four components, 64 to 127 away from 128 each: a Huffman code for DC
/// differences of 7 bits, one for the end of a block. `adobe`: the transform in Adobe's marker, -1:
/// no marker.
std::string four_inks(const Bytes& values, int adobe) {
  MeshBytes jpeg;
  put_bytes(jpeg, {0xff, 0xd8});
  if (adobe >= 0) {
    put_bytes(jpeg, {0xff, 0xee, 0, 14, 'A', 'd', 'o', 'b', 'e', 0, 100, 0, 0, 0, 0, adobe});
  }
  put_bytes(jpeg, {0xff, 0xdb, 0, 67, 0});
  put_bytes(jpeg, Bytes(64, 8));
  put_bytes(jpeg, {0xff, 0xc0, 0, 20, 8, 0, 8, 0, 8, 4});
  for (int i = 1; i <= 4; ++i) put_bytes(jpeg, {i, 0x11, 0});
  put_bytes(jpeg, {0xff, 0xc4, 0, 20, 0x00, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 7});
  put_bytes(jpeg, {0xff, 0xc4, 0, 20, 0x10, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  put_bytes(jpeg, {0xff, 0xda, 0, 14, 4, 1, 0, 2, 0, 3, 0, 4, 0, 0, 63, 0});
  std::uint64_t bits = 0;  // 36 of 40
  for (const int value : values) {
    const int difference = value - 128;
    bits = bits << 9 | static_cast<unsigned>(difference > 0 ? difference : difference + 127) << 1;
  }
  bits = bits << 4 | 15;
  for (int shift = 32; shift >= 0; shift -= 8) {
    const auto byte = static_cast<int>(bits >> shift & 255);
    put_bytes(jpeg, byte == 255 ? Bytes{255, 0} : Bytes{byte});
  }
  return put_bytes(jpeg, {0xff, 0xd9}).text;
}

Bytes first_texel(const std::string& file) {
  const TextureImage image = decode_texture_image(file, "x");
  Bytes values;
  for (int i = 0; i < 4; ++i) values.push_back(std::to_integer<int>(image.texels.at(i)));
  return values;
}

TEST(ImageKinds, JpegOfFourInks) {
  // Pillow 13.0 gives the same for Adobe's, CMYK and YCCK.
  EXPECT_EQ(first_texel(four_inks({200, 40, 196, 230}, 0)), (Bytes{180, 36, 177, 255}));
  EXPECT_EQ(first_texel(four_inks({200, 192, 64, 230}, 2)), (Bytes{131, 28, 0, 255}));
  // Without Adobe's marker, 255 is all of an ink: (255 - c) (255 - k) / 255.
  EXPECT_EQ(first_texel(four_inks({200, 40, 196, 30}, -1)), (Bytes{49, 190, 52, 255}));
  const std::string good = four_inks({200, 40, 196, 230}, 0);
  for (std::size_t size = 0; size < good.size(); ++size) {
    expect_error([&] { decode_texture_image(good.substr(0, size), "x"); }, "cannot read x: ");
  }
}

TEST(ImageKinds, PpmAndPgmAreAsStored) {
  EXPECT_EQ(first_texel(std::string("P6\n# a\n1 1\n255\n") + "\x0a\x80\xff"),
            (Bytes{10, 128, 255, 255}));
  EXPECT_EQ(first_texel("P5 1 1 255\nx"), (Bytes{120, 120, 120, 255}));
  EXPECT_EQ(first_texel(std::string("P5 1 1 65535\n\x80\x80", 15)), (Bytes{128, 128, 128, 255}));
  EXPECT_EQ(first_texel(std::string("P6 1 1 1\n\0\1\1", 12)), (Bytes{0, 255, 255, 255}));
  expect_error([] { decode_texture_image("P6 2 1 255\nabcde", "x"); }, "truncated: 2x1 pixels");
  expect_error([] { decode_texture_image("P5 1 1 7\n\x08", "x"); }, "sample 8 exceeds");
}

std::string pfm(const std::string& header, std::initializer_list<float> values, bool swapped) {
  MeshBytes file;
  file.text = header;
  for (const float value : values) {
    const auto word = std::bit_cast<std::uint32_t>(value);
    file.put(swapped ? __builtin_bswap32(word) : word);
  }
  return file.text;
}

TEST(ImageKinds, PfmBeginsAtTheFoot) {
  // Mitsuba 3.9.1 reads the first file so, its factor 2.5 included.
  for (const bool swapped : {false, true}) {
    const std::string header = swapped ? "PF\n1 2\n2.5\n" : "PF\n1 2\n-2.5\n";
    const std::string file = pfm(header, {1, 2, 3, 4, 5, 6}, swapped);
    EXPECT_EQ(decode_radiance_image(file, "x").rgb,
              (std::vector<float>{10, 12.5f, 15, 2.5f, 5, 7.5f}));
    EXPECT_EQ(decode_texture_image(file, "x").format, TextureFormat::rgb32f);
  }
  EXPECT_EQ(decode_radiance_image(pfm("Pf 2 1 -1\n", {7, 8}, false), "x").rgb,
            (std::vector<float>{7, 7, 7, 8, 8, 8}));
  for (const char* header : {"PF", "PF 1 1", "PF 1 1 0\n", "PF 1 1 x\n", "PF 1 1 -1", "PF 0 1 1\n",
                             "PF 1 1 nan\n", "PF 65535 65535 -1\n"}) {
    expect_error([&] { decode_radiance_image(header, "x"); }, "cannot read x: ");
  }
}

}  // namespace
}  // namespace pt
