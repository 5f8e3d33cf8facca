// OptiX as a tracer of the wavefront's queues, and the megakernel in its ray generation program:
// where our test judges its candidates, images are those of our own tracer, bit for bit. Skipped
// where the driver has no OptiX.
#include <fmt/format.h>

#include <iostream>

#include "accel/hard_hits.h"
#include "accel/instance_crowds.h"
#include "accel/instanced_meshes.h"
#include "common/accel/trace_optix/optix_memory_cuda.h"
#include "common/accel/trace_optix/optix_pipeline.h"
#include "common/accel/trace_optix/optix_rays.h"
#include "common/accel/trace_optix/optix_structure.h"
#include "common/rays/trace_rays.h"
#include "common/scene/builtin/generated_scenes.h"
#include "common/scene/prepare/prepare_scene.h"
#include "cuda_test.h"
#include "medium/filled_glasses.h"
#include "mode_cases.h"
#include "scene/lit_room.h"
#include "scene/masked_room.h"
#include "scene/material_room.h"
#include "scene/mixed_scene.h"

namespace pt {
namespace {

class CudaOptix : public CudaTest {
 protected:
  void SetUp() override {
    CudaTest::SetUp();
    if (IsSkipped()) return;
    if (optix_ray_code().empty()) GTEST_SKIP() << "built without OptiX's programs";
    try {
      OptixLibrary library;
    } catch (const Error& error) {
      GTEST_SKIP() << error.what();
    }
  }
};

constexpr const char* judged[] = {"custom", "any-hit"};

/// Counts where OptiX decides, expects none where we do.
void expect_images(const std::string& name, const std::string& hits, const Rendered& found,
                   const Rendered& expected) {
  const std::size_t pixels = differing_pixels(found.image, expected.image);
  std::cout << "[ count    ] " << name << " " << hits << ": " << pixels << " of "
            << expected.image.width * expected.image.height << " pixels differ\n";
  if (hits == "custom") return expect_same(found, expected);
  // OptiX may leave out triangles that our test meets: edges, and those without area.
  EXPECT_LE(pixels, expected.image.rgb.size() / 3 / 20);
}

class CudaOptixModes : public CudaOptix, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, CudaOptixModes,
                         testing::Values("boxes", "spheres", "statue:3K", "statue:100K",
                                         "terrain:3K", "instances:20", "instances:3K", "cornell",
                                         "dial:16:0.5", "dial:16:0.5:closed"),
                         [](const auto& scene) {
                           std::string name = scene.param;
                           std::ranges::replace_if(
                               name, [](char c) { return c == ':' || c == '.'; }, '_');
                           return name;
                         });

TEST_P(CudaOptixModes, GiveTheImagesOfOurTracer) {
  const Options usual = cuda_options("wavefront", {{"scene", GetParam()},
                                                   {"width", "131"},
                                                   {"height", "97"},
                                                   {"spp", "4"},
                                                   {"max-depth", "6"},
                                                   {"kernel-set", "general"}});
  const Rendered expected = render_options(usual);
  expect_plausible(expected, usual);
  for (const char* hits : {"custom", "any-hit", "built-in"}) {
    for (const char* pool : {"auto", "4097"}) {
      SCOPED_TRACE(std::string(hits) + ", pool " + pool);
      const Options options =
          with(usual, {{"accel", "optix"}, {"optix-hits", hits}, {"pool-size", pool}});
      expect_images(GetParam(), hits, render_options(options), expected);
    }
  }
}

TEST_P(CudaOptixModes, GiveTheImagesOfOurMegakernel) {
  const Options usual = cuda_options("megakernel", {{"scene", GetParam()},
                                                    {"width", "131"},
                                                    {"height", "97"},
                                                    {"spp", "4"},
                                                    {"max-depth", "6"},
                                                    {"kernel-set", "general"}});
  const Rendered expected = render_options(usual);
  expect_plausible(expected, usual);
  for (const char* hits : {"custom", "any-hit", "built-in"}) {
    for (const char* reorder : {"off", "on"}) {
      for (const char* work : {"persistent", "pixel", "sample"}) {
        SCOPED_TRACE(fmt::format("{}, reorder {}, work {}", hits, reorder, work));
        const Options options =
            with(usual,
                 {{"accel", "optix"}, {"optix-hits", hits}, {"reorder", reorder}, {"work", work}});
        expect_images(GetParam(), hits, render_options(options), expected);
      }
    }
  }
}

Rendered render_room(SceneData scene, const Settings& settings, const char* mode = "wavefront") {
  Options options =
      cuda_options(mode, {{"width", "91"}, {"height", "83"}, {"spp", "4"}, {"max-depth", "6"}});
  if (options.mode == Mode::wavefront) apply(options, {{"pool-size", "3001"}});
  apply(options, settings);
  prepare_scene(scene, options);
  return take_image(*make_renderer(options, scene, choose_device(options.device)));
}

TEST_F(CudaOptix, GivesTheRoomsOfOurTracer) {
  const std::pair<const char*, SceneData> rooms[] = {{"mixed", mixed_scene()},
                                                     {"lights", lit_room()},
                                                     {"masks", masked_room()},
                                                     {"limited", limited_room()},
                                                     {"forest", masked_forest()},
                                                     {"media", filled_glasses(false)},
                                                     {"media and masks", filled_glasses(true)}};
  for (const auto& [name, scene] : rooms) {
    const Rendered expected = render_room(scene, {});
    for (const char* hits : judged) {
      SCOPED_TRACE(std::string(name) + ", " + hits);
      expect_images(name, hits, render_room(scene, {{"accel", "optix"}, {"optix-hits", hits}}),
                    expected);
    }
  }
}

TEST_F(CudaOptix, GivesTheRoomsOfOurMegakernel) {
  const std::pair<const char*, SceneData> rooms[] = {
      {"mixed", mixed_scene()}, {"lights", lit_room()},      {"materials", material_room(false)},
      {"masks", masked_room()}, {"limited", limited_room()}, {"forest", masked_forest()}};
  for (const auto& [name, scene] : rooms) {
    const Rendered expected = render_room(scene, {}, "megakernel");
    for (const char* hits : judged) {
      for (const char* reorder : {"off", "on"}) {
        SCOPED_TRACE(fmt::format("{}, {}, reorder {}", name, hits, reorder));
        const Settings settings{{"accel", "optix"}, {"optix-hits", hits}, {"reorder", reorder}};
        Rendered found = render_room(scene, settings, "megakernel");
        // Among the materials OptiX's program sends one shadow ray less, which no pixel shows.
        std::uint64_t& shadow_rays = found.counts.shadow_rays;
        if (std::string(name) == "materials" && shadow_rays + 1 == expected.counts.shadow_rays)
          ++shadow_rays;
        expect_images(name, hits, found, expected);
      }
    }
  }
}

TEST_F(CudaOptix, TreesBuiltOnTheGpuServeIt) {
  Settings settings{{"scene", "terrain:3K"}, {"width", "67"},     {"height", "41"}, {"spp", "4"},
                    {"accel", "cwbvh"},      {"builder", "hploc"}};
  const Rendered expected = render_options(cuda_options("wavefront", settings));
  settings[4].second = "optix";
  expect_same(render_options(cuda_options("wavefront", settings)), expected);
}

TEST_F(CudaOptix, SaysWhatItHasBuilt) {
  const RenderReport report = report_of(cuda_options("wavefront", {{"scene", "statue:3K"},
                                                                   {"width", "32"},
                                                                   {"height", "32"},
                                                                   {"spp", "1"},
                                                                   {"accel", "optix"}}));
  EXPECT_EQ(report.accel, "optix");
  EXPECT_EQ(report.schedule, "host");
  ASSERT_TRUE(report.optix.has_value());
  EXPECT_GT(report.optix->bytes_compacted, 1000u);
  EXPECT_LE(report.optix->bytes_compacted, report.optix->bytes_built);
  std::cout << "[ count    ] RT cores " << report.optix->rtcore_version << ", "
            << report.optix->bytes_built << " bytes, compacted " << report.optix->bytes_compacted
            << ", " << report.optix->build_ms << " ms\n";
}

TEST_F(CudaOptix, SaysWhetherItHasReordered) {
  const auto report = [](const char* reorder) {
    return report_of(cuda_options("megakernel", {{"scene", "statue:3K"},
                                                 {"width", "32"},
                                                 {"height", "32"},
                                                 {"spp", "1"},
                                                 {"accel", "optix"},
                                                 {"reorder", reorder}}));
  };
  const RenderReport asked = report("on");
  EXPECT_EQ(asked.accel, "optix");
  ASSERT_TRUE(asked.optix.has_value());
  EXPECT_EQ(asked.optix->reorders, choose_device({}).properties.can_reorder);
  EXPECT_FALSE(report("off").optix->reorders);
}

/// Rays traced by OptiX.
std::vector<HitRecord> trace_by_optix(const TriangleTreeData& data, const RaySet& set,
                                      OptixHits hits) {
  CudaOptixMemory memory(nullptr);
  const OptixContext context(std::make_shared<const OptixLibrary>());
  std::vector<std::shared_ptr<void>> arrays;
  const auto upload = [&]<class T>(const std::vector<T>& values) -> T* {
    if (values.empty()) return nullptr;
    const auto array = std::make_shared<DeviceArray<T>>(values);
    arrays.push_back(array);
    return array->data();
  };
  const TriangleTree tree =
      data.view([&](auto*& pointer, const auto& values, const char*) { pointer = upload(values); });
  const OptixStructure structure(context, memory, tree, hits);
  OptixPipeline pipeline(context, memory, {optix_ray_code(), sizeof(OptixRayParams)}, hits,
                         structure.content());
  OptixRayParams params;
  params.scene = optix_scene(tree, structure);
  params.rays.rays = upload(set.rays);
  const DeviceArray<HitRecord> results(set.rays.size());
  params.rays.hits = results.data();
  params.rays.count = static_cast<std::uint32_t>(set.rays.size());
  pipeline.launch(set.type == RayType::any ? OptixPipeline::any : OptixPipeline::closest, &params,
                  std::min(params.rays.count, optix_width_max));
  memory.synchronize();
  return results.download();
}

class CudaOptixRays : public CudaOptix {
 protected:
  static void expect_rays(const std::string& name, const TriangleTreeData& tree,
                          const RaySet& rays) {
    const std::vector<HitRecord> expected = trace_rays_cuda(tree, rays, {}, 0).hits;
    for (const auto& [hits, text] :
         {std::pair(OptixHits::custom, "custom"), std::pair(OptixHits::any_hit, "any-hit"),
          std::pair(OptixHits::built_in, "built-in")}) {
      const std::vector<HitRecord> found = trace_by_optix(tree, rays, hits);
      int differ = 0;
      std::string shown;
      for (std::size_t i = 0; i < found.size(); ++i) {
        if (std::memcmp(&found[i], &expected[i], sizeof(HitRecord)) == 0) continue;
        if (++differ > 3) continue;
        const RayRecord& ray = rays.rays[i];
        shown += fmt::format(
            "\n  ray {}: origin {} {} {}, direction {} {} {}, to {}: {} at {}, "
            "expected {} at {}",
            i, ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y,
            ray.direction.z, ray.t_max, found[i].primitive, found[i].t, expected[i].primitive,
            expected[i].t);
      }
      std::cout << "[ count    ] " << name << " " << text << ": " << differ << " of "
                << rays.rays.size() << " rays differ\n";
      if (hits == OptixHits::custom) {
        EXPECT_EQ(differ, 0) << shown;
      }
      // OptiX may leave out triangles that our test meets: those without area, and edges from afar.
      if (hits == OptixHits::any_hit && differ > 0) std::cout << shown << "\n";
    }
  }

