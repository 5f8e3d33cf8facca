#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>

#include "common/image/codecs/image_io.h"
#include "temp_folder.h"

namespace pt {
namespace {

using Names = std::vector<std::string>;
constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

const char* const endings[] = {".exr", ".png", ".ppm"};
const ImageMetadata some_metadata{{"ptexp seed", "1"},
                                  {"command", "ptexp --spp 5\n(two lines)"},
                                  {"empty", ""},
                                  {"name of the scene", "spheres <&\"'>"}};

Image ramp(int width, int height) {
  Image image{width, height, std::vector<float>(3 * static_cast<std::size_t>(width) * height)};
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    image.rgb[i] = static_cast<float>(i) / static_cast<float>(image.rgb.size() - 1);
  }
  return image;
}

std::vector<std::uint32_t> bits(const Image& image) {
  std::vector<std::uint32_t> result;
  for (const float value : image.rgb) result.push_back(std::bit_cast<std::uint32_t>(value));
  return result;
}

/// The curves, written a second time in double precision.
double srgb(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }
double gamma2(double x) { return std::sqrt(x); }

/// Writes and reads `image`; each value must come back as the nearest of the 256 codes.
void expect_quantized(const std::string& path, const Image& image, double (*curve)(double)) {
  write_image(path, image, {});
  const Image read = read_image(path);
  ASSERT_EQ(read.rgb.size(), image.rgb.size());
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    const double code = 255 * curve(read.rgb[i]);
    EXPECT_NEAR(code, std::round(code), 1e-3) << "not one of the codes";
    EXPECT_NEAR(code, 255 * curve(image.rgb[i]), 0.5 + 1e-3) << image.rgb[i];
  }
}

TEST(ImageIo, ExrKeepsEveryBit) {
  const TempFolder folder;
  Image image = ramp(37, 19);
  const float special[] = {1e30f, -1e30f, 3.4028235e38f, 1.17549435e-38f, 1e-45f,   -1e-42f, -0.0f,
                           inf,   -inf,   not_a_number,  -not_a_number,   65504.0f, 1e6f,    0.1f};
  std::copy(std::begin(special), std::end(special), image.rgb.begin() + 100);
  image.rgb[0] = std::bit_cast<float>(0x7fc12345u);  // a NaN with a payload
  write_image(folder.file("a.exr"), image, {});
  const Image read = read_image(folder.file("a.exr"));
  EXPECT_EQ(read.width, 37);
  EXPECT_EQ(read.height, 19);
  EXPECT_EQ(bits(read), bits(image));
}

TEST(ImageIo, ExrOfAnExtremeShape) {
  const TempFolder folder;
  for (const auto& [width, height] : {std::pair(65535, 1), std::pair(1, 65535), std::pair(1, 1)}) {
    const Image image = ramp(width, height);
    write_image(folder.file("a.exr"), image, {});
    EXPECT_EQ(bits(read_image(folder.file("a.exr"))), bits(image));
  }
}

TEST(ImageIo, PngFollowsTheSrgbCurve) {
  const TempFolder folder;
  expect_quantized(folder.file("a.png"), ramp(61, 47), srgb);
}

TEST(ImageIo, PpmFollowsGamma2) {
  const TempFolder folder;
  expect_quantized(folder.file("a.ppm"), ramp(61, 47), gamma2);
}

TEST(ImageIo, PpmBytes) {
  const TempFolder folder;
  const Image image{2, 1, {0, 0.25f, 1, 0.0625f, not_a_number, 7}};
  write_image(folder.file("a.ppm"), image, {});
  EXPECT_EQ(read_text(folder.file("a.ppm")),
            std::string("P6\n2 1\n255\n\x00\x80\xff\x40\x00\xff", 17));
}

TEST(ImageIo, EightBitCodesSurviveASecondRoundTrip) {
  const TempFolder folder;
  for (const char* ending : {".png", ".ppm"}) {
    write_image(folder.file(std::string("a") + ending), ramp(32, 24), {});
    const Image once = read_image(folder.file(std::string("a") + ending));
    write_image(folder.file(std::string("b") + ending), once, {});
    EXPECT_EQ(bits(read_image(folder.file(std::string("b") + ending))), bits(once)) << ending;
  }
}

TEST(ImageIo, EightBitFormatsClampAndTurnNanBlack) {
  const TempFolder folder;
  const Image image{3, 1, {not_a_number, -not_a_number, -1, -inf, inf, 1.5f, 1e30f, -0.0f, 1e-45f}};
  for (const char* name : {"a.png", "a.ppm"}) {
    write_image(folder.file(name), image, {});
    EXPECT_EQ(read_image(folder.file(name)).rgb, (std::vector<float>{0, 0, 0, 0, 1, 1, 1, 0, 0}));
  }
}

TEST(ImageIo, ExposureScalesByPowersOfTwoExceptInExr) {
  const TempFolder folder;
  const Image image{1, 1, {0.05f, 0.1f, 0.2f}};
  const Image doubled{1, 1, {0.1f, 0.2f, 0.4f}};
  for (const char* ending : endings) {
    write_image(folder.file(std::string("a") + ending), image, {}, {.exposure = 1});
    write_image(folder.file(std::string("b") + ending), ending == endings[0] ? image : doubled, {});
    EXPECT_EQ(read_text(folder.file(std::string("a") + ending)),
              read_text(folder.file(std::string("b") + ending)));
  }
}

