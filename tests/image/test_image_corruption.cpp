// Damaged files of every format: an Error or a valid image, never a crash.
#include <gtest/gtest.h>

#include "common/image/codecs/image_io.h"
#include "temp_folder.h"

namespace pt {
namespace {

class ImageCorruption : public testing::TestWithParam<const char*> {
 protected:
  ImageCorruption() {
    Image image{13, 21, std::vector<float>(3 * 13 * 21)};  // two ZIP blocks of EXR
    for (std::size_t i = 0; i < image.rgb.size(); ++i)
      image.rgb[i] = static_cast<float>(i % 97) / 96;
    write_image(path_, image, {{"key", "value"}, {"umlaut", "\xc3\xbc"}});
    bytes_ = read_text(path_);
  }

  void expect_error_with(const std::string& bytes, const std::string& part) const {
    write_text(path_, bytes);
    expect_error([&] { read_image(path_); }, "cannot read " + path_);
    expect_error([&] { read_image(path_); }, part);
  }

  /// Any exception but Error fails the test.
  void expect_error_or_image(const std::string& bytes) const {
    write_text(path_, bytes);
    try {
      ImageMetadata metadata;
      const Image image = read_image(path_, &metadata);
      EXPECT_GT(image.width, 0);
      EXPECT_GT(image.height, 0);
      EXPECT_EQ(image.rgb.size(), std::size_t{3} * image.width * image.height);
    } catch (const Error&) {
    }
  }

  const TempFolder folder_;
  const std::string path_ = folder_.file(std::string("a") + GetParam());
  std::string bytes_;
};

TEST_P(ImageCorruption, EveryTruncationIsAnError) {
  for (std::size_t length = 0; length < bytes_.size(); ++length) {
    SCOPED_TRACE(length);
    expect_error_with(bytes_.substr(0, length), "");
  }
}

TEST_P(ImageCorruption, AnyFlippedByte) {
  for (std::size_t i = 0; i < bytes_.size(); ++i) {
    for (const unsigned mask : {0x01u, 0x80u, 0xffu}) {
      std::string flipped = bytes_;
      flipped[i] = static_cast<char>(static_cast<unsigned char>(flipped[i]) ^ mask);
      SCOPED_TRACE(i);
      expect_error_or_image(flipped);
    }
  }
}

TEST_P(ImageCorruption, BytesRemovedInsertedOrFollowing) {
  for (std::size_t i = 0; i < bytes_.size(); i += 3) {
    expect_error_or_image(std::string(bytes_).erase(i, 1 + i % 17));
    expect_error_or_image(std::string(bytes_).insert(i, 1 + i % 17, static_cast<char>(i)));
  }
  write_text(path_, bytes_ + "trailing bytes");
  EXPECT_EQ(read_image(path_).width, 13);
}

TEST_P(ImageCorruption, AnotherFormatUnderThisName) {
  for (const std::string ending : {".exr", ".png", ".ppm"}) {
    if (ending == GetParam()) continue;
    const std::string other = folder_.file("other" + ending);
    write_image(other, Image{1, 1, {1, 1, 1}}, {});
    expect_error_with(read_text(other), "not a");
  }
  expect_error_with("", "");
  expect_error_with(std::string(1000, '\0'), "not a");
}

INSTANTIATE_TEST_SUITE_P(Endings, ImageCorruption, testing::Values(".exr", ".png", ".ppm"),
                         [](const auto& test) { return std::string(test.param + 1); });

std::string big_endian(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16),
          static_cast<char>(value >> 8), static_cast<char>(value)};
}

std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = ~0u;
  for (const unsigned char byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

TEST(ImageSizes, PngThatAnnouncesMoreThanItCanHold) {
  const TempFolder folder;
  write_image(folder.file("a.png"), Image{1, 1, {1, 1, 1}}, {});
  const std::string bytes = read_text(folder.file("a.png"));
  const std::pair<std::uint32_t, const char*> cases[] = {
      {65535, "cannot hold the 65535x65535 pixels"},
      {65536, "65536x65536 pixels; expected sides of 1 to 65535"},
      {0, "IHDR"},
      {~0u, "out of range"}};
  for (const auto& [size, reason] : cases) {
    // IHDR: length, name, width, height, five more bytes, CRC; after the 8 bytes of the signature.
    const std::string header = "IHDR" + big_endian(size) + big_endian(size) + bytes.substr(24, 5);
    write_text(folder.file("a.png"),
               bytes.substr(0, 12) + header + big_endian(crc32(header)) + bytes.substr(33));
    expect_error([&] { read_image(folder.file("a.png")); }, "");
    expect_error([&] { read_image(folder.file("a.png")); }, reason);
  }
}

TEST(ImageSizes, ExrThatAnnouncesMoreThanItCanHold) {
  const TempFolder folder;
  write_image(folder.file("a.exr"), Image{1, 1, {1, 1, 1}}, {});
  std::string bytes = read_text(folder.file("a.exr"));
  const std::string name("dataWindow\0box2i", 17);
  const std::size_t box = bytes.find(name) + name.size() + 4;  // the size of the value, then 4 ints
  for (const std::string& maximum :
       {std::string("\xfe\xff\x00\x00", 4), std::string("\xff\xff\x00\x00", 4),
        std::string("\xff\xff\xff\x7f", 4), std::string("\xff\xff\xff\xff", 4)}) {
    bytes.replace(box + 8, 8, maximum + maximum);
    write_text(folder.file("a.exr"), bytes);
    expect_error([&] { read_image(folder.file("a.exr")); }, folder.file("a.exr"));
  }
}

TEST(ImageSizes, ExrKindsThatAreNotRead) {
  const TempFolder folder;
  write_image(folder.file("a.exr"), Image{1, 1, {1, 1, 1}}, {});
  std::string bytes = read_text(folder.file("a.exr"));
  for (const char flag : {'\x08', '\x10'}) {
    bytes[5] = flag;
    write_text(folder.file("a.exr"), bytes);
    expect_error([&] { read_image(folder.file("a.exr")); }, "deep or multi-part");
  }
}

// Found by fuzzing: OpenEXR reads as much of an attribute as its type needs, and then took the rest
// for attributes whose sizes nobody had checked.
TEST(ImageSizes, ExrAttributesHaveTheSizesOfTheirTypes) {
  const TempFolder folder;
  const std::string path = folder.file("a.exr");
  write_image(path, Image{1, 1, {1, 2, 3}}, {});
  const std::string good = read_text(path);
  const auto expect_error_at = [&](const std::string& attribute, const std::string& inserted) {
    std::string bytes = good;
    bytes.insert(bytes.find(attribute), inserted);
    write_text(path, bytes);
    expect_error([&] { read_image(path); }, "corrupted in the header");
  };
  using namespace std::string_literals;
  expect_error_at("compression", "x\0float\0\5\0\0\0abcde"s);
  expect_error_at("compression", "x\0stringvector\0\5\0\0\0\xff\xff\xff\x7f!"s);
  expect_error_at("compression", "x\0preview\0\x8\0\0\0\xff\xff\0\0\xff\xff\0\0"s);
  expect_error_at("compression", "x\0chlist\0\x2\0\0\0\0!"s);
  expect_error_at("compression", "x\0string\0\xff\xff\xff\x7f!"s);
}

}  // namespace
}  // namespace pt
