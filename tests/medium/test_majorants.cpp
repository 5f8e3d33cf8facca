// The bounds of densities: that they hold, that they are no looser than said, and walks through
// them against all crossings of a ray with the cells' walls, sorted, in double precision.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/medium/majorant_walk.h"
#include "medium/volume_cases.h"

namespace pt {
namespace {

GridSize cell_at(const VolumeGrid& grid, const glm::dvec3& unit) {
  GridSize cell;
  for (int axis = 0; axis < 3; ++axis) {
    const double at = std::floor(unit[axis] * grid.cells[axis]);
    cell[static_cast<std::size_t>(axis)] =
        static_cast<std::uint32_t>(std::clamp(at, 0.0, grid.cells[axis] - 1.0));
  }
  return cell;
}

double majorant_of(const SceneData& scene, const VolumeGrid& grid, const GridSize& cell) {
  return double{scene.majorants[grid.first_cell + cell[0] +
                                grid.cells[0] * (cell[1] + std::size_t{grid.cells[1]} * cell[2])]};
}

/// The largest value of the voxels that a cell, made wider by `wider` voxels, meets.
double largest_value(const VolumeData& v, const VolumeGrid& grid, const GridSize& cell,
                     double wider) {
  double largest = 0;
  std::size_t i = 0;
  const auto is_met = [&](std::size_t axis, std::uint32_t voxel) {
    const double side = double(v.size[axis]) / grid.cells[axis];
    return voxel + 1 > cell[axis] * side - wider && voxel < (cell[axis] + 1) * side + wider;
  };
  for (std::uint32_t z = 0; z < v.size[2]; ++z) {
    for (std::uint32_t y = 0; y < v.size[1]; ++y) {
      for (std::uint32_t x = 0; x < v.size[0]; ++x) {
        for (std::uint32_t c = 0; c < v.channels; ++c, ++i) {
          if (is_met(0, x) && is_met(1, y) && is_met(2, z))
            largest = std::max(largest, double{v.values[i]});
        }
      }
    }
  }
  return largest;
}

constexpr GridSize bounded_sizes[] = {{1, 1, 1},   {1, 5, 3},    {8, 8, 8},  {9, 17, 30},
                                      {16, 3, 40}, {1030, 1, 2}, {2, 521, 1}};

TEST(Majorants, BoundWhatIsInTheirCellsAndAreNotLoose) {
  TestRandom random(41);
  for (const GridSize& size : bounded_sizes) {
    for (const std::uint32_t channels : {1u, 3u}) {
      for (const bool interpolates : {false, true}) {
        SCOPED_TRACE(fmt::format("{} x {} x {}, {} channels, interpolates {}", size[0], size[1],
                                 size[2], channels, interpolates));
        const VolumeData volume =
            random_volume(random, size, channels, interpolates, random_place(random));
        const SceneData scene = scene_of_density(volume);
        const VolumeGrid& grid = scene.grids[0];
        ASSERT_EQ(scene.majorants.size(),
                  std::size_t{grid.cells[0]} * grid.cells[1] * grid.cells[2]);
        for (int axis = 0; axis < 3; ++axis) {
          const std::uint32_t cells = (size[static_cast<std::size_t>(axis)] + 7) / 8;
          EXPECT_EQ(grid.cells[axis], std::min(cells, 64u));
        }
        const ReferenceVolume reference(volume);
        for (int i = 0; i < 5000; ++i) {
          const glm::dvec3 unit = random.point(0.7) + 0.5;
          const Color value = sample_grid(grids_of(scene), grid, Vec3(reference.to_world(unit)));
          const double bound = majorant_of(scene, grid, cell_at(grid, unit));
          ASSERT_LE(double{max_abs(value)}, bound * (1 + 1e-6)) << "at " << unit.x << ' ' << unit.y;
        }
        GridSize cell;
        for (cell[2] = 0; cell[2] < grid.cells[2]; ++cell[2]) {
          for (cell[1] = 0; cell[1] < grid.cells[1]; ++cell[1]) {
            for (cell[0] = 0; cell[0] < grid.cells[0]; ++cell[0]) {
              const double bound = majorant_of(scene, grid, cell);
              ASSERT_GE(bound, largest_value(volume, grid, cell, interpolates ? 0.5 : 0.0));
              // Rounding and whole voxels may take one more on each side.
              ASSERT_LE(bound, largest_value(volume, grid, cell, interpolates ? 1.5 : 1.0));
            }
          }
        }
      }
    }
  }
}

TEST(Majorants, OneBrightVoxelIsBrightInFewCells) {
  for (const std::uint32_t at : {0u, 4u, 8u, 20u, 63u}) {
    const VolumeData volume =
        make_volume({64, 1, 1}, 1, true, Affine(),
                    [&](const GridSize& v, std::uint32_t) { return v[0] == at ? 5 : 0; });
    const SceneData scene = scene_of_density(volume);
    EXPECT_EQ(scene.majorants[at / 8], 5);
    const auto bright = std::count(scene.majorants.begin(), scene.majorants.end(), 5.0f);
    EXPECT_LE(bright, at % 8 == 0 && at > 0 ? 2 : 1);
    EXPECT_EQ(std::count(scene.majorants.begin(), scene.majorants.end(), 0.0f), 8 - bright);
  }
}

TEST(Majorants, OnlyDensitiesHaveThem) {
  SceneData scene;
  Medium medium;
  const auto constant = [&](double value) {
    return add_grid(scene, make_volume({9, 1, 1}, 1, true, Affine(),
                                       [&](const GridSize&, std::uint32_t) { return value; }));
  };
  medium.albedo_grid = constant(1);
  medium.density_grid = constant(2);
  medium.emission_grid = constant(3);
  scene.media.push_back(medium);
  for (int i = 0; i < 2; ++i) {  // what is prepared again is made anew
    prepare_media(scene);
    EXPECT_EQ(scene.majorants, (std::vector<float>{2, 2}));
    EXPECT_EQ(scene.grids[0].cells[0], 0u);
    EXPECT_EQ(scene.grids[1].cells[0], 2u);
    EXPECT_EQ(scene.grids[2].cells[0], 0u);
  }
}

/// The least of |i|, |j|, |k| at which a cell differs from one that is not empty.
int empty_steps(const std::vector<float>& majorants, const GridSize& size, int x, int y, int z) {
  int nearest = 1 << 20;
  std::size_t cell = 0;
  for (int k = 0; k < static_cast<int>(size[2]); ++k) {
    for (int j = 0; j < static_cast<int>(size[1]); ++j) {
      for (int i = 0; i < static_cast<int>(size[0]); ++i) {
        if (!(majorants[cell++] > 0)) continue;
        const int farthest = std::max({std::abs(x - i), std::abs(y - j), std::abs(z - k)});
        nearest = std::min(nearest, farthest);
      }
    }
  }
  return nearest;
}

/// The same, with distances in empty cells.
std::vector<float> with_distances(const std::vector<float>& majorants, const GridSize& size) {
  std::vector<float> result = majorants;
  for (std::size_t cell = 0; cell < result.size(); ++cell) {
    if (result[cell] > 0) continue;
    const auto x = static_cast<int>(cell % size[0]), y = static_cast<int>(cell / size[0] % size[1]),
               z = static_cast<int>(cell / size[0] / size[1]);
    result[cell] = -static_cast<float>(empty_steps(majorants, size, x, y, z));
  }
  return result;
}

// Beside a sparse grid, empty cells say how far the next one is that is not.
TEST(Majorants, SayHowFarEmptySpaceGoes) {
  TestRandom random(48);
  SceneData scene;
  scene.grid_nodes.resize(1);
  std::vector<GridSize> sizes{{33, 70, 17}, {128, 90, 100}, {512, 1, 9}, {40, 40, 40}};
  for (const GridSize& size : sizes) {
    Medium medium;
    const bool is_empty = size[0] == 40;
    medium.density_grid =
        add_grid(scene, make_volume(size, 1, true, Affine(), [&](const GridSize&, std::uint32_t) {
                   return !is_empty && random.uniform(0, 1) < 2e-5 ? 1.0 : 0.0;
                 }));
    scene.media.push_back(medium);
  }
  prepare_media(scene);
  for (const VolumeGrid& grid : scene.grids) {
    const GridSize cells{grid.cells[0], grid.cells[1], grid.cells[2]};
    const auto first = scene.majorants.begin() + grid.first_cell;
    const std::vector<float> majorants(first, first + cells[0] * cells[1] * cells[2]);
    const std::vector<float> expected = with_distances(majorants, cells);
    EXPECT_LT(*std::ranges::min_element(majorants), -1);
    for (std::size_t i = 0; i < majorants.size(); ++i) {
      ASSERT_EQ(std::max(majorants[i], -1048576.0f), expected[i]) << i;
    }
  }
}

/// A grid of majorants alone.
struct MajorantCase {
  SceneData scene;

