// FLIP against the values of an independent program: scripts/flip_reference.py prints them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "common/image/codecs/image_io.h"
#include "common/image/compare/compare.h"
#include "common/image/compare/flip.h"
#include "temp_folder.h"

namespace pt {
namespace {

constexpr int flip_width = 40, flip_height = 30;

using ValueAt = std::function<double(int x, int y, int c)>;

double reference_value(int x, int y, int c) {
  if (x > 10 && x < 25 && y > 8) return 0.1 + 0.4 * c;
  return 0.5 + 0.4 * std::sin(0.3 * x + 0.2 * y * (c + 1));
}

double test_value(int x, int y, int c) {
  const double value = ((x + y) % 7 == 0 ? 0.7 : 1.0) * reference_value(x, y, c);
  return x > 30 ? 0.3 * value + 0.1 : value;
}

Image make_image(const ValueAt& value, bool radiance) {
  Image image{flip_width, flip_height, {}};
  for (int y = 0; y < flip_height; ++y) {
    for (int x = 0; x < flip_width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const float v = static_cast<float>(value(x, y, c));
        image.rgb.push_back(radiance ? std::exp(4 * v - 2) : v);
      }
    }
  }
  return image;
}

constexpr int places[6][2] = {{0, 0}, {7, 3}, {20, 15}, {31, 22}, {39, 29}, {12, 25}};

void expect_errors(const std::vector<float>& errors, double mean, const double (&expected)[6]) {
  ASSERT_EQ(errors.size(), static_cast<std::size_t>(flip_width * flip_height));
  EXPECT_NEAR(std::accumulate(errors.begin(), errors.end(), 0.0) / (flip_width * flip_height), mean,
              2e-6);
  for (int i = 0; i < 6; ++i) {
    const auto [x, y] = places[i];
    EXPECT_NEAR(errors[static_cast<std::size_t>(y * flip_width + x)], expected[i], 1e-5)
        << x << ' ' << y;
  }
}

// flip-evaluator 1.7, in single precision.
TEST(Flip, OfDisplayedImages) {
  expect_errors(ldr_flip(make_image(test_value, false), make_image(reference_value, false)),
                0.263790, {0.256278, 0.063499, 0.143232, 0.636788, 0.524630, 0.093962});
}

TEST(Flip, OfRadiance) {
  expect_errors(hdr_flip(make_image(test_value, true), make_image(reference_value, true)), 0.312871,
                {0.317692, 0.087180, 0.190490, 0.735146, 0.588086, 0.121708});
}

TEST(Flip, OfEqualImagesIsZeroAndOfBadValuesFinite) {
  Image image = make_image(reference_value, true);
  for (const float error : hdr_flip(image, image)) ASSERT_EQ(error, 0.0f);
  const Image reference = image;
  image.rgb[0] = NAN, image.rgb[4] = INFINITY, image.rgb[8] = -INFINITY;
  for (const float error : hdr_flip(image, reference)) ASSERT_TRUE(error >= 0 && error <= 1);
  const Image black{flip_width, flip_height, std::vector<float>(image.rgb.size())};
  for (const float error : hdr_flip(image, black)) ASSERT_TRUE(error >= 0 && error <= 1);
}

/// Images of several tiles, which differ in single pixels: in a corner, at the border of two tiles,
/// beside it as far as the filters reach and a pixel further, and all along the lower edge.
std::pair<Image, Image> make_large_images() {
  constexpr int w = 300, h = 520;
  Image test{w, h, {}};
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      for (int c = 0; c < 3; ++c)
        test.rgb.push_back(static_cast<float>(std::exp(2 * reference_value(x, y, c) - 1)));
    }
  }
  Image reference = test;
  const auto change = [&](int x, int y) {
    test.rgb[3 * static_cast<std::size_t>(y * w + x)] *= 1.3f;
  };
  for (const int x : {0, 64, 255, 256, 266, 277}) change(x, x / 2);
  for (int x = 0; x < w; ++x) change(x, h - 1);
  return {test, reference};
}

TEST(Flip, ByTilesIsThatOfTheWholeToTheLastBit) {
  const auto [test, reference] = make_large_images();
  FlipView whole;
  whole.tile = 1000;
  EXPECT_EQ(ldr_flip(test, reference), ldr_flip(test, reference, whole));
  const std::vector<float> errors = hdr_flip(test, reference);
  EXPECT_EQ(errors, hdr_flip(test, reference, whole));
  FlipView narrow;
  narrow.tile = 17;
  EXPECT_EQ(errors, hdr_flip(test, reference, narrow));
  EXPECT_GT(std::ranges::count(errors, 0.0f), 300 * 200) << "where nothing differs";
}

TEST(DifferencePicture, IsBrighterWhereTheErrorIsLarger) {
  std::vector<float> values;
  for (int i = 0; i <= 100; ++i) values.push_back(0.01f * static_cast<float>(i));
  const Image image = false_colors(values, 101, 1);
  const auto luminance = [&](std::size_t i) {
    return 0.2126f * image.rgb[3 * i] + 0.7152f * image.rgb[3 * i + 1] +
           0.0722f * image.rgb[3 * i + 2];
  };
  for (std::size_t i = 1; i < values.size(); ++i) EXPECT_GT(luminance(i), luminance(i - 1)) << i;
}

TEST(DifferencePicture, OfAnExrIsTheDifference) {
  const TempFolder folder;
  const Image a = make_image(test_value, true), b = make_image(reference_value, true);
  write_difference(folder.file("d.exr"), a, b, {});
  const Image difference = read_image(folder.file("d.exr"));
  for (std::size_t i = 0; i < a.rgb.size(); ++i) ASSERT_EQ(difference.rgb[i], a.rgb[i] - b.rgb[i]);
  write_difference(folder.file("d.png"), a, b, hdr_flip(a, b));
  EXPECT_EQ(read_image(folder.file("d.png")).width, flip_width);
}

}  // namespace
}  // namespace pt
