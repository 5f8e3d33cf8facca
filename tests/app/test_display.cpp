// What a viewer is sent: packets byte by byte as the README of tev describes them, the parts of an
// image that changed, and how often.
#include <gtest/gtest.h>

#include <bit>

#include "app/display/display.h"
#include "app/display/tev.h"
#include "app/options/option_values.h"
#include "common/error/error.h"

namespace pt {
namespace {

using namespace std::string_literals;

Image image_of(int width, int height) {
  Image image{width, height, std::vector<float>(3 * static_cast<std::size_t>(width * height))};
  for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = static_cast<float>(i);
  return image;
}

TEST(TevPackets, CreateAnImage) {
  EXPECT_EQ(tev::create_image("a", 258, 3), "\x1a\0\0\0\4\1a\0\2\1\0\0\3\0\0\0\3\0\0\0R\0G\0B\0"s);
}

TEST(TevPackets, UpdateAPart) {
  Image image = image_of(3, 2);
  image.place = {5, 7, 20, 10};
  const std::string packet = tev::update_image("i.exr", image, {1, 0, 3, 2});
  std::string expected = "\6\0i.exr\0\3\0\0\0R\0G\0B\0"s;
  expected += "\6\0\0\0\7\0\0\0\2\0\0\0\2\0\0\0"s;
  const std::string seven(7, '\0');
  for (const char offset : {0, 1, 2}) expected += offset + seven;
  for (int i = 0; i < 3; ++i) expected += '\3' + seven;
  for (const int value : {3, 4, 5, 6, 7, 8, 12, 13, 14, 15, 16, 17}) {
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
    for (int shift = 0; shift < 32; shift += 8) expected += static_cast<char>(bits >> shift);
  }
  ASSERT_EQ(packet.substr(4), expected);
  EXPECT_EQ(packet.substr(0, 4), static_cast<char>(packet.size()) + "\0\0\0"s);
}

TEST(TevParts, AreAllOfAnImageThatWasNotShown) {
  std::vector<int> covered(70 * 130);
  for (const CropWindow& part : tev::changed_parts({}, image_of(70, 130)))
    for (int y = part.y0; y < part.y1; ++y)
      for (int x = part.x0; x < part.x1; ++x) ++covered[static_cast<std::size_t>(70 * y + x)];
  EXPECT_EQ(covered, std::vector<int>(covered.size(), 1));
}

TEST(TevParts, AreThoseThatChanged) {
  const Image before = image_of(200, 130);
  Image after = before;
  EXPECT_TRUE(tev::changed_parts(before, after).empty());
  after.pixel(64, 0)[2] = -1;    // of the second tile
  after.pixel(191, 63)[0] = -1;  // of the third
  after.pixel(199, 129)[1] = -1;
  const std::vector<CropWindow> parts = tev::changed_parts(before, after);
  EXPECT_EQ(parts, (std::vector<CropWindow>{{64, 0, 192, 64}, {192, 128, 200, 130}}));
}

TEST(DisplayPaces, GiveFourImagesASecondAndAFiftiethOfTheTime) {
  DisplayPace pace;
  EXPECT_TRUE(pace.is_due(0));
  pace.note(10, 10.001, 0.001);
  EXPECT_FALSE(pace.is_due(10.2));
  EXPECT_TRUE(pace.is_due(10.26));
  pace.note(20, 20.1, 0.05);  // took 0.15 s: the next one 10 s later
  EXPECT_FALSE(pace.is_due(30.0));
  EXPECT_TRUE(pace.is_due(30.11));
}

TEST(DisplayAddresses, AreHostAndPort) {
  const auto parsed = [](const std::string& text) {
    return display_text(parse_display("display", text));
  };
  EXPECT_EQ(parsed("viewer"), "viewer:14158");
  EXPECT_EQ(parsed("viewer:80"), "viewer:80");
  EXPECT_EQ(parsed(":80"), "localhost:80");
  EXPECT_EQ(parsed("10.0.0.1:65535"), "10.0.0.1:65535");
  EXPECT_EQ(parsed("[::1]"), "[::1]:14158");
  EXPECT_EQ(parsed("[fe80::1]:9"), "[fe80::1]:9");
  for (const char* const bad : {"a:0", "a:65536", "a:b", "a:", "::1", "a:b:1"})
    EXPECT_THROW(parsed(bad), Error) << bad;
}

// Nobody listens at a port that nobody can have.
TEST(Displays, AreNoReasonToLoseARender) {
  std::string warning;
  Display display({"127.0.0.1", 1}, "a", [&](const std::string& text) { warning = text; });
  const auto image = []() -> Image { throw Error("nobody sees it"); };
  display.watch(image);
  display.finish(image);
  EXPECT_EQ(warning, "--display 127.0.0.1:1: Connection refused; the render is not shown");
}

}  // namespace
}  // namespace pt
