// The environment map: which direction shows which pixel, and that directions are chosen with the
// density that is claimed.
#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "common/light/sky/environment.h"
#include "statistics.h"
#include "temp_folder.h"

namespace pt {
namespace {

using Vec3d = glm::dvec3;

struct Picture {
  int width, height;
  std::vector<Color> pixels;

  Color& at(int x, int y) { return pixels[static_cast<std::size_t>(y * width + x)]; }
};

Picture constant(int width, int height, const Color& color) {
  return {width, height,
          std::vector<Color>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                             color)};
}

Picture random_picture(int width, int height, std::uint64_t seed) {
  TestRandom random(seed);
  Picture picture = constant(width, height, Color(0.0f));
  for (Color& p : picture.pixels)
    for (int c = 0; c < 3; ++c) p[c] = static_cast<float>(random.log_uniform(0.01, 10));
  return picture;
}

EnvironmentMap make(const Picture& picture, const Affine& to_world = {}) {
  return make_environment(picture.width, picture.height, picture.pixels, to_world);
}

Picture single_texel(int width, int height, int x, int y) {
  Picture picture = constant(width, height, Color(0.0f));
  picture.at(x, y) = Color(1000.0f, 500.0f, 2000.0f);
  return picture;
}

std::vector<Picture> pictures() {
  return {constant(1, 1, Color(2, 3, 4)), constant(5, 3, Color(0.0f)), random_picture(1, 7, 1),
          random_picture(7, 1, 2),        random_picture(2, 2, 3),     random_picture(16, 8, 4),
          random_picture(37, 19, 5),      single_texel(32, 16, 20, 5), single_texel(32, 16, 0, 0),
          single_texel(9, 5, 8, 4)};
}

/// The direction at (u, v) of the whole map in [0, 1]^2, in the map's space.
Vec3d direction_at(double u, double v) {
  const double azimuth = 2 * pi_double * (u - 0.5), theta = pi_double * v;
  return {std::sin(theta) * std::sin(azimuth), std::cos(theta),
          -std::sin(theta) * std::cos(azimuth)};
}

/// Calls `function(direction, solid angle)` for the middles of a grid over the whole sphere.
template <class Function>
void for_sphere(int columns, int rows, Function&& function) {
  for (int j = 0; j < rows; ++j) {
    const double solid_angle =
        2 * pi_double / columns *
        (std::cos(pi_double * j / rows) - std::cos(pi_double * (j + 1) / rows));
    for (int i = 0; i < columns; ++i)
      function(Vec3(direction_at((i + 0.5) / columns, (j + 0.5) / rows)), solid_angle);
  }
}

double brightness_of(const Color& c) {
  return 0.2126 * double{c.x} + 0.7152 * double{c.y} + 0.0722 * double{c.z};
}

void expect_color(const Color& a, const Color& b, double tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance);
}

/// Where a row lies, from 0 at the zenith to 1 at the nadir; beside the poles, where a direction
/// still has an azimuth.
double row_place(int y, int height) {
  return height > 1 ? std::clamp(double{1.0 * y} / (height - 1), 1e-6, 1 - 1e-6) : 0.5;
}

TEST(Environment, EveryTexelIsSeenWhereItLies) {
  const int width = 8, height = 4;
  Picture picture = constant(width, height, Color(0.0f));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) picture.at(x, y) = Color(x, y, 1);
  const EnvironmentMap map = make(picture);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      SCOPED_TRACE(std::to_string(x) + ", " + std::to_string(y));
      const Vec3 direction(direction_at((x + 0.5) / width, row_place(y, height)));
      expect_color(environment_radiance(map.view(), direction), picture.at(x, y), 2e-5);
    }
  }
}

// Golden values. Mitsuba 3.9's envmap emitter, evaluated with a map of 8 x 4 pixels of colours
// (column + 1, row + 1, 1), shows the red below in these directions. Its column 0 begins at -z and
// ours at +z, so a Mitsuba scene's map is turned half around about +y.
TEST(Environment, TurnedHalfAroundShowsMitsubasMap) {
  const int width = 8, height = 4;
  Picture picture = constant(width, height, Color(0.0f));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) picture.at(x, y) = Color(x + 1, y + 1, 1);
  const EnvironmentMap map = make(picture, rotate({0, 1, 0}, 180));
  const std::pair<Vec3, float> golden[] = {{{0, 0, -1}, 4.5f},
                                           {{1, 0, 0}, 2.5f},
                                           {{0, 0, 1}, 4.5f},
                                           {{-1, 0, 0}, 6.5f},
                                           {normalize({0.3f, 0.1f, -1}), 1.9023f}};
  for (const auto& [direction, red] : golden)
    EXPECT_NEAR(environment_radiance(map.view(), direction).x, red, 1e-4);
  EXPECT_NEAR(environment_radiance(map.view(), {0, 1, 0}).y, 1, 1e-5) << "zenith";
  EXPECT_NEAR(environment_radiance(map.view(), {0, 0, -1}).y, 2.5, 1e-5) << "horizon";
  EXPECT_NEAR(environment_radiance(map.view(), {0, -1, 0}).y, 4, 1e-5) << "nadir";
  // And this green at these angles to the zenith, in eighths of the way to the nadir.
  const float rows[] = {1.0f,      1.3757162f, 1.7504776f, 2.125239f, 2.5f,
                        2.874761f, 3.2495227f, 3.6242838f, 4.0f};
  for (int i = 1; i < 8; ++i) {
    const double theta = 0.001 + i * (pi_double - 0.002) / 8;
    const Vec3 direction(std::sin(theta) * std::sin(0.3), std::cos(theta),
                         -std::sin(theta) * std::cos(0.3));
    EXPECT_NEAR(environment_radiance(map.view(), direction).y, rows[i], 1e-5) << i;
  }
}