  MajorantCase(TestRandom& random, const GridSize& cells, const Affine& to_unit) {
    VolumeGrid grid;
    grid.to_unit = to_unit;
    std::copy(cells.begin(), cells.end(), grid.cells);
    scene.grids.push_back(grid);
    for (std::uint32_t i = 0; i < cells[0] * cells[1] * cells[2]; ++i) {
      scene.majorants.push_back(static_cast<float>(std::max(random.uniform(-1, 3), 0.0)));
    }
  }
  const VolumeGrid& grid() const { return scene.grids[0]; }

  MajorantWalk walk(const Ray& ray, float t, float t_max, float depth) const {
    return walk_majorants(grids_of(scene), grid(), ray, t, t_max, depth);
  }
};

/// The majorants along a ray as a list of pieces. `ends`: there are none beyond the cube.
class MajorantsAlong {
 public:
  MajorantsAlong(const MajorantCase& majorants, const Ray& ray, bool ends = false)
      : case_(majorants), ends_(ends) {
    const VolumeGrid& grid = majorants.grid();
    const auto mapped = [&](const Vec3& v, double w) {
      glm::dvec3 result;
      for (int i = 0; i < 3; ++i) {
        const Vec4& row = grid.to_unit.row[i];
        result[i] = glm::dot(glm::dvec3(Vec3(row)), glm::dvec3(v)) + w * double{row.w};
      }
      return result;
    };
    origin_ = mapped(ray.origin, 1), direction_ = mapped(ray.direction, 0);
    for (int axis = 0; axis < 3; ++axis) {
      for (std::uint32_t wall = 0; wall <= grid.cells[axis]; ++wall) {
        const double at = double(wall) / grid.cells[axis];
        if (direction_[axis] != 0) walls_.push_back((at - origin_[axis]) / direction_[axis]);
      }
    }
    std::sort(walls_.begin(), walls_.end());
  }

