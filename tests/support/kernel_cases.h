// Every row of the table of kernels as renders: the options that ask for its kernels, and a scene.
#pragma once

#include <map>

#include "common/plan/plan_steps.h"
#include "common/scene/builtin/generated_scenes.h"
#include "common/scene/load/files/volumes/volume_files.h"
#include "common/scene/prepare/prepare_scene.h"
#include "medium/filled_glasses.h"
#include "mode_cases.h"

namespace pt {

/// A scene with the row's traits; `light`: one of its lightings.
inline SceneData scene_of(const KernelRow& row, Lighting light) {
  const auto built_in = [](const char* name) {
    Options options;
    options.scene = name;
    return build_scene(options);
  };
  if (row.geometry == Geometry::spheres_and_quads)
    return built_in(light == Lighting::sky ? "spheres" : "cornell");
  if (row.extras == Extras::with_media) return filled_glasses();
  const auto sparse = [] { return make_cloud_scene({64, 10, 0.9f, true}, VolumeStorage::sparse); };
  if (row.extras == Extras::with_sparse) return sparse();
  if (row.extras >= Extras::with_moving_media) {
    SceneData scene =
        row.extras == Extras::with_moving_sparse && reads_nanovdb() ? sparse() : filled_glasses();
    scene.name += ", moving";
    scene.motion.camera = {{0.0f, {}}, {1.0f, translate({0.3f, 0, 0})}};
    return scene;
  }
  const bool moves = row.extras == Extras::with_motion;
  const bool repeats = moves || (row.geometry == Geometry::mixed && row.extras == Extras::plain);
  SceneData scene = built_in(repeats ? "instances:20" : "boxes");
  if (moves) {
    scene.name += ", moving";
    const Affine& begin = scene.instances[0].to_world;
    scene.motion.instances = {{0, {{0.0f, begin}, {1.0f, translate({1, 0, 0}) * begin}}}};
  }
  if (row.extras == Extras::with_masks) {
    scene.name += ", masked";
    scene.materials[0].opacity.offset = 0.5f;
  }
  return scene;
}

inline Settings settings_of(KernelBody body) {
  using enum KernelBody;
  switch (body) {
    case serial:
      return {{"mode", "serial"}};
    case loop:
      return {{"mode", "megakernel"}, {"kernel", "loop"}};
    case vote:
      return {{"mode", "megakernel"}, {"kernel", "vote"}};
    case blocks:
      return {{"mode", "megakernel"}, {"kernel", "sort"}};
    case stages:
      return {
          {"mode", "wavefront"}, {"stages", "split"}, {"persistent", "off"}, {"finish-paths", "0"}};
    case warps:
      return {{"mode", "wavefront"}, {"stages", "split"}, {"finish-paths", "0"}};
    case fused:
      return {{"mode", "wavefront"}, {"stages", "fused"}, {"finish-paths", "0"}};
    case optix:
    case queues:
      break;  // test_optix_cuda.cpp
  }
  return {};
}

/// Calls function(row, light, settings) for all combinations of the rows of a device. Vectors only
/// where the CPU has them.
template <class Function>
void for_each_kernel(bool on_cuda, Function&& function) {
  const auto each = [](auto set, int count, auto&& call) {
    for (int i = 0; i < count; ++i) {
      const typename decltype(set)::value_type value{i};
      if (set.contains(value)) call(value);
    }
  };
  for (const KernelRow& row : kernel_table) {
    if (row.on_cuda != on_cuda) continue;
    if (row.extras == Extras::with_sparse && !reads_nanovdb()) continue;
    int records = 0;
    while (records <= 16 && !row.extra.contains(ExtraRecords{records})) ++records;
    if (records > 16) continue;  // not in this build
    const std::string path_bytes = std::to_string(records * path_bytes_step);
    each(row.bodies, 7, [&](KernelBody body) {
      each(row.accels, 5, [&](Accel accel) {
        if (accel == Accel::cwbvh_avx2 && !has_avx2()) return;
        each(row.lighting, 3, [&](Lighting light) {
          each(row.sources, 3, [&](NumberSource source) {
            each(row.memories, 4, [&](SceneMemory memory) {
              each(row.branchings, 2, [&](Branching branching) {
                Settings settings = settings_of(body);
                settings.insert(settings.end(),
                                {{"device", on_cuda ? "cuda" : "cpu"},
                                 {"accel", accel_name(accel)},
                                 {"rng", source == NumberSource::xorwow ? "xorwow" : "philox"},
                                 {"scene-memory", to_string(memory)},
                                 {"branching", to_string(branching)},
                                 {"path-bytes", path_bytes},
                                 {"width", "16"},
                                 {"height", "12"},
                                 {"spp", "2"},
                                 {"max-depth", "5"}});
                function(row, light, settings);
              });
            });
          });
        });
      });
    });
  }
}

/// Renders by each kernel of the device. All kernels give the same image of a scene, but that of
/// Embree, which rounds in its own way.
inline void render_by_each_kernel(bool on_cuda) {
  std::map<std::string, Rendered> images;  // by scene and --rng
  for_each_kernel(on_cuda, [&](const KernelRow& row, Lighting light, const Settings& settings) {
    const Options options = with(Options(), settings);
    SCOPED_TRACE(command_of(options));
    SceneData scene = scene_of(row, light);
    const DeviceInfo device = choose_device(options.device);
    prepare_scene_for(scene, options, device);
    const bool on_gpu = on_cuda && options.mode != Mode::serial;
    const ExecutionPlan plan = plan_execution(
        options, scene.properties, on_gpu ? device.properties : cpu_properties(options.threads));
    const KernelNeed need = need_of(plan, options, scene.properties, on_gpu);
    // The plan's traits are the scene's, and ask for a kernel of this row, or of one beside it with
    // another structure.
    EXPECT_TRUE(need.scene.geometry == scene.traits.geometry &&
                need.scene.lighting == scene.traits.lighting &&
                need.scene.has_masks == scene.traits.has_masks &&
                need.scene.has_media == scene.traits.has_media &&
                need.scene.has_motion == scene.traits.has_motion);
    EXPECT_TRUE(need.scene.geometry != row.geometry || serves(row, need));
    const Rendered rendered = take_image(*make_renderer(options, scene, device));
    expect_plausible(rendered, options);
    if (options.accel == AccelKind::embree) return;
    const auto [expected, is_first] =
        images.try_emplace(scene.name + to_string(options.rng), rendered);
    if (!is_first) expect_same(rendered, expected->second);
  });
}

}  // namespace pt
