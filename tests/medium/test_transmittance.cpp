// What gets through media, estimated, against what is known of slabs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/medium/free_flight.h"
#include "medium/volume_cases.h"

namespace pt {
namespace {

void expect_transmittance(const SceneData& scene, const Ray& ray, float t_max, int samples,
                          const std::function<double(int)>& depth) {
  TestRandom random(61);
  MeanEstimate passed[3];
  for (int i = 0; i < samples; ++i) {
    const Color one =
        estimate_transmittance(grids_of(scene), scene.media[0], ray, t_max, random.bits());
    for (int c = 0; c < 3; ++c) {
      ASSERT_GE(one[c], 0);
      passed[c].add(double{one[c]});
    }
  }
  for (int c = 0; c < 3; ++c) {
    const double expected = std::exp(-depth(c));
    EXPECT_NEAR(passed[c].mean(), expected, 5 * passed[c].sigma() + 1e-6)
        << "channel " << c << ", depth " << depth(c);
    // A test that can fail.
    EXPECT_LT(passed[c].sigma(), 0.06 * expected + 1e-9) << "channel " << c;
  }
}

const Ray upright{Vec3(0.0f), Vec3(0, 0, 1)};

TEST(Transmittance, OfHomogeneousMediaIsExact) {
  Medium medium;
  medium.extinction = {0.0f, 0.5f, 3.0f};
  for (const float length : {0.0f, 0.3f, 8.0f, infinite_distance}) {
    const Color found = estimate_transmittance({}, medium, upright, length, 5);
    for (int c = 0; c < 3; ++c) {
      const double expected = std::exp(-double{medium.extinction[c]} * double{length});
      EXPECT_NEAR(found[c], expected, 1e-6 * expected);
    }
  }
}

struct TransmittanceSlab {
  const char* name;
  std::uint32_t voxels;
  double (*density)(double z);
  double integral;  ///< from 0 to 2
};

const TransmittanceSlab transmittance_slabs[] = {
    {"constant", 1, [](double) { return 0.5; }, 1},
    {"linear", 2, [](double z) { return 0.05 + 0.45 * z; }, 1},
    {"linear, many cells", 60, [](double z) { return 1.5 - 0.75 * z; }, 1.5},
    {"exponential", 257, [](double z) { return 2 * std::exp(-z); }, 1.7293294335267746},
};

TEST(Transmittance, OfSlabsIsTheirs) {
  for (const TransmittanceSlab& slab : transmittance_slabs) {
    SCOPED_TRACE(slab.name);
    const VolumeData volume =
        slab.voxels > 1
            ? slab_volume(slab.voxels, 2, 1,
                          [&](double z, std::uint32_t) { return slab.density(z); })
            : make_volume({1, 1, 1}, 1, false, Affine(),
                          [&](const GridSize&, std::uint32_t) { return slab.density(0); });
    for (const Color& extinction :
         {Color(1.0f), Color(0.2f, 1.0f, 2.5f), Color(0.0f, 3.0f, 0.5f)}) {
      expect_transmittance(scene_of_density(volume, extinction), upright, 2, 40'000,
                           [&](int c) { return double{extinction[c]} * slab.integral; });
    }
  }
}

TEST(Transmittance, OfAColouredGridToo) {
  const VolumeData volume = slab_volume(20, 2, 3, [](double z, std::uint32_t c) {
    return c == 0 ? 0.2 + z : c == 1 ? 1.5 - 0.7 * z : 0.0;
  });
  const double integrals[] = {2.4, 1.6, 0};
  const Color extinction(0.5f, 1.0f, 2.0f);
  expect_transmittance(scene_of_density(volume, extinction), upright, 2, 60'000,
                       [&](int c) { return double{extinction[c]} * integrals[c]; });
}

// Deep ones, where roulette decides: majorants above the density, so that a collision leaves a
// part.
TEST(Transmittance, SurvivesRouletteWithoutBias) {
  for (const float depth : {3.0f, 5.0f, 7.0f}) {
    const Color extinction(depth, 0.5f * depth, 0.9f * depth);
    SceneData scene = scene_of_density(
        make_volume({1, 1, 1}, 1, true, Affine(), [](const GridSize&, std::uint32_t) { return 1; }),
        extinction);
    scene.majorants[0] = 1.6f;
    expect_transmittance(scene, upright, 1, 400'000, [&](int c) { return double{extinction[c]}; });
  }
}

TEST(Transmittance, OfWhatIsClearIsOne) {
  const VolumeData volume =
      slab_volume(30, 2, 1, [](double z, std::uint32_t) { return std::max(z - 1, 0.0); });
  const SceneData scene = scene_of_density(volume, Color(5.0f)),
                  black = scene_of_density(volume, Color(0.0f));
  for (std::uint32_t key = 0; key < 1000; ++key) {
    EXPECT_EQ(estimate_transmittance(grids_of(scene), scene.media[0], upright, 0.9f, key),
              Color(1.0f));
    EXPECT_EQ(estimate_transmittance(grids_of(scene), scene.media[0],
                                     {Vec3(0, 0, -1), Vec3(0, 0, -1)}, infinite_distance, key),
              Color(1.0f));
    EXPECT_EQ(estimate_transmittance(grids_of(black), black.media[0], upright, 2, key),
              Color(1.0f));
    EXPECT_EQ(estimate_transmittance(grids_of(scene), scene.media[0], upright, 1e6f, key),
              Color(0.0f));
  }
}

// The same as the share of flights that arrive, along random rays through a random grid.
TEST(Transmittance, IsTheReferenceIntegralsAlongRandomRays) {
  TestRandom random(62);
  for (const bool interpolates : {false, true}) {
    const VolumeData volume =
        random_volume(random, {9, 3, 10}, 3, interpolates, random_place(random));
    const ReferenceVolume reference(volume);
    const Color extinction(0.3f, 0.6f, 0.2f);
    const SceneData scene = scene_of_density(volume, extinction);
    for (int i = 0; i < 4; ++i) {
      const Ray ray{volume.to_world.point(Vec3(random.point(0.6) + 0.5)),
                    normalize(Vec3(random.direction()))};
      constexpr int steps = 4000;
      constexpr double t_max = 2;
      glm::dvec3 depths(0);
      for (int step = 0; step < steps; ++step) {
        const double t = t_max * (step + 0.5) / steps;
        for (std::uint32_t c = 0; c < 3; ++c) {
          depths[static_cast<int>(c)] +=
              reference.value(glm::dvec3(ray.origin) + t * glm::dvec3(ray.direction), c) * t_max /
              steps;
        }
      }
      expect_transmittance(scene, ray, float{t_max}, 40'000,
                           [&](int c) { return double{extinction[c]} * depths[c]; });
    }
  }
}

}  // namespace
}  // namespace pt
