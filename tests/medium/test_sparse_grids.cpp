// Sparse grids have the bits of dense ones: their values, their majorants, and images.
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "common/error/error.h"
#include "common/medium/free_flight.h"
#include "common/scene/builtin/generated_scenes.h"
#include "common/scene/builtin/scene_name.h"
#include "common/scene/prepare/prepare_steps.h"
#include "sparse_fogs.h"

namespace pt {
namespace {

class SparseGrids : public NanovdbTest {};

TEST_F(SparseGrids, HaveTheValuesOfDenseOnes) {
  const SceneData dense = sparse_fogs(VolumeStorage::dense),
                  sparse = sparse_fogs(VolumeStorage::sparse);
  EXPECT_TRUE(dense.grid_nodes.empty());
  ASSERT_EQ(dense.grids.size(), sparse.grids.size());
  TestRandom random(5);
  for (std::size_t i = 0; i < dense.grids.size(); ++i) {
    EXPECT_NE(sparse.grids[i].root, 0u);
    const Affine to_world = inverse(dense.grids[i].to_unit);
    int different = 0, empty = 0;
    for (int n = 0; n < 20'000; ++n) {
      const Vec3 point = to_world.point(Vec3(random.point(0.7) + 0.5));
      const Color value = sample_grid(grids_of(dense), dense.grids[i], point);
      different += value != sample_grid(grids_of(sparse), sparse.grids[i], point) ? 1 : 0;
      empty += is_black(value) ? 1 : 0;
    }
    EXPECT_EQ(different, 0) << i;
    EXPECT_TRUE(empty > 1000 || dense.grids[i].channels == 3);
    EXPECT_LT(empty, 19'000);
  }
}

TEST_F(SparseGrids, HaveTheMajorantsOfDenseOnes) {
  const auto expect_same_majorants = [](SceneData dense, SceneData sparse) {
    for (SceneData* scene : {&dense, &sparse}) prepare_media(*scene);
    for (float& majorant : sparse.majorants) majorant = std::max(majorant, 0.0f);
    for (std::size_t i = 0; i < dense.grids.size(); ++i) {
      const auto of_grid = [i](const SceneData& scene) {
        const VolumeGrid& grid = scene.grids[i];  // which may share them
        const auto first = scene.majorants.begin() + grid.first_cell;
        return std::vector(first, first + grid.cells[0] * grid.cells[1] * grid.cells[2]);
      };
      EXPECT_EQ(of_grid(sparse), of_grid(dense));
      EXPECT_EQ(sparse.grids[i].ends, dense.grids[i].ends);
    }
  };
  expect_same_majorants(sparse_fogs(VolumeStorage::dense), sparse_fogs(VolumeStorage::sparse));
  const CloudSettings cloud{96, 20, 0.9f, true};  // much of it empty
  expect_same_majorants(make_cloud_scene(cloud, VolumeStorage::dense),
                        make_cloud_scene(cloud, VolumeStorage::sparse));
}

// A cloud in several places is one in memory; another file, or another filter, is not.
TEST_F(SparseGrids, OfEqualVoxelsShareThem) {
  for (const VolumeStorage storage : {VolumeStorage::dense, VolumeStorage::sparse}) {
    SceneData scene;
    const auto add = [&](const std::string& file, const Vec3& place, bool interpolates) {
      VolumeData density = read_nanovdb(nanovdb_path(file), {}, storage);
      density.to_world = fog_to(place) * density.to_world;
      density.interpolates = interpolates;
      Medium medium = make_medium({9, 5, 14}, Color(0.5f));
      medium.density_grid = add_grid(scene, std::move(density));
      scene.media.push_back(medium);
      const auto inside = static_cast<std::uint32_t>(scene.media.size() - 1);
      add_cuboid(scene, place - 0.55f, place + 0.55f,
                 scene.add_material(make_boundary(no_medium, inside)));
      prepare_media(scene);
      return std::array{scene.grid_values.size(), scene.grid_nodes.size(), scene.majorants.size()};
    };
    add("balls_fp8.nvdb", {0, 3, 0}, true);
    const auto one = add("balls.nvdb", {}, true);
    EXPECT_EQ(add("balls.nvdb", {5, 0, 0}, true), one);
    EXPECT_NE(add("balls.nvdb", {9, 0, 0}, false), one);
    EXPECT_NE(add("balls_fp4.nvdb", {9, 3, 0}, true), one);
    EXPECT_EQ(scene.grids[1].first_cell, scene.grids[2].first_cell);
    TestRandom random(8);
    int full = 0;
    for (int n = 0; n < 2'000; ++n) {
      const Vec3 point(random.point(0.5));
      const Color value = sample_grid(grids_of(scene), scene.grids[1], point);
      const Color moved = sample_grid(grids_of(scene), scene.grids[2], point + Vec3(5, 0, 0));
      ASSERT_NEAR(value.x, moved.x, 1e-4f);
      full += is_black(value) ? 0 : 1;
    }
    EXPECT_GT(full, 100);
  }
}

TEST_F(SparseGrids, GiveTheSameFlights) {
  SceneData dense = sparse_fogs(VolumeStorage::dense), sparse = sparse_fogs(VolumeStorage::sparse);
  for (SceneData* scene : {&dense, &sparse}) prepare_media(*scene);
  TestRandom random(6);
  int collisions = 0, black = 0;
  for (std::uint32_t n = 0; n < 6000; ++n) {
    const std::size_t i = n % dense.media.size();
    const Affine to_world = inverse(dense.grids[dense.media[i].density_grid].to_unit);
    const Ray ray = random_ray(random, to_world);
    const float t_max = static_cast<float>(random.uniform(0.1, 3));
    const auto transmittance_in = [&](const SceneData& scene) {
      return estimate_transmittance(grids_of(scene), scene.media[i], ray, t_max, n);
    };
    const Color expected = transmittance_in(dense);
    ASSERT_EQ(transmittance_in(sparse), expected) << n;
    black += is_black(expected) ? 1 : 0;
    FreeFlight of_dense, of_sparse;
    ChannelDensities densities, others;
    Color beta(1.0f), other(1.0f);
    FlightEvent event, same;
    do {
      event = fly_to_collision(grids_of(dense), dense.media[i], ray, t_max, n, of_dense, densities,
                               beta);
      same = fly_to_collision(grids_of(sparse), sparse.media[i], ray, t_max, n, of_sparse, others,
                              other);
      ASSERT_TRUE(event == same && of_dense.t == of_sparse.t && beta == other) << n;
    } while (event == FlightEvent::collides_with_nothing);
    collisions += event == FlightEvent::collides ? 1 : 0;
    const Vec3 point = add_scaled(ray.origin, of_dense.t, ray.direction);
    ASSERT_EQ(emission_at(grids_of(sparse), sparse.media[i], point),
              emission_at(grids_of(dense), dense.media[i], point));
  }
  EXPECT_GT(collisions, 500);
  EXPECT_LT(black, 4000);
}

TEST_F(SparseGrids, GiveTheSameImagesInAllModes) {
  const SceneData dense = sparse_fogs(VolumeStorage::dense),
                  sparse = sparse_fogs(VolumeStorage::sparse);
  const Rendered expected = render_clouds(dense, cloud_options("serial"));
  expect_plausible(expected, cloud_options("serial"));
  for (const Options& options :
       {cloud_options("serial"), cloud_options("megakernel", {{"threads", "3"}}),
        cloud_options("wavefront"), cloud_options("wavefront", {{"wave-collisions", "2"}}),
        cloud_options("wavefront", {{"stages", "fused"}})}) {
    SCOPED_TRACE(command_of(options));
    expect_same(render_clouds(sparse, options), expected);
  }
}

// Here shadow rays end at the first surface, and blocks of rays are traced together.
TEST_F(SparseGrids, GiveTheSameImagesInGlass) {
  const SceneData sparse = sparse_glasses(VolumeStorage::sparse);
  const Rendered expected =
      render_clouds(sparse_glasses(VolumeStorage::dense), cloud_options("serial"));
  for (const Options& options : {cloud_options("serial"), cloud_options("wavefront"),
                                 cloud_options("wavefront", {{"accel", "bvh2"}})}) {
    SCOPED_TRACE(command_of(options));
    expect_same(render_clouds(sparse, options), expected);
  }
}

TEST_F(SparseGrids, AreCopiedAsTheUserWants) {
  const VolumeData sparse = read_nanovdb(nanovdb_path("tile.nvdb"), {}, VolumeStorage::sparse);
  const VolumeData dense = read_nanovdb(nanovdb_path("tile.nvdb"));  // for it is small
  EXPECT_FALSE(dense.is_sparse());
  EXPECT_EQ(dense_copy(sparse).values, dense.values);
  EXPECT_EQ(largest_value(sparse), largest_value(dense));
  EXPECT_TRUE(stored_as(VolumeStorage::sparse, sparse).is_sparse());
  EXPECT_FALSE(stored_as(VolumeStorage::dense, sparse).is_sparse());
  VolumeData large = sparse;  // of which little is active
  for (std::uint32_t& side : large.size) side = 512;
  EXPECT_TRUE(stored_as(VolumeStorage::automatic, large).is_sparse());
}

// Every lookup stays within the tree, and every value is one that a grid may have.
TEST_F(SparseGrids, DamagedFilesAreRefusedOrHarmless) {
  TestRandom random(9);
  int accepted = 0, refused = 0;
  for (const char* name : {"balls.nvdb", "balls_fp16.nvdb", "balls_fpn.nvdb"}) {
    UnpackedNanovdb whole(name);
    whole.without_checksum();
    for (int n = 0; n < 150; ++n) {
      UnpackedNanovdb file = whole;
      for (int changes = n % 4; changes >= 0; --changes) {
        const std::size_t begin = n % 3 == 0 ? file.root : n % 3 == 1 ? file.lower : file.leaf;
        const double length = n % 2 == 0 ? 200 : static_cast<double>(file.bytes.size() - begin);
        const auto at = begin + static_cast<std::size_t>(random.uniform(0, length));
        file.bytes.at(at) = static_cast<char>(random.uniform(-128, 128));
      }
      try {
        SceneData scene =
            scene_of_density(decode_nanovdb(file.bytes, {}, "a.nvdb", VolumeStorage::sparse));
        const Affine to_world = inverse(scene.grids[0].to_unit);
        for (int i = 0; i < 200; ++i) {
          const Vec3 point = to_world.point(Vec3(random.point(0.7) + 0.5));
          const float value = sample_grid(grids_of(scene), scene.grids[0], point).x;
          EXPECT_TRUE(value >= 0 && std::isfinite(value)) << name << " " << n << ": " << value;
        }
        ++accepted;
      } catch (const Error&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(accepted, 50);
  EXPECT_GT(refused, 20);
}

TEST_F(SparseGrids, CloudsFillLittleOfTheirCube) {
  constexpr std::uint32_t side = 256;
  const VolumeData cloud = generate_sparse_cloud(side);
  std::atomic<std::size_t> bricks = 0, active = 0;
  for_each_brick(&cloud.nodes[cloud.root], [&](const SparseBrick& brick) {
    ++bricks;
    active += static_cast<std::size_t>(512 - std::count(brick.values, brick.values + 512, 0.0f));
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GT(brick.low[axis], 0);
      EXPECT_LT(brick.low[axis] + 8, static_cast<int>(side));
    }
  });
  EXPECT_NEAR(static_cast<double>(active) / (double{side} * side * side), 0.02, 0.005);
  // Leaves of 2144 bytes, and hardly anything else.
  EXPECT_LT(static_cast<double>(cloud.nodes.size() * sizeof(SparseBlock)),
            1.3 * 2144 * static_cast<double>(bricks));
  EXPECT_EQ(largest_value(cloud), 1.0f);
  const VolumeData dense = dense_copy(cloud);
  EXPECT_TRUE(has_empty_rim(dense.size, 1, dense.values.data()));
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(dense.values, 0.0f)) + active,
            dense.values.size());
}

TEST_F(SparseGrids, CloudsFillAsMuchAsIsWanted) {
  for (const float percent : {1.0f, 10.0f, 40.0f}) {
    const VolumeData dense = dense_copy(generate_sparse_cloud(128, percent));
    const auto active = static_cast<double>(dense.values.size()) -
                        static_cast<double>(std::ranges::count(dense.values, 0.0f));
    const double share = 100 * active / static_cast<double>(dense.values.size());
    EXPECT_NEAR(share, static_cast<double>(percent), 0.4 * static_cast<double>(percent));
  }
  const CloudSettings settings = parse_cloud(parse_scene_name("cloud:256:3:0.5:sparse:12.5"));
  EXPECT_TRUE(settings.is_sparse && settings.side == 256 && settings.albedo == 0.5f);
  EXPECT_EQ(settings.percent, 12.5f);
  EXPECT_EQ(parse_cloud(parse_scene_name("cloud:256:3:0.5:sparse")).percent, 2.0f);
  EXPECT_FALSE(is_sparse_cloud("cloud:256:3:0.5"));
  for (const char* name : {"cloud:256:3:0.5:sparse:0", "cloud:256:3:0.5:sparse:51",
                           "cloud:256:3:0.5:sparse:2:1", "cloud:9999:3:0.5:sparse"}) {
    EXPECT_THROW(parse_cloud(parse_scene_name(name)), Error) << name;
  }
}

TEST_F(SparseGrids, CloudsAreTheSameAsDenseOnes) {
  const auto image = [](VolumeStorage storage, const std::string& mode) {
    const CloudSettings settings{96, 20, 0.9f, true};
    return render_clouds(make_cloud_scene(settings, storage), cloud_options(mode));
  };
  const Rendered expected = image(VolumeStorage::dense, "serial");
  expect_same(image(VolumeStorage::sparse, "serial"), expected);
  expect_same(image(VolumeStorage::automatic, "wavefront"), expected);
}

}  // namespace
}  // namespace pt
