// What the page shows of radiance and of AOVs, against values of the published code and by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/image/tone_mapping.h"
#include "view/change_settings.h"

namespace pt {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

Image image_of(const std::vector<Color>& pixels) {
  Image image{static_cast<int>(pixels.size()), 1, {}};
  for (const Color& c : pixels) image.rgb.insert(image.rgb.end(), {c.x, c.y, c.z});
  return image;
}

/// The bytes of the picture's PNG.
std::string bytes_of(const Image& image, const Display& display, int samples = 1) {
  const auto picture = make_picture(image, display, samples);
  if (!picture) return "none";
  return quantize(picture->image, {.exposure = picture->exposure}, srgb_curve);
}

std::vector<int> shown(const Color& color, ToneCurve curve, float exposure = 0) {
  const std::string bytes = bytes_of(image_of({color}), {"color", exposure, curve});
  return {bytes.begin(), bytes.end()};
}

void expect_bytes(const Color& color, ToneCurve curve, const std::vector<int>& expected) {
  const std::string bytes = bytes_of(image_of({color}), {"color", 0, curve});
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(static_cast<unsigned char>(bytes[c]), expected[c], 1) << c;
}

// As the program writes it.
TEST(Display, WithoutACurveNothingChanges) {
  const Image image = image_of({{0.1f, 0.5f, 3}, {-1, nan, 0.02f}});
  for (const float exposure : {0.0f, 1.5f}) {
    EXPECT_EQ(bytes_of(image, {"color", exposure, ToneCurve::srgb}),
              quantize(image, {.exposure = exposure}, srgb_curve));
  }
}

// By the published code, evaluated in double precision.
TEST(Display, CurvesAreThePublishedOnes) {
  expect_bytes({0.18f, 0.18f, 0.18f}, ToneCurve::neutral, {105, 105, 105});
  expect_bytes({1, 0.5f, 0.02f}, ToneCurve::neutral, {240, 177, 34});
  expect_bytes({4, 2, 0.5f}, ToneCurve::neutral, {253, 209, 166});
  expect_bytes({0, 0.05f, 0.3f}, ToneCurve::neutral, {0, 63, 149});
  expect_bytes({0.18f, 0.18f, 0.18f}, ToneCurve::agx, {127, 127, 127});
  expect_bytes({1, 0.5f, 0.02f}, ToneCurve::agx, {208, 177, 88});
  expect_bytes({4, 2, 0.5f}, ToneCurve::agx, {242, 225, 185});
  expect_bytes({0, 0.05f, 0.3f}, ToneCurve::agx, {38, 79, 156});
  expect_bytes({0.18f, 0.18f, 0.18f}, ToneCurve::aces, {141, 141, 141});
  expect_bytes({1, 0.5f, 0.02f}, ToneCurve::aces, {232, 206, 26});
  expect_bytes({4, 2, 0.5f}, ToneCurve::aces, {252, 245, 206});
  expect_bytes({0, 0.05f, 0.3f}, ToneCurve::aces, {0, 59, 177});
}

TEST(Display, CurvesSeeTheExposure) {
  for (const ToneCurve curve : {ToneCurve::neutral, ToneCurve::agx, ToneCurve::aces})
    EXPECT_EQ(shown({0.1f, 0.2f, 0.05f}, curve, 2), shown({0.4f, 0.8f, 0.2f}, curve));
}

TEST(Display, CurvesRiseAndTakeAnything) {
  for (const ToneCurve curve : {ToneCurve::neutral, ToneCurve::agx, ToneCurve::aces}) {
    int last = 0;
    for (float x = 0; x < 30; x = 1.2f * x + 0.002f) {
      const int now = static_cast<unsigned char>(shown(Color(x), curve)[1]);
      EXPECT_GE(now, last) << x;
      last = now;
    }
    EXPECT_GT(last, 245);
    for (const float x : {nan, -1.0f, 1e30f, std::numeric_limits<float>::infinity()})
      EXPECT_EQ(shown({x, 0.2f, 0.2f}, curve).size(), 3u);
  }
}

Image with_layer(const char* name, const char* channels, std::vector<float> values) {
  const std::size_t pixels = values.size() / std::string_view(channels).size();
  Image image = image_of(std::vector<Color>(pixels, Color(0.5f)));
  image.layers.push_back({name, channels, std::move(values), {}});
  return image;
}

TEST(Display, AMissingLayerIsNoPicture) {
  EXPECT_EQ(bytes_of(image_of({Color(1)}), {"depth"}), "none");
}

// Neither exposure nor curve change what colours mean.
TEST(Display, NormalsAreColours) {
  const Image image = with_layer("normal", "XYZ", {1, 0.2f, -1, -0.6f, 0.6f, 0.7f});
  EXPECT_EQ(bytes_of(image, {"normal", 3, ToneCurve::aces}),
            std::string("\xff\x99\x00\x33\xcc\xd9", 6));
}

TEST(Display, TextureCoordinatesRepeat) {
  const Image image = with_layer("uv", "UV", {0.2f, 1.2f, -0.8f, 0});
  EXPECT_EQ(bytes_of(image, {"uv"}), std::string("\x33\x33\x00\x33\x00\x00", 6));
}

TEST(Display, AlbedoIsLinear) {
  const Image image = with_layer("albedo", "RGB", {0, 0.2158605f, 1});
  EXPECT_EQ(bytes_of(image, {"albedo"}), std::string("\x00\x80\xff", 3));
}

TEST(Display, NumbersGoFromOneEndOfTheScaleToTheOther) {
  std::vector<float> rays(400, 8);
  rays[0] = 2, rays[1] = 5, rays[2] = 500;  // one that is far away is not the end
  const auto picture = make_picture(with_layer("rays", "N", rays), {"rays"}, 2);
  ASSERT_TRUE(picture && picture->range);
  EXPECT_EQ(*picture->range, (std::array{1.0f, 4.0f})) << "of a sample";
  const std::string bytes = quantize(picture->image, {}, srgb_curve);
  EXPECT_EQ(bytes.substr(0, 3), "\x44\x01\x54") << "the scale's begin";
  EXPECT_EQ(bytes.substr(3, 3), "\x21\x91\x8c") << "its middle";
  EXPECT_EQ(bytes.substr(6, 3), "\xfd\xe7\x25") << "its end";
  EXPECT_EQ(bytes.substr(9, 3), "\xfd\xe7\x25");
}

TEST(Display, TheErrorIsTheRootOfTheVariance) {
  const auto picture = make_picture(with_layer("variance", "Y", {0, 4, 9}), {"variance"}, 5);
  EXPECT_EQ(picture.value().range, (std::array{0.0f, 3.0f}));
}

TEST(Display, WhereNothingIsHitThereIsNoDepth) {
  const auto picture = make_picture(with_layer("depth", "Z", {0, 3, 7}), {"depth"}, 5);
  EXPECT_EQ(picture.value().range, (std::array{3.0f, 7.0f}));
  EXPECT_EQ(quantize(picture->image, {}, srgb_curve).substr(0, 6),
            std::string("\x00\x00\x00\x44\x01\x54", 6));
}

TEST(Display, PositionsAreOfTheirOwnBox) {
  const Image image = with_layer("position", "XYZ", {10, -5, 3, 20, 5, 3, 12, -3, 3});
  EXPECT_EQ(bytes_of(image, {"position"}), std::string("\x00\x00\x00\xff\xff\x00\x33\x33\x00", 9));
  EXPECT_EQ(bytes_of(with_layer("motion", "XY", {10, -5, 20, 5, 12, -3}), {"motion"}),
            std::string("\x00\x00\x00\xff\xff\x00\x33\x33\x00", 9));
}

TEST(Display, EqualIndicesHaveOneColour) {
  Image image = image_of(std::vector<Color>(4));
  image.layers.push_back({"primitive", "I", {}, {7, 8, 7, 4000000000u}});
  const std::string bytes = bytes_of(image, {"primitive"});
  EXPECT_EQ(bytes.substr(0, 3), bytes.substr(6, 3));
  EXPECT_NE(bytes.substr(0, 3), bytes.substr(3, 3));
  EXPECT_NE(bytes.substr(0, 3), bytes.substr(9, 3));
}

}  // namespace
}  // namespace pt