TEST(ImageIo, MetadataRoundTrip) {
  const TempFolder folder;
  ImageMetadata metadata = some_metadata;
  metadata["umlaut"] =
      "gr\xc3\xbc\xc3\x9f"
      "e";  // UTF-8
  metadata["long"] = std::string(100'000, 'x');
  for (const char* name : {"a.exr", "a.png"}) {
    write_image(folder.file(name), ramp(4, 4), metadata);
    ImageMetadata read{{"left over", "from before"}};
    read_image(folder.file(name), &read);
    EXPECT_EQ(read, metadata) << name;
  }
  write_image(folder.file("a.ppm"), ramp(4, 4), metadata);
  read_image(folder.file("a.ppm"), &metadata);
  EXPECT_TRUE(metadata.empty());
}

TEST(ImageIo, PngHasTheSrgbAndTextChunks) {
  const TempFolder folder;
  write_image(folder.file("a.png"), ramp(4, 4), {{"key", "value"}, {"utf8", "\xc3\xbc"}});
  const std::string bytes = read_text(folder.file("a.png"));
  EXPECT_NE(bytes.find("sRGB"), std::string::npos);
  EXPECT_NE(bytes.find(std::string("tEXtkey\0value", 13)), std::string::npos);
  EXPECT_NE(bytes.find(std::string("iTXtutf8\0", 9)), std::string::npos);
}

TEST(ImageIo, MetadataThatNoFileCanHold) {
  const TempFolder folder;
  for (const std::string& key : {std::string(), std::string(80, 'k'), std::string(" k"),
                                 std::string("k "), std::string("a  b"), std::string("a\nb")}) {
    for (const char* ending : endings) {
      expect_error(
          [&] {
            write_image(folder.file(std::string("a") + ending), ramp(2, 2), {{key, ""}});
          },
          "metadata key");
    }
  }
  expect_error(
      [&] {
        write_image(folder.file("a.png"), ramp(2, 2), {{"k", std::string(1, '\0')}});
      },
      "zero byte");
  for (const char* key : {"channels", "type", "dataWindow", "compression"}) {
    expect_error(
        [&] {
          write_image(folder.file("a.exr"), ramp(2, 2), {{key, "x"}});
        },
        "taken by OpenEXR");
  }
  EXPECT_EQ(folder.entries(), Names{});
}

TEST(ImageIo, EndingsInCapitalsAndUnknownOnes) {
  const TempFolder folder;
  write_image(folder.file("a.ExR"), ramp(2, 2), {});
  EXPECT_EQ(bits(read_image(folder.file("a.ExR"))), bits(ramp(2, 2)));
  for (const char* name : {"a.jpg", "a", ".png", "a.exr2", "a.png.", ""}) {
    const std::string path = folder.file(name);
    const std::string reason = path + ": expected an image file ending in .exr, .png or .ppm";
    expect_error([&] { check_image_path(path); }, reason);
    expect_error([&] { write_image(path, ramp(2, 2), {}); }, reason);
    expect_error([&] { read_image(path); }, reason);
  }
  EXPECT_EQ(folder.entries(), Names{"a.ExR"});
}

TEST(ImageIo, ImagesThatCannotBeWritten) {
  const TempFolder folder;
  const Image bad[] = {{},
                       {0, 5, {}},
                       {-1, -1, {0, 0, 0}},
                       {2, 2, {0, 0, 0}},
                       {65536, 1, std::vector<float>(3 * 65536)}};
  for (const char* ending : endings) {
    for (const Image& image : bad) {
      expect_error([&] { write_image(folder.file(std::string("a") + ending), image, {}); },
                   "cannot write " + folder.file(std::string("a") + ending));
    }
  }
  EXPECT_EQ(folder.entries(), Names{});
}

TEST(ImageIo, FailedWriteKeepsTheOldImage) {
  const TempFolder folder;
  for (const char* ending : endings) {
    const std::string path = folder.file(std::string("a") + ending);
    write_image(path, ramp(3, 3), {});
    const std::string old = read_text(path);
    expect_error([&] { write_image(path, Image{}, {}); }, path);
    EXPECT_EQ(read_text(path), old);
  }
  std::filesystem::create_directory(folder.file("folder.exr"));
  expect_error([&] { write_image(folder.file("folder.exr"), ramp(3, 3), {}); }, "it is a folder");
  expect_error([&] { write_image(folder.file("none/a.png"), ramp(3, 3), {}); }, "does not exist");
  EXPECT_EQ(folder.entries(), (Names{"a.exr", "a.png", "a.ppm", "folder.exr"}));
}

TEST(ImageIo, CheckImagePath) {
  const TempFolder folder;
  check_image_path(folder.file("a.png"));
  expect_error([&] { check_image_path(folder.file("none/a.png")); }, "does not exist");
  EXPECT_EQ(folder.entries(), Names{});
}

TEST(ImageIo, FilesThatCannotBeRead) {
  const TempFolder folder;
  std::filesystem::create_directory(folder.file("folder.exr"));
  std::filesystem::create_symlink("/dev/zero", folder.file("endless.ppm"));
  expect_error([&] { read_image(folder.file("none.exr")); }, "none.exr: No such file");
  expect_error([&] { read_image(folder.file("folder.exr")); }, "not a regular file");
  expect_error([&] { read_image(folder.file("endless.ppm")); }, "not a regular file");
}

}  // namespace
}  // namespace pt