TEST(Environment, RadianceIsContinuousAroundTheSeamAndAtThePoles) {
  const EnvironmentMap map = make(random_picture(16, 8, 9));
  const Environment env = map.view();
  for (const double v : {0.1, 0.35, 0.5, 0.9}) {
    const Vec3 a(direction_at(1e-6, v)), b(direction_at(1 - 1e-6, v));
    expect_color(environment_radiance(env, a), environment_radiance(env, b), 1e-3);
  }
}

TEST(Environment, DensityIntegratesToOne) {
  for (const Picture& picture : pictures()) {
    SCOPED_TRACE(std::to_string(picture.width) + " x " + std::to_string(picture.height));
    const EnvironmentMap map = make(picture);
    double integral = 0;
    for_sphere(picture.width * 4, static_cast<int>(map.view().bands()) * 4,
               [&](const Vec3& w, double solid_angle) {
                 integral += environment_pdf(map.view(), w) * solid_angle;
               });
    EXPECT_NEAR(integral, 1, 1e-5);
  }
}

// Whatever shines can be chosen, and never with a density far below what its brightness asks for.
TEST(Environment, WhereThereIsRadianceThereIsDensity) {
  for (const Picture& picture : pictures()) {
    SCOPED_TRACE(std::to_string(picture.width) + " x " + std::to_string(picture.height));
    const EnvironmentMap map = make(picture);
    TestRandom random(6);
    for (int i = 0; i < 20'000; ++i) {
      const Vec3 w(random.direction());
      const double brightness = brightness_of(environment_radiance(map.view(), w));
      // At the corner of a cell at a pole half of the neighbour shines; on average over the cell,
      // 1/8 of 1/3.
      const double density = environment_pdf(map.view(), w) * 4 * pi_double * map.average;
      ASSERT_LE(brightness, 12.001 * density + 1e-12);
    }
  }
}

