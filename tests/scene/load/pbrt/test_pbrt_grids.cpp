// The grids of pbrt's media, against a lookup of its samples in double precision.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>

#include "common/medium/sample_grid.h"
#include "common/scene/load/pbrt/scene_parts.h"
#include "load/expect_near.h"
#include "load/pbrt_scene.h"
#include "statistics.h"

namespace pt {
namespace {

/// A scene whose only medium has these parameters.
SceneData scene_of_grid(const std::string& type, const std::string& parameters,
                        const std::string& transform = {}) {
  return load_pbrt_silently(pbrt_world(
      lit + "AttributeBegin " + transform + " MakeNamedMedium \"fog\" \"string type\" \"" + type +
      "\" " + parameters +
      "\nAttributeEnd MediumInterface \"fog\" \"\" Material \"interface\" Shape \"sphere\""));
}

/// What a medium is at a point.
struct Properties {
  Color absorption, scattering, emission;
};

Properties properties_at(const SceneData& scene, const Vec3& point) {
  const Medium& medium = scene.media.at(0);
  const VolumeGrids grids{scene.grids.data(), scene.grid_values.data(), nullptr};
  const Color extinction =
      medium.extinction * sample_grid(grids, grids.grids[medium.density_grid], point);
  const Color albedo = albedo_at(grids, medium, point);
  return {extinction * (Color(1) - albedo), extinction * albedo, emission_at(grids, medium, point)};
}

std::string list_of(const std::vector<float>& values) {
  std::string text = "[";
  for (const float value : values) text += fmt::format(" {}", value);
  return text + " ]";
}

/// Samples in the middles of voxels of the unit cube, linear between them and to zeros around.
struct Samples {
  int size[3];
  std::vector<float> values;
  std::size_t channels = 1;