  static TriangleTreeData build(const std::vector<Mesh>& meshes,
                                const std::vector<Instance>& instances = {}) {
    TreeOptions options;
    options.accel = AccelKind::cwbvh;
    return build_triangle_tree(meshes, instances, options);
  }
};

TEST_F(CudaOptixRays, AreEqualWhereHitsAreHard) {
  for (const MeshKind& kind : hard_mesh_kinds) {
    const Mesh mesh = kind.make(3000);
    for (const RayType type : {RayType::closest, RayType::any})
      expect_rays(kind.name + std::string(type == RayType::any ? " any" : ""), build({mesh}),
                  hard_rays(mesh, 20000, type));
  }
}

TEST_F(CudaOptixRays, AreEqualAmongInstances) {
  const InstancedMeshes world = make_instanced_meshes(40);
  for (const RayType type : {RayType::closest, RayType::any})
    expect_rays(type == RayType::any ? "instances any" : "instances",
                build(world.meshes, world.instances), rays_through(200000, type));
}

TEST_F(CudaOptixRays, AreEqualOnATerrain) {
  const Mesh mesh = generate_terrain(200000);
  for (const RayType type : {RayType::closest, RayType::any})
    expect_rays(type == RayType::any ? "terrain any" : "terrain", build({mesh}),
                hard_rays(mesh, 60000, type));
}

}  // namespace
}  // namespace pt