TEST(Environment, SamplesFollowTheDensity) {
  const Affine turn = rotate({1, 2, -0.5f}, 73);
  std::uint64_t seed = 10;
  for (const Picture& picture : pictures()) {
    SCOPED_TRACE(std::to_string(picture.width) + " x " + std::to_string(picture.height));
    const EnvironmentMap map = make(picture, turn);
    const Environment env = map.view();
    constexpr int columns = 48, rows = 40, samples = 300'000, fine = 8;
    std::vector<double> counts(columns * rows), expected(columns * rows);
    TestRandom random(seed++);
    int strays = 0;
    for (int i = 0; i < samples; ++i) {
      const EnvironmentSample s =
          sample_environment(env, random.unit(), random.unit(), random.unit());
      ASSERT_NEAR(glm::length(Vec3d(s.wi)), 1, 1e-6);
      ASSERT_GT(s.pdf, 0.0f);
      // Rounding may move a direction over its texel's border, rarely.
      strays += std::abs(environment_pdf(env, s.wi) - s.pdf) > 1e-6f * s.pdf;
      ASSERT_EQ(s.radiance, environment_radiance(env, s.wi));
      const Vec3d w(turn.transposed(s.wi));
      const double u = std::atan2(w.x, -w.z) / (2 * pi_double) + 0.5;
      const double v = std::acos(std::clamp(w.y, -1.0, 1.0)) / pi_double;
      ++counts[columns * cell_of(v, rows) + cell_of(u, columns)];
    }
    EXPECT_LE(strays, samples / 10'000);
    // The density of the world's directions, integrated over the cells by the midpoint rule.
    const int w = columns * fine * picture.width / std::min(picture.width, 4);
    const int bands = static_cast<int>(env.bands());
    const int h = rows * fine * bands / std::min(bands, 4);
    for_sphere(w, h, [&](const Vec3& local, double solid_angle) {
      const double u = std::atan2(local.x, -local.z) / (2 * pi_double) + 0.5;
      const double v = std::acos(double{local.y}) / pi_double;
      expected[columns * cell_of(v, rows) + cell_of(u, columns)] +=
          samples * solid_angle * environment_pdf(env, turn.vector(local));
    });
    expect_counts(counts, expected, "environment");
  }
}

TEST(Environment, ExpectationIsTheIntegralOverTheSphere) {
  std::uint64_t seed = 30;
  for (const Picture& picture : pictures()) {
    SCOPED_TRACE(std::to_string(picture.width) + " x " + std::to_string(picture.height));
    const EnvironmentMap map = make(picture, rotate({3, 1, 1}, -40));
    const Environment env = map.view();
    // Radiance against cos^2 to a fixed axis, so that directions matter too.
    const Vec3d axis = glm::normalize(Vec3d(0.3, 0.8, -0.5));
    const auto value = [&](const Vec3& w) {
      const double cosine = glm::dot(Vec3d(w), axis);
      return brightness_of(environment_radiance(env, w)) * (0.2 + cosine * cosine);
    };
    double integral = 0, power = 0;
    for_sphere(picture.width * 32, picture.height * 32, [&](const Vec3& local, double angle) {
      const Vec3 w = env.to_world.vector(local);
      integral += value(w) * angle;
      power += brightness_of(environment_radiance(env, w)) * angle;
    });
    MeanEstimate estimate;
    TestRandom random(seed++);
    for (int i = 0; i < 200'000; ++i) {
      const EnvironmentSample s =
          sample_environment(env, random.unit(), random.unit(), random.unit());
      estimate.add(value(s.wi) / s.pdf);
    }
    EXPECT_NEAR(estimate.mean(), integral, 5 * estimate.sigma() + 1e-3 * integral);
    EXPECT_NEAR(env.average * 4 * pi_double, power, 1e-3 * power);
  }
}

// In a fine map, brightness and density are proportional: one sample tells nearly everything.
TEST(Environment, AFineMapIsSampledWithLittleVariance) {
  Picture picture = constant(256, 128, Color(0.0f));
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 256; ++x)
      picture.at(x, y) = Color(1.2f + std::sin(0.05f * x) * std::cos(0.1f * y));
  }
  const EnvironmentMap map = make(picture);
  TestRandom random(7);
  MeanEstimate estimate;
  for (int i = 0; i < 10'000; ++i) {
    const EnvironmentSample s =
        sample_environment(map.view(), random.unit(), random.unit(), random.unit());
    estimate.add(s.radiance.y / s.pdf);
  }
  EXPECT_LE(estimate.sigma() * 100, 0.05 * estimate.mean()) << "relative standard deviation";
  EXPECT_NEAR(estimate.mean(), 4 * pi_double * map.average, 5 * estimate.sigma());
}

TEST(Environment, ARotationTurnsTheMap) {
  const Affine turn = rotate({0, 1, 0}, 90);  // -z to -x
  const EnvironmentMap map = make(single_texel(8, 4, 4, 1)),
                       turned = make(single_texel(8, 4, 4, 1), turn);
  TestRandom random(8);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 w(random.direction());
    expect_color(environment_radiance(turned.view(), turn.vector(w)),
                 environment_radiance(map.view(), w), 2e-2);
  }
  const Vec3 center(direction_at(4.5 / 8, row_place(1, 4)));
  EXPECT_NEAR(environment_radiance(turned.view(), {center.z, center.y, -center.x}).x, 1000, 1e-2);
  // A uniform scale does not matter.
  const EnvironmentMap scaled = make(single_texel(8, 4, 4, 1), turn * scale(Vec3(3.0f)));
  EXPECT_NEAR(environment_radiance(scaled.view(), {center.z, center.y, -center.x}).x, 1000, 1e-2);
}

TEST(Environment, Errors) {
  const float infinity = std::numeric_limits<float>::infinity();
  expect_error([] { make_environment(3, 2, std::vector<Color>(5), {}); }, "environment of 3 x 2");
  expect_error([] { make_environment(0, 2, {}, {}); }, "environment of 0 x 2");
  expect_error([] { make_environment(-1, -1, std::vector<Color>(1), {}); }, "environment of -1");
  Picture bad = constant(3, 2, Color(1.0f));
  bad.at(2, 1).y = -1;
  expect_error([&] { make(bad); }, "pixel (2, 1) is (1, -1, 1)");
  bad.at(2, 1).y = infinity;
  expect_error([&] { make(bad); }, "pixel (2, 1) is (1, inf, 1)");
  bad.at(2, 1).y = std::nanf("");
  expect_error([&] { make(bad); }, "pixel (2, 1) is (1, nan, 1)");
  const Picture good = constant(2, 2, Color(1.0f));
  expect_error([&] { make(good, scale({1, 2, 1})); }, "to_world");
  expect_error([&] { make(good, scale({1, 1, 0})); }, "to_world");
}

}  // namespace
}  // namespace pt
