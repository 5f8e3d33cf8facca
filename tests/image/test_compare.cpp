#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "app/commands/commands.h"
#include "common/image/codecs/image_io.h"
#include "common/image/compare/compare.h"
#include "temp_folder.h"

namespace pt {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

Image pixels(std::vector<float> rgb) {
  return {static_cast<int>(rgb.size() / 3), 1, std::move(rgb)};
}

TEST(Compare, EqualImages) {
  const Image image = pixels({0, 1, -2, infinity, -infinity, nan});
  const ImageDifference difference = compare_images(image, image, 0);
  EXPECT_EQ(difference.rmse, 0);
  EXPECT_EQ(difference.relative_mse, 0);
  EXPECT_EQ(difference.largest, 0);
  EXPECT_EQ(difference.differing_pixels, 0u);
  EXPECT_EQ(difference.pixels_past_tolerance, 0u);
}

TEST(Compare, ByHand) {
  // Differences 0.5, 0, 0 | 0, -3, 0: squares 0.25 and 9 over 6 values.
  const Image a = pixels({1.5f, 2, 3, 0, 1, 0});
  const Image b = pixels({1, 2, 3, 0, 4, 0});
  const ImageDifference difference = compare_images(a, b, 0.5);
  EXPECT_DOUBLE_EQ(difference.rmse, std::sqrt(9.25 / 6));
  EXPECT_DOUBLE_EQ(difference.relative_mse, (0.25 / 1.01 + 9 / 16.01) / 6);
  EXPECT_EQ(difference.largest, 3);
  EXPECT_EQ(difference.differing_pixels, 2u);
  EXPECT_EQ(difference.pixels_past_tolerance, 1u);  // 0.5 is not past 0.5
}

TEST(Compare, TheReferenceIsTheSecond) {
  const Image black = pixels({0, 0, 0});
  const Image white = pixels({1, 1, 1});
  EXPECT_DOUBLE_EQ(compare_images(white, black, 0).relative_mse, 100);
  EXPECT_DOUBLE_EQ(compare_images(black, white, 0).relative_mse, 1 / 1.01);
}

TEST(Compare, SignedZerosDifferInBitsOnly) {
  const ImageDifference difference = compare_images(pixels({0, 0, 0}), pixels({-0.0f, 0, 0}), 0);
  EXPECT_EQ(difference.differing_pixels, 1u);
  EXPECT_EQ(difference.largest, 0);
  EXPECT_EQ(difference.pixels_past_tolerance, 0u);
}

TEST(Compare, HugeValuesDoNotOverflow) {
  const ImageDifference difference =
      compare_images(pixels({3e38f, 0, 0}), pixels({-3e38f, 0, 0}), 0);
  EXPECT_EQ(difference.largest, 2 * static_cast<double>(3e38f));
  EXPECT_TRUE(std::isfinite(difference.rmse));
}

TEST(Compare, ValuesThatAreNotFiniteAreInfinitelyFar) {
  const std::pair<float, float> pairs[] = {
      {nan, 1.0f},           {1.0f, nan},     {infinity, 1.0f}, {1.0f, -infinity},
      {infinity, -infinity}, {nan, infinity}, {nan, -nan}};
  for (const auto& [x, y] : pairs) {
    const ImageDifference difference = compare_images(pixels({x, 0, 0}), pixels({y, 0, 0}), 1e30);
    EXPECT_EQ(difference.largest, infinity) << x << ' ' << y;
    EXPECT_EQ(difference.rmse, infinity) << x << ' ' << y;
    EXPECT_EQ(difference.relative_mse, infinity) << x << ' ' << y;
    EXPECT_EQ(difference.differing_pixels, 1u) << x << ' ' << y;
    EXPECT_EQ(difference.pixels_past_tolerance, 1u) << x << ' ' << y;
  }
}

TEST(Compare, SizesMustAgree) {
  const Image a{2, 1, std::vector<float>(6)};
  const Image b{1, 2, std::vector<float>(6)};
  expect_error([&] { compare_images(a, b, 0); }, "the sizes differ: 2x1 and 1x2");
}

class CompareCommand : public testing::Test {
 protected:
  std::string write(const std::string& name, const Image& image) const {
    write_image(folder_.file(name), image, {});
    return folder_.file(name);
  }

  TempFolder folder_;
};

TEST_F(CompareCommand, PrintsTheDifferences) {
  const std::string a = write("a.exr", pixels({1.5f, 2, 3, 0, 1, 0}));
  const std::string b = write("b.exr", pixels({1, 2, 3, 0, 4, 0}));
  testing::internal::CaptureStdout();
  const int code = compare_command({a, b, 0.5});
  EXPECT_EQ(testing::internal::GetCapturedStdout(),
            "size                   2x1\n"
            "RMSE                   1.241638702145945\n"
            "relMSE                 0.13494556826076112\n"
            "HDR-FLIP               0.649748\n"
            "largest difference     3\n"
            "differing pixels       2\n"
            "pixels past tolerance  1\n");
  EXPECT_EQ(code, 1);
}

TEST_F(CompareCommand, ExitCodes) {
  const std::string a = write("a.exr", pixels({1.5f, 2, 3}));
  const std::string b = write("b.exr", pixels({1, 2, 3}));
  const std::string c = write("c.exr", pixels({nan, 2, 3}));
  testing::internal::CaptureStdout();
  EXPECT_EQ(compare_command({a, a, 0}), 0);
  EXPECT_EQ(compare_command({c, c, 0}), 0);
  EXPECT_EQ(compare_command({a, b, 0.5}), 0);
  EXPECT_EQ(compare_command({a, b, 0.4999}), 1);
  EXPECT_EQ(compare_command({a, c, 1e300}), 1);
  testing::internal::GetCapturedStdout();
}

TEST_F(CompareCommand, DifferentFormatsCompare) {
  const Image image = pixels({0, 1, 0, 1, 1, 1});
  testing::internal::CaptureStdout();
  EXPECT_EQ(compare_command({write("a.png", image), write("b.ppm", image), 0}), 0);
  testing::internal::GetCapturedStdout();
}

TEST_F(CompareCommand, BadInputThrows) {
  const std::string a = write("a.exr", pixels({1, 2, 3}));
  const std::string wide = write("b.exr", pixels({1, 2, 3, 4, 5, 6}));
  expect_error(
      [&] {
        compare_command({a, wide, 0});
      },
      "cannot compare " + a + " with " + wide + ": the sizes differ: 1x1 and 2x1");
  expect_error([&] { compare_command({a, folder_.file("none.exr"), 0}); }, "none.exr");
  expect_error([&] { compare_command({a, a, -1}); }, "tolerance -1");
  expect_error([&] { compare_command({a, a, std::nan("")}); }, "tolerance nan");
}

}  // namespace
}  // namespace pt
