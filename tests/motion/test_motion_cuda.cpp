// Scenes that move give the same bits in all modes on a GPU, too, and nearly the CPU's image.
#include <gtest/gtest.h>

#include "common/image/compare/compare.h"
#include "common/scene/builtin/generated_scenes.h"
#include "common/scene/load/files/volumes/volume_files.h"
#include "cuda_test.h"
#include "medium/moving_fog.h"
#include "mode_cases.h"
#include "scene/moving_room.h"

namespace pt {
namespace {

class CudaMotion : public CudaTest {};

Options moving_options(const std::string& mode, const Settings& more = {}) {
  Options options = motion_options(61, 40, 5, 5);
  apply(options, {{"device", "cuda:0"}, {"mode", mode}});
  return with(options, more);
}

Rendered render_moving(SceneData scene, const Options& options) {
  const DeviceInfo device = choose_device(options.device);
  prepare_scene_for(scene, options, device);
  EXPECT_TRUE(scene.traits.has_motion);
  return take_image(*make_renderer(options, scene, device));
}

/// The room, and what moves in it alone.
std::vector<SceneData> moving_rooms() {
  std::vector<SceneData> rooms(6, moving_room());
  const auto keep = [](SceneData& scene, bool camera, int instance, bool deforming) {
    auto& moving = scene.motion.instances;
    if (!camera) scene.motion.camera.clear();
    std::erase_if(moving, [&](const auto& m) { return static_cast<int>(m.instance) != instance; });
    if (!deforming) scene.meshes[3].stop_deforming();
  };
  rooms[1].name = "a camera that moves", keep(rooms[1], true, -1, false);
  rooms[2].name = "an instance that turns", keep(rooms[2], false, 0, false);
  rooms[3].name = "a lamp that moves", keep(rooms[3], false, 1, false);
  rooms[4].name = "a mesh that deforms", keep(rooms[4], false, -1, true);
  rooms[5].name = "a mesh that deforms, without instances", keep(rooms[5], false, -1, true);
  rooms[5].instances.clear();
  for (Mesh& mesh : rooms[5].meshes) mesh.group = 0;
  rooms.push_back(moving_fog_room());
  SceneData& masked = rooms.emplace_back(moving_room());
  masked.name = "masks without media";
  masked.materials[masked.meshes[1].material].opacity = constant_opacity(0.6f);
  rooms.push_back(moving_spheres());
  rooms.push_back(glowing_room());
  SceneData& lamps = rooms.emplace_back(passing_lamps());  // in a light tree
  lamps.sky.nadir = lamps.sky.zenith = Color(0.1f);
  return rooms;
}

TEST_F(CudaMotion, AllModesAreEqual) {
  for (const SceneData& scene : moving_rooms()) {
    SCOPED_TRACE(scene.name);
    for (const char* sampler : {"independent", "stratified", "sobol"}) {
      const Settings by{{"sampler", sampler}};
      const Rendered expected = render_moving(scene, moving_options("megakernel", by));
      expect_plausible(expected, moving_options("megakernel", by));
      for (const Settings& more :
           {Settings{}, Settings{{"schedule", "host"}}, Settings{{"finish-paths", "0"}},
            Settings{{"stages", "fused"}, {"finish-paths", "0"}}}) {
        const Options options = with(moving_options("wavefront", by), more);
        SCOPED_TRACE(command_of(options));
        expect_same(render_moving(scene, options), expected);
      }
    }
  }
}

// Threads that walk a binary tree, and what knows wide trees: warps that persist, block-local
// wavefronts, and threads of fused stages.
TEST_F(CudaMotion, WideTreesGiveTheSame) {
  for (std::size_t room : {1u, 2u, 3u}) {
    const SceneData scene = moving_rooms()[room];
    SCOPED_TRACE(scene.name);
    for (const char* sampler : {"independent", "stratified"}) {
      const Settings by{{"sampler", sampler}};
      const auto render = [&](const char* mode, const Settings& kernel, const Settings& more = {}) {
        const Options options = with(with(moving_options(mode, by), kernel), more);
        SCOPED_TRACE(command_of(options));
        return render_moving(scene, options);
      };
      const Rendered expected = render("megakernel", {{"kernel", "loop"}, {"accel", "bvh2"}});
      const Settings wide{{"accel", "cwbvh"}, {"persistent", "on"}};
      expect_same(render("megakernel", {{"kernel", "sort"}}), expected);
      for (const char* finish : {"0", "300", "131072"})
        for (const char* schedule : {"graph", "host"})
          expect_same(render("wavefront", wide, {{"finish-paths", finish}, {"schedule", schedule}}),
                      expected);
      expect_same(render("wavefront", wide, {{"pool-size", "300"}}), expected);
      expect_same(render("wavefront", wide, {{"stages", "fused"}}), expected);
      expect_same(render("wavefront", {{"persistent", "off"}}), expected);
    }
  }
}

// The same scene at rest, whose kernels are others: a camera that goes nowhere.
TEST_F(CudaMotion, OfACameraThatGoesNowhereIsTheImageAtRest) {
  SceneData still = moving_rooms()[1];
  still.motion.camera.clear();
  SceneData moving = moving_rooms()[1];
  moving.motion.camera[1].to_world = moving.motion.camera[0].to_world;
  for (const char* mode : {"megakernel", "wavefront"}) {
    const Options options = moving_options(mode);
    SceneData scene = still;
    const DeviceInfo device = choose_device(options.device);
    prepare_scene_for(scene, options, device);
    EXPECT_FALSE(scene.traits.has_motion);
    const Rendered expected = take_image(*make_renderer(options, scene, device));
    const ImageDifference difference =
        compare_images(render_moving(moving, options).image, expected.image, 1e-3);
    EXPECT_LE(static_cast<double>(difference.pixels_past_tolerance), 0.02 * 61 * 40) << mode;
  }
}

TEST_F(CudaMotion, KnowsSparseGrids) {
  if (!reads_nanovdb()) GTEST_SKIP() << "built without NanoVDB";
  const auto cloud = [](VolumeStorage storage) {
    SceneData scene = make_cloud_scene({64, 10, 0.9f, true}, storage);
    scene.motion.camera = {{0.0f, {}}, {1.0f, translate({0.3f, 0, 0})}};
    return scene;
  };
  for (const char* mode : {"megakernel", "wavefront"}) {
    const Options options = moving_options(mode);
    const Rendered sparse = render_moving(cloud(VolumeStorage::sparse), options);
    expect_plausible(sparse, options);
    expect_same(render_moving(cloud(VolumeStorage::dense), options), sparse);
    const Rendered cpu =
        render_moving(cloud(VolumeStorage::sparse), with(options, {{"device", "cpu"}}));
    const ImageDifference difference = compare_images(sparse.image, cpu.image, 1e-3);
    EXPECT_LE(static_cast<double>(difference.pixels_past_tolerance), 0.05 * 61 * 40) << mode;
  }
}

TEST_F(CudaMotion, MegakernelDoesNotDependOnHow) {
  const SceneData scene = moving_room();
  const Rendered expected = render_moving(scene, moving_options("megakernel"));
  for (const Settings& more : {Settings{{"work", "pixel"}}, Settings{{"work", "sample"}},
                               Settings{{"block", "33x1"}}, Settings{{"builder", "sah"}}}) {
    const Options options = moving_options("megakernel", more);
    SCOPED_TRACE(command_of(options));
    expect_same(render_moving(scene, options), expected);
  }
}

// What a camera alone moves past may be in a tree that the GPU builds.
TEST_F(CudaMotion, OfTheCameraDoesNotDependOnWhoBuildsTheTree) {
  const SceneData scene = moving_rooms()[1];
  for (const char* mode : {"megakernel", "wavefront"}) {
    const auto render = [&](const char* builder) {
      return render_moving(scene, moving_options(mode, {{"builder", builder}}));
    };
    expect_same(render("hploc"), render("sah"));
  }
}

TEST_F(CudaMotion, WavefrontDoesNotDependOnHow) {
  const SceneData scene = moving_room();
  const Rendered expected = render_moving(scene, moving_options("megakernel"));
  const std::vector<Choice> choices{{"compaction", names_of(Compaction::atomic)},
                                    {"pool-size", {"auto", "300", "11"}},
                                    {"regenerate", {"on", "off"}},
                                    {"finish-paths", {"0", "1", "700", "131072"}},
                                    {"layout", names_of(PoolLayout::soa)},
                                    {"stages", names_of(Stages::split, {Stages::automatic})},
                                    {"schedule", names_of(Schedule::host)},
                                    {"order-surfaces", {"auto", "on", "off"}}};
  int compared = 0;
  for (const Settings& settings : variations(choices, 24, 8)) {
    const Options options = moving_options("wavefront", settings);
    if (!has_plan(options, scene)) continue;
    SCOPED_TRACE(command_of(options));
    expect_same(render_moving(scene, options), expected);
    if (HasFailure()) return;
    ++compared;
  }
  EXPECT_GT(compared, 15);
}

// CPU and GPU round differently, and a path that takes another way differs in all that follows.
TEST_F(CudaMotion, IsAsOnTheCpu) {
  for (const SceneData& scene : moving_rooms()) {
    SCOPED_TRACE(scene.name);
    const Settings more{{"width", "120"}, {"height", "80"}, {"spp", "16"}};
    const Options options = moving_options("megakernel", more);
    const Rendered gpu = render_moving(scene, options);
    const Rendered cpu = render_moving(scene, with(options, {{"device", "cpu"}}));
    const ImageDifference difference = compare_images(gpu.image, cpu.image, 1e-3);
    EXPECT_LE(static_cast<double>(difference.pixels_past_tolerance), 0.02 * 120 * 80);
    EXPECT_EQ(gpu.counts.paths, cpu.counts.paths);
    EXPECT_NEAR(static_cast<double>(gpu.counts.rays), static_cast<double>(cpu.counts.rays),
                2e-3 * static_cast<double>(cpu.counts.rays));
  }
}

TEST_F(CudaMotion, FirstHitsAreThoseOfTheCpu) {
  const Settings more{{"aov", "depth,normal"}, {"output", "a.exr"}};
  const Options options = moving_options("megakernel", more);
  const Image gpu = render_moving(moving_room(), options).image;
  const Image cpu = render_moving(moving_room(), with(options, {{"device", "cpu"}})).image;
  ASSERT_EQ(gpu.layers.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const std::vector<float>&a = gpu.layers[i].values, &b = cpu.layers.at(i).values;
    ASSERT_EQ(a.size(), b.size());
    std::size_t far = 0;
    for (std::size_t k = 0; k < a.size(); ++k)
      far += a[k] != b[k] && !(std::abs(a[k] - b[k]) <= 1e-3f * (1 + std::abs(b[k])));
    EXPECT_LE(far, a.size() / 100) << i;
  }
}

TEST_F(CudaMotion, ItsArraysAreCounted) {
  const DeviceInfo device = choose_device({DeviceChoice::Kind::cuda, 0});
  SceneData scene = moving_room();
  scene.add_sphere({0, 2, 0}, 0.1f, 0);
  scene.motion.spheres = {{0, {{0.0f, {}}, {1.0f, translate({1, 0, 0})}}}};
  const Options options = moving_options("wavefront");
  prepare_scene_for(scene, options, device);
  const PreparedMotion& motion = *scene.motion.prepared;
  Motion view;
  std::uint64_t expected = sizeof view;
  motion.for_each_array(view, [&](auto*& pointer, const auto& values) {
    EXPECT_FALSE(values.empty());
    expected += values.size() * sizeof *pointer;
  });
  std::uint64_t found = 0;
  for (const BufferSize& buffer : report_of(*make_renderer(options, scene, device)).memory)
    if (buffer.name == "motion") found += buffer.size_bytes;
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace pt