  double at(int i, int j, int k, std::size_t channel) const {
    const bool inside = i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2];
    const int index = i + size[0] * (j + size[1] * k);
    return inside ? double{values[static_cast<std::size_t>(index) * channels + channel]} : 0.0;
  }
  double lookup(const glm::dvec3& p, std::size_t channel = 0) const {
    int low[3];
    double part[3];
    for (int a = 0; a < 3; ++a) {
      const double x = p[a] * size[a] - 0.5;
      low[a] = static_cast<int>(std::floor(x)), part[a] = x - low[a];
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int s[3] = {corner & 1, corner >> 1 & 1, corner >> 2};
      double weight = 1;
      for (int a = 0; a < 3; ++a) weight *= s[a] ? part[a] : 1 - part[a];
      sum += weight * at(low[0] + s[0], low[1] + s[1], low[2] + s[2], channel);
    }
    return sum;
  }
};

Samples random_samples(int x, int y, int z, std::size_t channels, std::uint64_t seed) {
  TestRandom random(seed);
  Samples samples{{x, y, z}, {}, channels};
  samples.values.resize(static_cast<std::size_t>(x * y * z) * channels);
  for (float& value : samples.values) value = random.unit();
  return samples;
}

const std::string size_345 = "\"integer nx\" 3 \"integer ny\" 4 \"integer nz\" 5 ";

/// Calls with points of the cube, and where they lie in a world in which it is p0 to p1, moved.
template <class Test>
void at_points_of_the_box(Test&& test) {
  TestRandom random(5);
  for (int n = 0; n < 300 && !testing::Test::HasFailure(); ++n) {
    const glm::dvec3 u(random.unit(), random.unit(), random.unit());
    const glm::dvec3 local = glm::dvec3(-1, 0, 2) + u * glm::dvec3(2, 1, 3);  // -1 0 2 to 1 1 5
    test(u, Vec3(local * 2.0 + glm::dvec3(7, 0, 0)));
  }
}
const std::string box_of_points = "\"point3 p0\" [-1 1 2] \"point3 p1\" [1 0 5] ";
const std::string moved_box = "Translate 7 0 0 Scale 2 2 2";

TEST(PbrtGrids, DensitiesAreLookedUpAsInPbrt) {
  const Samples density = random_samples(3, 4, 5, 1, 1), light = random_samples(3, 4, 5, 1, 2);
  const SceneData scene = scene_of_grid(
      "uniformgrid",
      size_345 + box_of_points + "\"float density\" " + list_of(density.values) +
          "\"float Lescale\" " + list_of(light.values) +
          "\"rgb Le\" [1 2 3] \"rgb sigma_a\" [1 .5 0] \"rgb sigma_s\" [1 2 3] \"float scale\" 3",
      moved_box);
  at_points_of_the_box([&](const glm::dvec3& u, const Vec3& point) {
    const auto d = static_cast<float>(3 * density.lookup(u));
    const Properties at = properties_at(scene, point);
    expect_near(at.absorption, d * Color(1, 0.5f, 0));  // not by the scale of the space
    expect_near(at.scattering, d * Color(1, 2, 3));
    expect_near(at.emission, static_cast<float>(light.lookup(u)) * Color(1, 2, 3));
  });
}

TEST(PbrtGrids, EmissionWithoutAScaleFadesFromTheMiddleAsInPbrt) {
  const SceneData scene = scene_of_grid(
      "uniformgrid", box_of_points + "\"float density\" 1 \"rgb Le\" [1 2 3]", moved_box);
  const Samples one{{1, 1, 1}, {1}, 1};
  at_points_of_the_box([&](const glm::dvec3& u, const Vec3& point) {
    expect_near(properties_at(scene, point).emission,
                static_cast<float>(one.lookup(u)) * Color(1, 2, 3));
  });
}

TEST(PbrtGrids, EndBeyondTheirBox) {
  const SceneData scene =
      scene_of_grid("uniformgrid", size_345 + box_of_points + "\"float density\" " +
                                       list_of(std::vector<float>(60, 1)));
  for (const Vec3& point : {Vec3(9, 0.5f, 3), Vec3(0, -9, 3), Vec3(0, 0.5f, 6)}) {
    expect_near(properties_at(scene, point).scattering, Color(0));
  }
  expect_near(properties_at(scene, {0, 0.5f, 3.5f}).scattering, Color(1));
}

TEST(PbrtGrids, ColoursAreThoseOfPbrtWhereTheAlbedoIsConstant) {
  Samples absorption = random_samples(3, 4, 5, 3, 3), scattering = absorption;
  for (std::size_t i = 0; i < absorption.values.size(); ++i) {
    if (i % 7 < 3) absorption.values[i] = 0;  // nothing at all
    scattering.values[i] = absorption.values[i] * std::array{1.0f, 3.0f, 0.25f}[i % 3];
  }
  const Samples light = random_samples(3, 4, 5, 3, 4);
  const SceneData scene =
      scene_of_grid("rgbgrid",
                    size_345 + box_of_points + "\"rgb sigma_a\" " + list_of(absorption.values) +
                        "\"rgb sigma_s\" " + list_of(scattering.values) + "\"rgb Le\" " +
                        list_of(light.values) + "\"float scale\" 2 \"float Lescale\" 5",
                    moved_box);
  at_points_of_the_box([&](const glm::dvec3& u, const Vec3& point) {
    const auto expected = [&](const Samples& samples, double scale) {
      return Color(scale * samples.lookup(u, 0), scale * samples.lookup(u, 1),
                   scale * samples.lookup(u, 2));
    };
    const Properties at = properties_at(scene, point);
    expect_near(at.absorption, expected(absorption, 2));
    expect_near(at.scattering, expected(scattering, 2));
    expect_near(at.emission, expected(light, 5), 3e-5f);
  });
}

TEST(PbrtGrids, ColoursAreRightInTheMiddlesOfVoxels) {
  const Samples absorption = random_samples(2, 2, 1, 3, 6),
                scattering = random_samples(2, 2, 1, 3, 7);
  const std::string size = "\"integer nx\" 2 \"integer ny\" 2 ";
  const SceneData both =
      scene_of_grid("rgbgrid", size + "\"rgb sigma_a\" " + list_of(absorption.values) +
                                   "\"rgb sigma_s\" " + list_of(scattering.values));
  const SceneData one =
      scene_of_grid("rgbgrid", size + "\"rgb sigma_a\" " + list_of(absorption.values));
  for (int voxel = 0; voxel < 4; ++voxel) {
    const Vec3 point(voxel % 2 ? 0.75f : 0.25f, voxel / 2 ? 0.75f : 0.25f, 0.5f);
    const auto of = [&](const Samples& s) {
      const float* v = &s.values[static_cast<std::size_t>(3 * voxel)];
      return Color(v[0], v[1], v[2]);
    };
    expect_near(properties_at(both, point).absorption, of(absorption));
    expect_near(properties_at(both, point).scattering, of(scattering));
    expect_near(properties_at(one, point).absorption, of(absorption));
    expect_near(properties_at(one, point).scattering, Color(1));  // pbrt's of one that is absent
  }
}

TEST(PbrtGrids, GreyOnesHaveOneChannel) {
  const SceneData scene = scene_of_grid(
      "rgbgrid", "\"integer nx\" 2 \"rgb sigma_a\" [1 1 1 2 2 2] \"rgb sigma_s\" [1 1 1 2 2 2]");
  ASSERT_EQ(scene.grids.size(), 1u);
  EXPECT_EQ(scene.grids[0].channels, 1u);
  expect_near(scene.media[0].albedo, Color(0.5f));
}

/// The CIE's y-bar, by Wyman, Sloan and Shirley 2013, 'Simple analytic approximations to the CIE
/// XYZ color matching functions'.
double y_bar(double nm) {
  const auto lobe = [nm](double scale, double mean, double below, double above) {
    const double t = (nm - mean) / (nm < mean ? below : above);
    return scale * std::exp(-0.5 * t * t);
  };
  return lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1);
}

/// The integral over nm of y-bar and of Planck's law over its maximum.
double luminance_of_gas(double kelvins) {
  const auto planck = [kelvins](double nm) {
    return std::pow(nm, -5) / std::expm1(1.438776877e7 / (nm * kelvins));
  };
  double sum = 0;
  for (int nm = 380; nm <= 780; ++nm) sum += y_bar(nm) * planck(nm);
  return sum / planck(2.897771955e6 / kelvins);
}

