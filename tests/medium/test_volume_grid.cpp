// Values of grids against a sum over all voxels in double precision, and what add_grid refuses.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/error/error.h"
#include "medium/volume_cases.h"

namespace pt {
namespace {

const GridSize grid_sizes[] = {{1, 1, 1}, {1, 5, 3}, {2, 1, 1}, {4, 1, 7}, {3, 4, 5}, {9, 2, 6}};

TEST(VolumeGrid, ValuesAreThoseOfAllVoxels) {
  TestRandom random(31);
  for (const GridSize& size : grid_sizes) {
    for (const std::uint32_t channels : {1u, 3u}) {
      for (const bool interpolates : {false, true}) {
        const VolumeData volume =
            random_volume(random, size, channels, interpolates, random_place(random));
        const SceneData scene = scene_of_density(volume);
        const ReferenceVolume reference(volume);
        SCOPED_TRACE(fmt::format("{} x {} x {}, {} channels, interpolates {}", size[0], size[1],
                                 size[2], channels, interpolates));
        for (int i = 0; i < 500; ++i) {
          // Three eighths of the points are inside the cube.
          const glm::dvec3 unit = random.point(0.7) + 0.5;
          const Vec3 point(reference.to_world(unit));
          if (reference.is_near_a_jump(glm::dvec3(point), 1e-4)) continue;
          const Color found = sample_grid(grids_of(scene), scene.grids[0], point);
          for (std::uint32_t c = 0; c < 3; ++c) {
            const double expected = reference.value(glm::dvec3(point), c);
            ASSERT_NEAR(found[static_cast<int>(c)], expected, 1e-4) << "channel " << c;
          }
        }
      }
    }
  }
}

TEST(VolumeGrid, AVoxelsMiddleHasItsValue) {
  for (const bool interpolates : {false, true}) {
    const VolumeData volume =
        make_volume({4, 2, 8}, 3, interpolates, Affine(), [](const GridSize& v, std::uint32_t c) {
          return v[0] + 10 * v[1] + 100 * v[2] + 0.25 * c;
        });
    const SceneData scene = scene_of_density(volume);
    const auto at = [&](float x, float y, float z) {
      return sample_grid(grids_of(scene), scene.grids[0],
                         Vec3((x + 0.5f) / 4, (y + 0.5f) / 2, (z + 0.5f) / 8));
    };
    EXPECT_EQ(at(0, 0, 0), Color(0, 0.25f, 0.5f));
    EXPECT_EQ(at(3, 0, 0), Color(3, 3.25f, 3.5f));
    EXPECT_EQ(at(1, 1, 5), Color(511, 511.25f, 511.5f));
    EXPECT_EQ(at(-9, 1, 5), Color(510, 510.25f, 510.5f));  // beyond the cube
    EXPECT_EQ(at(3, 1e6f, 1e6f), Color(713, 713.25f, 713.5f));
    EXPECT_EQ(at(1.25f, 0, 0).x, interpolates ? 1.25f : 1.0f);
  }
}

TEST(VolumeGrid, GridsOfASceneStandSideBySide) {
  SceneData scene;
  const auto constant = [&](const GridSize& size, std::uint32_t channels, double value) {
    return add_grid(scene,
                    make_volume(size, channels, true, Affine(),
                                [&](const GridSize&, std::uint32_t c) { return value + c; }));
  };
  EXPECT_EQ(constant({2, 3, 1}, 1, 1), 0u);
  EXPECT_EQ(constant({1, 1, 2}, 3, 20), 1u);
  EXPECT_EQ(constant({5, 1, 1}, 1, 7), 2u);
  const Color expected[] = {Color(1), Color(20, 21, 22), Color(7)};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(sample_grid(grids_of(scene), scene.grids[i], Vec3(0.3f)), expected[i]);
  }
}

/// What add_grid says of a grid.
std::string refusal_of_grid(const VolumeData& volume) {
  SceneData scene;
  scene.name = "smoke";
  try {
    add_grid(scene, volume);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(VolumeGrid, WhatIsNoGridIsRefused) {
  const VolumeData good =
      make_volume({2, 1, 2}, 1, true, Affine(), [](const GridSize&, std::uint32_t) { return 1; });
  EXPECT_EQ(refusal_of_grid(good), "no error");
  const auto with_change = [&](auto&& change) {
    VolumeData volume = good;
    change(volume);
    return refusal_of_grid(volume);
  };
  const std::string grid = "scene 'smoke': a grid of 2 x 1 x 2 voxels: ";
  EXPECT_EQ(with_change([](VolumeData& v) { v.size[1] = 0; }),
            "scene 'smoke': a grid of 2 x 0 x 2 voxels: expected at least one");
  EXPECT_EQ(with_change([](VolumeData& v) { v.channels = 2; }),
            grid + "2 channels; expected 1 or 3");
  EXPECT_EQ(with_change([](VolumeData& v) { v.channels = 3; }), grid + "4 values; expected 12");
  EXPECT_EQ(with_change([](VolumeData& v) { v.values[3] = -0.5f; }),
            grid + "a value of -0.5; expected finite ones, at least 0");
  for (const float value : {HUGE_VALF, std::nanf("")}) {
    EXPECT_NE(with_change([&](VolumeData& v) { v.values[2] = value; }), "no error");
  }
  EXPECT_EQ(with_change([](VolumeData& v) {
              v.to_world = scale({1, 0, 1});
            }),
            grid + "expected a map that has an inverse");
}

}  // namespace
}  // namespace pt