  double at(double t) const {
    const glm::dvec3 p = origin_ + t * direction_;
    for (int axis = 0; axis < 3; ++axis) {
      if (ends_ && (p[axis] < 0 || p[axis] > 1)) return 0;
    }
    return majorant_of(case_.scene, case_.grid(), cell_at(case_.grid(), origin_ + t * direction_));
  }

  /// The integral between two distances.
  double depth(double from, double to) const {
    double sum = 0;
    const auto add_to = [&](double end) {
      if (end <= from) return;
      sum += (end - from) * at(0.5 * from + 0.5 * end);
      from = end;
    };
    for (const double wall : walls_) {
      if (wall < to) add_to(wall);
    }
    add_to(to);
    return sum;
  }

  /// Whether a wall is near.
  bool is_at_a_wall(double t) const {
    for (const double wall : walls_) {
      if (std::abs(wall - t) < 1e-4 * (1 + std::abs(t))) return true;
    }
    return false;
  }

 private:
  const MajorantCase& case_;
  bool ends_;
  glm::dvec3 origin_, direction_;
  std::vector<double> walls_;
};

void expect_right_walk(const MajorantCase& majorants, const Ray& ray, float t, float t_max,
                       float wanted) {
  const bool ends = majorants.grid().ends != 0 || t_max >= infinite_distance;
  const MajorantsAlong along(majorants, ray, ends);
  const MajorantWalk walk = majorants.walk(ray, t, t_max, wanted);
  SCOPED_TRACE(fmt::format("from ({}, {}, {}) along ({}, {}, {}), t {} to {}, depth {}",
                           ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x,
                           ray.direction.y, ray.direction.z, t, t_max, wanted));
  ASSERT_GE(walk.t, t);
  ASSERT_LE(walk.t, t_max);
  const double depth = along.depth(double{t}, double{walk.t});
  const double error = 2e-5 * (1 + std::min(double{walk.t}, 100.0) + depth);
  if (walk.arrives) {
    EXPECT_EQ(walk.t, t_max);
    if (depth < 1e30) {
      EXPECT_NEAR(walk.depth, depth, error);
      EXPECT_LE(depth, wanted + error);
    }
  } else {
    EXPECT_EQ(walk.depth, wanted);
    EXPECT_NEAR(depth, wanted, error);
  }
  if (!(ends && walk.arrives) && walk.t < 1e30f && !along.is_at_a_wall(double{walk.t})) {
    EXPECT_EQ(double{walk.majorant}, along.at(double{walk.t}));
  }
}

constexpr GridSize walked_sizes[] = {{1, 1, 1}, {1, 4, 2}, {5, 3, 7}, {2, 64, 1}};

TEST(MajorantWalks, FindTheDepthsOfRandomRays) {
  TestRandom random(42);
  for (const GridSize& cells : walked_sizes) {
    for (int i = 0; i < 400; ++i) {
      const Affine to_world = random_place(random);
      MajorantCase majorants(random, cells, inverse(to_world));
      majorants.scene.grids[0].ends = i % 5 == 0 ? 1 : 0;
      // Twice as wide as the cube: most rays begin outside, and many miss it.
      const Vec3 origin = to_world.point(Vec3(random.point(1) + 0.5));
      const Ray ray{origin, normalize(Vec3(random.direction()))};
      const auto t = static_cast<float>(i % 2 == 0 ? 0.0 : random.uniform(0, 3));
      const float t_max =
          i % 3 == 0 ? infinite_distance : t + static_cast<float>(random.log_uniform(1e-3, 10));
      const auto wanted = static_cast<float>(random.log_uniform(1e-3, 30));
      expect_right_walk(majorants, ray, t, t_max, i % 7 == 0 ? HUGE_VALF : wanted);
      if (HasFailure()) return;
    }
  }
}

// With exact numbers: along axes, through edges and corners, along walls, away from the grid.
TEST(MajorantWalks, GoThroughEdgesAndAlongAxes) {
  TestRandom random(43);
  const float root = 0.70710678f;
  for (int i = 0; i < 200; ++i) {
    const MajorantCase majorants(random, {4, 4, 4}, scale(Vec3(0.25f)));
    for (const float x : {-1.0f, 0.0f, 0.5f, 1.0f, 2.0f, 4.0f, 6.0f}) {
      for (const Vec3& direction :
           {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 1), Vec3(0, -1, 0), Vec3(root, root, 0),
            Vec3(-root, 0, root), Vec3(0.57735027f), Vec3(-0.57735027f), Vec3(0.6f, -0.8f, 0)}) {
        const auto wanted = static_cast<float>(random.log_uniform(0.01, 20));
        const Ray ray{{x, i % 2 == 0 ? x : 1.5f, 2.25f}, direction};
        for (const float t_max : {0.75f, 3.0f, infinite_distance}) {
          expect_right_walk(majorants, ray, 0, t_max, wanted);
          if (HasFailure()) return;
        }
      }
    }
  }
}

// A flight may pause: walks one after another get as far as one.
TEST(MajorantWalks, GoOnFromWhereTheyPaused) {
  TestRandom random(44);
  for (int i = 0; i < 2000; ++i) {
    const Affine to_world = random_place(random);
    const MajorantCase majorants(random, {5, 3, 7}, inverse(to_world));
    const Ray ray = random_ray(random, to_world);
    const float t_max = i % 2 == 0 ? 5.0f : infinite_distance;
    const auto first = static_cast<float>(random.uniform(0, 2)),
               second = static_cast<float>(random.uniform(0, 2));
    const MajorantWalk once = majorants.walk(ray, 0, t_max, first + second);
    MajorantWalk twice = majorants.walk(ray, 0, t_max, first);
    if (!twice.arrives) twice = majorants.walk(ray, twice.t, t_max, second);
    // Where a flight ends within rounding of t_max or of a void either may be right.
    const MajorantsAlong along(majorants, ray, t_max >= infinite_distance);
    if (once.arrives != twice.arrives || std::abs(once.t - twice.t) > 1e-4f * (1 + once.t)) {
      EXPECT_NEAR(along.depth(0, std::min(double{once.t}, 1e6)),
                  along.depth(0, std::min(double{twice.t}, 1e6)), 1e-4);
    }
  }
}

// What is known of a ray serves all of its walks.
TEST(MajorantWalks, OfOneRayMayFollowEachOther) {
  TestRandom random(46);
  for (int i = 0; i < 500; ++i) {
    const Affine to_world = random_place(random);
    const MajorantCase majorants(random, {5, 3, 7}, inverse(to_world));
    const Ray ray = random_ray(random, to_world);
    const float t_max = i % 2 == 0 ? 5.0f : infinite_distance;
    const VolumeGrids grids = grids_of(majorants.scene);
    CellWalk walk(majorants.grid(), ray, t_max);
    float t = 0;
    for (bool arrives = false; !arrives;) {
      const auto wanted = static_cast<float>(random.uniform(0, 2));
      CellWalk::State state = walk.begin(majorants.grid(), t, wanted);
      while (state == CellWalk::State::walks) state = walk.step(grids, majorants.grid());
      const MajorantWalk found = walk.result(state, t_max);
      const MajorantWalk alone = majorants.walk(ray, t, t_max, wanted);
      ASSERT_EQ(found.t, alone.t);
      ASSERT_EQ(found.depth, alone.depth);
      ASSERT_EQ(found.majorant, alone.majorant);
      ASSERT_EQ(found.arrives, alone.arrives);
      t = found.t, arrives = found.arrives;
    }
  }
}

// A jump over empty cells is worth the steps from cell to cell, to the last bit: also where walls
// meet, along axes, and far from the grid, where many walls are at the same distance.
TEST(MajorantWalks, JumpOverEmptySpaceToWhereStepsLead) {
  TestRandom random(47);
  const float root = 0.70710678f;
  const Vec3 directions[] = {Vec3(1, 0, 0),        Vec3(0, -1, 0),    Vec3(root, root, 0),
                             Vec3(-root, 0, root), Vec3(0.57735027f), Vec3(-0.57735027f),
                             Vec3(0.6f, -0.8f, 0), Vec3(0, 0, -1)};
  int differ = 0, reached = 0, shorter = 0;
  for (const GridSize& cells : {GridSize{5, 3, 7}, GridSize{2, 64, 1}, GridSize{12, 12, 12}}) {
    for (int i = 0; i < 60; ++i) {
      const bool is_exact = i % 2 == 0;
      const Affine to_world = is_exact
                                  ? scale(Vec3(float(cells[0]), float(cells[1]), float(cells[2])))
                                  : random_place(random);
      MajorantCase steps(random, cells, inverse(to_world));
      for (float& majorant : steps.scene.majorants) {
        if (random.uniform(0, 1) < 0.2 * (i % 6)) majorant = 0;
      }
      MajorantCase jumps = steps;
      jumps.scene.majorants = with_distances(steps.scene.majorants, cells);
      for (int n = 0; n < 200; ++n) {
        const float far = n % 20 == 0 ? 3e4f : 1.0f;
        Ray ray{to_world.point(far * Vec3(random.point(1) + 0.5)), Vec3(random.direction())};
        if (is_exact) {
          for (int axis = 0; axis < 3; ++axis)
            ray.origin[axis] = std::round(2 * ray.origin[axis]) / 2;
          ray.direction = directions[n % 8];
        } else if (far > 1) {
          ray.direction = to_world.point(Vec3(random.point(0.5) + 0.5)) - ray.origin;
        }
        ray.direction = normalize(ray.direction);
        const float t_max =
            n % 3 == 0 ? infinite_distance : static_cast<float>(random.uniform(0, 20));
        const auto wanted = static_cast<float>(random.log_uniform(1e-3, 30));
        const MajorantWalk a = steps.walk(ray, 0, t_max, wanted),
                           b = jumps.walk(ray, 0, t_max, wanted);
        differ +=
            a.t == b.t && a.depth == b.depth && a.majorant == b.majorant && a.arrives == b.arrives
                ? 0
                : 1;
        reached += a.arrives ? 0 : 1;
      }
      for (const float majorant : jumps.scene.majorants) shorter += majorant < -1 ? 1 : 0;
    }
  }
  EXPECT_EQ(differ, 0);
  EXPECT_GT(reached, 3000);
  EXPECT_GT(shorter, 3000);
}

// Where a cell's wall is, walks from both of its sides agree on what lies ahead.
TEST(MajorantWalks, BeginAtWalls) {
  TestRandom random(45);
  const MajorantCase majorants(random, {4, 4, 4}, scale(Vec3(0.25f)));
  for (const float side : {-1.0f, 1.0f}) {
    const Ray ray{{2 - 3 * side, 1.5f, 2.5f}, {side, 0, 0}};
    const MajorantsAlong along(majorants, ray);
    for (const float wall : {1.0f, 2.0f, 3.0f, 4.0f, 5.0f}) {
      for (const float t :
           {std::nextafter(wall, 0.0f), wall, std::nextafter(wall, infinite_distance)}) {
        const MajorantWalk walk = majorants.walk(ray, t, wall + 0.5f, HUGE_VALF);
        EXPECT_TRUE(walk.arrives);
        EXPECT_NEAR(walk.depth, along.depth(double{wall}, double{wall} + 0.5), 1e-5);
      }
    }
  }
}

}  // namespace
}  // namespace pt