TEST(PbrtGrids, TemperaturesAreBlackbodies) {
  const SceneData scene = scene_of_grid(
      "uniformgrid",
      "\"integer nx\" 4 \"float density\" [1 1 1 1] \"float temperature\" [60 1250 2500 3750] "
      "\"float temperatureoffset\" 50 \"float temperaturescale\" 2 \"float Lescale\" [1 2 3 4]");
  for (int voxel = 0; voxel < 4; ++voxel) {
    const Color light =
        properties_at(scene, {0.125f + 0.25f * static_cast<float>(voxel), 0.5f, 0.5f}).emission;
    const double luminance = double{dot(light, Color(0.2126f, 0.7152f, 0.0722f))};
    const double kelvins =
        std::array{20.0, 2400.0, 4900.0, 7400.0}[static_cast<std::size_t>(voxel)];
    const double expected = voxel == 0 ? 0 : (voxel + 1) * luminance_of_gas(kelvins);
    EXPECT_NEAR(luminance, expected, 0.02 * expected) << kelvins;
  }
}

TEST(PbrtGrids, TheTableOfTemperaturesIsFine) {
  const pbrt::GlowingGas coarse(10000), exact(2345);
  expect_near(coarse.radiance(2345) / exact.radiance(2345), Color(1), 5e-3f);
  EXPECT_EQ(coarse.radiance(100), Color(0));
}

// Perlin's noise is zero at integers, and its slopes there are sums of two coordinates with signs.
TEST(PbrtGrids, NoiseHasPerlinsSlopes) {
  TestRandom random(8);
  int slopes[3] = {};
  for (int n = 0; n < 500; ++n) {
    const Vec3 corner = glm::floor(Vec3(random.point(1000)));
    ASSERT_EQ(pbrt::perlin_noise(corner), 0.0f);
    int sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 beside = corner;
      constexpr float delta = 0x1p-6f;
      beside[axis] += delta;
      const float slope = pbrt::perlin_noise(beside) / delta;
      const int whole = static_cast<int>(std::round(slope));
      EXPECT_NEAR(slope, whole, 0.02);
      sum += std::abs(whole), slopes[axis] += std::abs(whole);
    }
    EXPECT_EQ(sum, 2);
  }
  // In pbrt 6 of 16 slopes are of x and y, 4 of x and z, 6 of y and z: 10, 12 and 10 have x, y, z.
  EXPECT_NEAR(slopes[0], 500 * 10 / 16, 55);
  EXPECT_NEAR(slopes[1], 500 * 12 / 16, 50);
  EXPECT_NEAR(slopes[2], 500 * 10 / 16, 55);
}

// Computed by pbrt's own functions.
TEST(PbrtGrids, CloudsArePbrts) {
  struct Case {
    pbrt::CloudShape shape;
    Vec3 at;
    float density;
  };
  for (const Case& c : {Case{{1, 1, 5}, {0.3f, 0.7f, 0.4f}, 0.066423f},
                        {{2, 0, 3}, {0.15f, 0.9f, 0.55f}, 0.148480f},
                        {{3, 2, 5}, {0.5f, 0.6f, 0.9f}, 0.465737f},
                        {{2, 1, 5}, {0.43f, 0.71f, 0.66f}, 0.516935f},
                        {{1, 1, 5}, {0.62f, 0.8f, 0.21f}, 0.0f}}) {
    EXPECT_NEAR(pbrt::cloud_density(c.shape, c.at), c.density, 1e-4);
  }
  EXPECT_NEAR(pbrt::perlin_noise({0.37f, 0.81f, 0.11f}), -0.0662054, 1e-5);
  EXPECT_NEAR(pbrt::perlin_noise({2.97f, -3.19f, 1.65f}), -0.4987592, 1e-5);
}

TEST(PbrtGrids, CloudsAreGrids) {
  const SceneData scene =
      scene_of_grid("cloud",
                    "\"point3 p0\" [0 -.5 0] \"point3 p1\" [1 1.5 .5] \"float frequency\" .25 "
                    "\"rgb sigma_a\" [0 0 0] \"rgb sigma_s\" [3 2 1]");
  const VolumeGrid& grid = scene.grids.at(0);
  EXPECT_EQ(grid.size[0], 8u + 2);
  EXPECT_EQ(grid.size[1], 16u + 2);
  EXPECT_EQ(grid.size[2], 4u + 2);
  EXPECT_EQ(scene.media[0].extinction, Color(3, 2, 1));
  for (int j = 0; j < 16; ++j) {
    const Vec3 middle(0.4375f, -0.5f + 0.125f * (static_cast<float>(j) + 0.5f), 0.1875f);
    const float expected = pbrt::cloud_density({1, 1, 0.25f}, middle);
    expect_near(properties_at(scene, middle).scattering, expected * Color(3, 2, 1));
    if (middle.y < 0) {
      EXPECT_EQ(expected, 1.0f);
    }
  }
}

}  // namespace
}  // namespace pt
