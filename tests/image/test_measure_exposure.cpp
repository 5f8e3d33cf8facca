// How bright a picture is made.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/image/tone_mapping.h"

namespace pt {
namespace {

Image image_of(const std::vector<float>& luminances) {
  Image image{static_cast<int>(luminances.size()), 1, {}};
  for (const float y : luminances) image.rgb.insert(image.rgb.end(), 3, y);
  return image;
}

TEST(MeasureExposure, MakesTheLogAverageMiddleGrey) {
  EXPECT_NEAR(measure_exposure(image_of(std::vector<float>(10, 0.18f))), 0, 1e-5);
  EXPECT_NEAR(measure_exposure(image_of(std::vector<float>(10, 0.18f * 32768))), -15, 1e-4);
  EXPECT_NEAR(measure_exposure(image_of({0.09f, 0.36f, 0.09f, 0.36f})), 0, 1e-5);
  EXPECT_EQ(measure_exposure(image_of({0, 0, 0})), 0);
  EXPECT_EQ(measure_exposure(image_of({NAN, INFINITY, -1})), 0);
  // Luminance by the primaries of sRGB.
  EXPECT_NEAR(measure_exposure({1, 1, {0, 1, 0}}), std::log2(0.18 / 0.7152), 1e-4);
}

TEST(MeasureExposure, IgnoresFirefliesAndDarkness) {
  std::vector<float> pixels(1000, 0.09f);
  const float plain = measure_exposure(image_of(pixels));
  EXPECT_NEAR(plain, 1, 1e-5);
  for (int i = 0; i < 9; ++i) pixels[static_cast<std::size_t>(100 * i)] = 1e8f;
  EXPECT_EQ(measure_exposure(image_of(pixels)), plain);
  pixels.resize(20'000, 0.0f);
  EXPECT_EQ(measure_exposure(image_of(pixels)), plain);
  pixels.resize(40'000, 1e-6f);
  EXPECT_EQ(measure_exposure(image_of(pixels)), plain) << "black on a display";
}

}  // namespace
}  // namespace pt
