// OptiX's interface by a library of the tests' own: every call and every error, and the programs
// that judge candidates against our trees.
#include <gtest/gtest.h>

#include "accel/emulated_optix.h"
#include "accel/hard_hits.h"
#include "accel/instance_crowds.h"
#include "accel/instanced_meshes.h"
#include "accel/tree_kinds.h"
#include "accel/triangle_meshes.h"
#include "common/accel/build/binary/build_bvh2.h"
#include "common/accel/trace_optix/optix_rays.h"
#include "common/accel/trace_optix/optix_tracer.h"
#include "common/error/error.h"
#include "common/scene/data/scene.h"

namespace pt {
namespace {

const OptixRayParams* ray_params = nullptr;

template <OptixHits hits>
void add_ray_generation(OptixPrograms& programs, const std::string& name) {
  programs["__raygen__closest_" + name] = [] {
    trace_closest_rays<EmulatedApi, hits>(*ray_params);
  };
  programs["__raygen__any_" + name] = [] { trace_any_rays<EmulatedApi, hits>(*ray_params); };
}

OptixPrograms ray_programs() {
  OptixPrograms programs = hit_programs<EmulatedApi, ClosestSurface, AnySurface>(
      []() -> const OptixScene& { return ray_params->scene; });
  add_ray_generation<OptixHits::custom>(programs, "custom");
  add_ray_generation<OptixHits::any_hit>(programs, "any_hit");
  add_ray_generation<OptixHits::built_in>(programs, "built_in");
  return programs;
}

/// A tree, and OptiX beside it.
struct World {
  TriangleTreeData data;
  std::vector<Sphere> spheres;
  std::vector<Bvh2Node> sphere_nodes;
  Primitives primitives;
  HostOptixMemory memory;
  OptixContext context{std::make_shared<const OptixLibrary>()};
  OptixStructure structure;
  OptixPipeline pipeline;

  World(TriangleTreeData tree, OptixHits hits, const std::vector<Sphere>& more = {})
      : data(std::move(tree)),
        primitives(primitives_of(more)),
        structure(context, memory, data.view(), hits, primitives),
        pipeline(context, memory, {"code", sizeof(OptixRayParams)}, hits, structure.content()) {}

  /// In the order of our tree.
  Primitives primitives_of(const std::vector<Sphere>& more) {
    if (more.empty()) return {};
    std::vector<Bounds> bounds;
    for (const Sphere& sphere : more) bounds.push_back(sphere_bounds(sphere));
    Bvh2 bvh = build_bvh2(bounds, static_cast<std::uint32_t>(more.size()), 1e-2f);
    for (const std::uint32_t i : bvh.order) spheres.push_back(more[i]);
    sphere_nodes = std::move(bvh.nodes);
    Primitives view;
    view.spheres = spheres.data(), view.sphere_count = static_cast<std::uint32_t>(spheres.size());
    return view;
  }

  std::vector<HitRecord> trace(const RaySet& set) {
    std::vector<HitRecord> hits(set.rays.size(), HitRecord{-7, 7});
    OptixRayParams params;
    params.scene = optix_scene(data.view(), structure, primitives, sphere_nodes.data());
    params.rays.rays = set.rays.data(), params.rays.hits = hits.data();
    params.rays.count = static_cast<std::uint32_t>(hits.size());
    const auto kind = set.type == RayType::any ? OptixPipeline::any : OptixPipeline::closest;
    pipeline.launch(kind, &params, 64);  // each thread takes several rays
    return hits;
  }
};

int count_differences(World& world, const RaySet& set) {
  const std::vector<HitRecord> hits = world.trace(set);
  int differ = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const RayRecord& ray = set.rays[i];
    Hit nearest;
    nearest.t = ray.t_max;
    for (std::uint32_t k = 0; k < world.spheres.size(); ++k)
      keep_nearer(nearest, sphere_distance(world.spheres[k], ray.ray()), k);
    if (set.type == RayType::any) {
      const bool met =
          nearest.t < ray.t_max || any_hit(world.data, ray.ray(), ray.t_min, ray.t_max);
      differ += (hits[i].t == 0) != met;
      continue;
    }
    const Hit hit = closest_hit(world.data, ray.ray(), ray.t_min, nearest.t);
    std::uint32_t id = nearest.primitive;
    if (!hit.is_miss()) id = world.data.triangles[hit.primitive].id + world.primitives.sphere_count;
    const float t = !hit.is_miss() ? hit.t : !nearest.is_miss() ? nearest.t : -1.0f;
    differ += hits[i].primitive != id || hits[i].t != t;
  }
  return differ;
}

/// Of all sizes, some twice; one is a ground below the others. And dots, for which rounding is
/// much.
std::vector<Sphere> many_spheres() {
  TestRandom random(3);
  std::vector<Sphere> spheres{{{0, -200, 0}, 190.0f * 190.0f}};
  for (int i = 0; i < 20; ++i) {
    const float radius = 4.0f * std::pow(random.unit(), 4.0f) + 1e-3f;
    spheres.push_back({point_in_cube(random, 20), radius * radius});
    if (i % 5 == 0) spheres.push_back(spheres.back());
  }
  for (int i = 0; i < 10; ++i) spheres.push_back({point_in_cube(random, 0.02f), 1e-6f});
  return spheres;
}

/// From near and far towards silhouettes, a few ulps of the ray's length beside them; those of
/// `faces` near where the sphere touches its box.
RaySet grazing_rays(const std::vector<Sphere>& spheres, int count, RayType type, bool faces) {
  TestRandom random(7);
  RaySet set;
  set.type = type;
  for (int i = 0; i < count; ++i) {
    const Sphere& sphere = spheres[static_cast<std::size_t>(i) % spheres.size()];
    glm::dvec3 direction(glm::normalize(point_in_cube(random, 1)));
    glm::dvec3 side = glm::normalize(glm::cross(direction, glm::dvec3(point_in_cube(random, 1))));
    if (faces) {
      const int axis = i / 2 % 3;
      side = glm::dvec3(0), side[axis] = i % 4 < 2 ? 1 : -1;
      direction[axis] *= 0.01;
      direction = glm::normalize(direction);
    }
    const double length = 100 * random.unit();
    const double beside = (random.unit() - 0.5) * (i % 2 == 0 ? 2e-8 : 1e-4) * length;
    const glm::dvec3 origin =
        glm::dvec3(sphere.center) + side * (double{sphere.radius()} + beside) - length * direction;
    set.rays.push_back({Vec3(origin), 0, Vec3(direction), infinite_distance});
    if (i % 4 == 0) set.rays.back().t_max = static_cast<float>(length);
  }
  return set;
}

class Optix : public testing::TestWithParam<OptixHits> {
 protected:
  void SetUp() override {
    fake_.emulate(ray_programs(), [](const void* params) {
      ray_params = static_cast<const OptixRayParams*>(params);
    });
  }

  /// Our test judges: no hit may differ. OptiX's own choice may, at edges and of equal distances.
  void expect_equal(World& world, const RaySet& set) const {
    const int differ = count_differences(world, set);
    if (GetParam() == OptixHits::built_in) {
      RecordProperty("differing", differ);
    } else {
      EXPECT_EQ(differ, 0) << "of " << set.rays.size();
    }
  }

  UsedFakeOptix fake_;
};

TEST_P(Optix, GivesTheHitsOfOurTreesWhereTheseAreHard) {
  for (const MeshKind& kind : hard_mesh_kinds) {
    SCOPED_TRACE(kind.name);
    const Mesh mesh = kind.make(120);
    World world(tree_kinds[2].build({mesh}), GetParam());
    for (const RayType type : {RayType::closest, RayType::any})
      expect_equal(world, hard_rays(mesh, 40, type));
  }
}

TEST_P(Optix, GivesTheHitsOfInstances) {
  const InstancedMeshes meshes = make_instanced_meshes(12);
  for (const TreeKind& kind : {tree_kinds[2], tree_kinds[3]}) {
    World world(kind.build(meshes.meshes, meshes.instances), GetParam());
    for (const RayType type : {RayType::closest, RayType::any})
      expect_equal(world, rays_through(800, type));
  }
}

TEST_P(Optix, GivesTheHitsOfSpheres) {
  const std::vector<Sphere> spheres = many_spheres();
  const InstancedMeshes meshes = make_instanced_meshes(5);
  for (const TriangleTreeData& tree :
       {tree_kinds[2].build({}), tree_kinds[2].build({make_soup(60, 5)}),
        tree_kinds[2].build(meshes.meshes, meshes.instances)}) {
    World world(tree, GetParam(), spheres);
    for (const RayType type : {RayType::closest, RayType::any}) {
      for (const bool faces : {false, true})
        expect_equal(world, grazing_rays(spheres, 2000, type, faces));
    }
  }
}

double reach_of_hits(const Sphere& sphere, double distance) {
  const double radius = std::sqrt(double{sphere.radius_squared});
  return radius + half_ulp * (23 * distance + 14 * radius);
}

// Rays begin anywhere within OptixReach.
TEST(OptixSpheres, HaveBoxesForTheFarthestRays) {
  UsedFakeOptix fake;
  const std::vector<Sphere> spheres = many_spheres();
  const World world(tree_kinds[2].build({}), OptixHits::any_hit, spheres);
  const OptixReach& reach = world.structure.reach();
  int boxes = 0;
  for (const auto& [handle, structure] : fake->structures) {
    for (std::size_t i = 0; i < structure.boxes.size(); ++i, ++boxes) {
      const Sphere& sphere = world.spheres.at(i);
      const glm::dvec3 center(sphere.center);
      const double distance =
          glm::length(glm::abs(center - glm::dvec3(reach.centre)) + double{reach.distance});
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LT(structure.boxes[i].min[axis], center[axis] - reach_of_hits(sphere, distance));
        EXPECT_GT(structure.boxes[i].max[axis], center[axis] + reach_of_hits(sphere, distance));
      }
    }
  }
  EXPECT_EQ(boxes, static_cast<int>(spheres.size()));
}

// The bound on which their boxes rest: our test meets them beyond their surface, too.
TEST(OptixSpheres, AreMetNearTheirSurface) {
  const std::vector<Sphere> spheres = many_spheres();
  int beyond = 0;
  for (const RayRecord& ray : grazing_rays(spheres, 20000, RayType::closest, false).rays) {
    for (const Sphere& sphere : spheres) {
      const float t = sphere_distance(sphere, ray.ray());
      if (!(t > 0)) continue;
      const glm::dvec3 to = glm::dvec3(sphere.center) - glm::dvec3(ray.origin);
      const double from_center = glm::length(double{t} * glm::dvec3(ray.direction) - to);
      beyond += from_center > reach_of_hits(sphere, 0);
      EXPECT_LE(from_center, reach_of_hits(sphere, glm::length(to)));
    }
  }
  EXPECT_GT(beyond, 100);
}

TEST_P(Optix, FindsSomethingAndMisses) {
  const Mesh mesh = make_soup(200, 5);
  World world(tree_kinds[2].build({mesh}), GetParam());
  const std::vector<HitRecord> hits = world.trace(hard_rays(mesh, 40));
  const auto misses = std::ranges::count(hits, no_primitive, &HitRecord::primitive);
  EXPECT_GT(misses, 0);
  EXPECT_LT(misses, static_cast<std::ptrdiff_t>(hits.size()));
}

TEST_P(Optix, OfNoTrianglesMeetsNothing) {
  World world(brute_kind.build({}), GetParam());
  EXPECT_EQ(world.structure.handle(), 0u);
  RaySet set;
  set.rays.push_back({Vec3(0), 0, Vec3(1, 0, 0), infinite_distance});
  EXPECT_EQ(world.trace(set)[0].primitive, no_primitive);
}

TEST_P(Optix, FailsAtEachCallInOneLineAndLeavesNothing) {
  const InstancedMeshes meshes = make_instanced_meshes(2);
  const TriangleTreeData tree = brute_kind.build(meshes.meshes, meshes.instances);
  const Sphere sphere{{1, 2, 3}, 4};
  fake_->run = nullptr;
  const auto use = [&](HostOptixMemory& memory) {
    const char params[16] = {};
    Scene scene;
    scene.triangles = tree.view();
    scene.primitives.spheres = &sphere, scene.primitives.sphere_count = 1;
    OptixTracer tracer(memory, scene, GetParam(),
                       {"code", 16, {"__raygen__paths"}, std::span(params).first(4)});
    tracer.launch(OptixPipeline::paths, params, 1);
    RenderReport report;
    tracer.describe(report, true);
    EXPECT_TRUE(report.optix->reorders);
  };
  fake_->reordering = 1;
  HostOptixMemory memory;
  use(memory);
  const auto calls = fake_->calls;
  EXPECT_EQ(fake_->live, 0);
  EXPECT_TRUE(memory.allocated.empty());
  ASSERT_GT(calls.size(), 20u);
  for (std::size_t i = 0; i < calls.size(); ++i) {
    fake_->calls.clear();
    fake_->fail_at = static_cast<int>(i);
    std::string message;
    try {
      use(memory);
    } catch (const Error& error) {
      message = error.what();
    }
    SCOPED_TRACE(calls[i] + ": " + message);
    EXPECT_EQ(message.rfind("OptiX: ", 0), 0u);
    EXPECT_EQ(message.find('\n'), std::string::npos);
    EXPECT_TRUE(calls[i] == "query" ||
                message.find("OPTIX_ERROR_FAKE (7900)") != std::string::npos);
    const bool logs = calls[i].find("create") != std::string::npos && calls[i] != "context_create";
    EXPECT_EQ(message.find("the log?of two lines") != std::string::npos, logs);
    EXPECT_EQ(fake_->live, 0);
    EXPECT_TRUE(memory.allocated.empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Hits, Optix,
                         testing::Values(OptixHits::custom, OptixHits::any_hit,
                                         OptixHits::built_in),
                         hits_name);

std::string problem_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(OptixLibrary, RefusesWhatItDoesNotKnow) {
  UsedFakeOptix fake;
  const auto problem = [] { return problem_of([] { OptixLibrary(); }); };
  EXPECT_EQ(problem(), "");
  fake->known_abi = 88;
  EXPECT_NE(problem().find("ABI 87 with 48 functions (error 7801, unsupported ABI)"),
            std::string::npos);
  fake->known_abi = 87, fake->pointers = 47;
  EXPECT_NE(problem().find("(error 7802, size of the table)"), std::string::npos);
  setenv("PTEXP_OPTIX_LIBRARY", "/nowhere/libnvoptix.so.1", 1);
  EXPECT_NE(problem().find("cannot load '/nowhere/libnvoptix.so.1'"), std::string::npos);
  setenv("PTEXP_OPTIX_LIBRARY", "libc.so.6", 1);
  EXPECT_NE(problem().find("'libc.so.6' has no optixQueryFunctionTable"), std::string::npos);
}

TEST(OptixStructure, RefusesMoreThanOptixTakes) {
  UsedFakeOptix fake;
  const InstancedMeshes meshes = make_instanced_meshes(3);
  const TriangleTreeData tree = brute_kind.build(meshes.meshes, meshes.instances);
  HostOptixMemory memory;
  const OptixContext context(std::make_shared<const OptixLibrary>());
  const auto problem = [&] {
    return problem_of([&] { OptixStructure(context, memory, tree.view(), OptixHits::custom); });
  };
  fake->primitives_max = 2;
  EXPECT_NE(problem().find("triangles of a group; OptiX takes at most 2"), std::string::npos);
  fake->primitives_max = 1000000, fake->instances_max = 3;
  EXPECT_NE(problem().find("instances; OptiX takes at most 3"), std::string::npos);
}

TEST(OptixStructure, IsCompactedAndSaysHowLargeItIs) {
  UsedFakeOptix fake;
  const TriangleTreeData tree = brute_kind.build({make_soup(50, 5)});
  HostOptixMemory memory;
  const OptixContext context(std::make_shared<const OptixLibrary>());
  const OptixStructure structure(context, memory, tree.view(), OptixHits::any_hit);
  EXPECT_EQ(structure.bytes_built(), 512u);
  EXPECT_EQ(structure.bytes_compacted(), 128u);
  EXPECT_EQ(memory.allocated.size(), 1u);
}

TEST(OptixPipeline, NeedsCode) {
  UsedFakeOptix fake;
  HostOptixMemory memory;
  const OptixContext context(std::make_shared<const OptixLibrary>());
  EXPECT_NE(problem_of([&] {
              OptixPipeline(context, memory, {"", 16}, OptixHits::custom, {});
            }).find("built without programs"),
            std::string::npos);
}

TEST(OptixPipeline, NamesWhatItsProgramsMeet) {
  UsedFakeOptix fake;
  HostOptixMemory memory;
  const OptixContext context(std::make_shared<const OptixLibrary>());
  OptixPipeline(context, memory, {"some code", 16}, OptixHits::custom, {});
  EXPECT_EQ(fake->code, "some code");
  EXPECT_EQ(fake->pipeline.primitive_flags, optix::primitives_custom);
  EXPECT_EQ(fake->pipeline.graph_flags, optix::graph_single_gas);
  OptixPipeline(context, memory, {"some code", 16}, OptixHits::built_in, {true, false});
  EXPECT_EQ(fake->pipeline.primitive_flags, optix::primitives_triangle);
  EXPECT_EQ(fake->pipeline.graph_flags, optix::graph_single_level_instancing);
  OptixPipeline(context, memory, {"some code", 16}, OptixHits::built_in, {true, true});
  EXPECT_EQ(fake->pipeline.primitive_flags, optix::primitives_triangle | optix::primitives_custom);
}

TEST(OptixPipeline, RunsTheModulesOwnLaunchesAndKnowsItsConstants) {
  UsedFakeOptix fake;
  HostOptixMemory memory;
  const OptixContext context(std::make_shared<const OptixLibrary>());
  std::string launched;
  fake->run = [&](const FakeOptix::Launch& launch) { launched = launch.raygen; };
  const char params[] = {1, 2, 3, 4};
  OptixPipeline own(context, memory, {"code", 4, {"__raygen__a", "__raygen__b"}, {params, 3}},
                    OptixHits::any_hit, {});
  EXPECT_EQ(fake->constants, std::string({1, 2, 3}));
  own.launch(OptixPipeline::paths, params, 1);
  EXPECT_EQ(launched, "__raygen__a");
  own.launch(OptixPipeline::any, params, 1);
  EXPECT_EQ(launched, "__raygen__b");
  OptixPipeline usual(context, memory, {"code", 4}, OptixHits::any_hit, {});
  EXPECT_EQ(fake->constants, "");
  usual.launch(OptixPipeline::any, params, 1);
  EXPECT_EQ(launched, "__raygen__any_any_hit");
}

TEST(OptixModule, IsUnpacked) {
  // "OptiX\n" by gzip -n.
  const unsigned char packed[] = {31,  139, 8,   0, 0, 0,   0, 0,   2,   255, 243, 47, 40,
                                  201, 140, 224, 2, 0, 243, 0, 242, 135, 6,   0,   0,  0};
  EXPECT_EQ(unpack_optix_code(packed), "OptiX\n");
  EXPECT_EQ(unpack_optix_code(std::span(packed).first(1)), "");  // none was built
  std::vector<unsigned char> damaged(std::begin(packed), std::end(packed));
  damaged[12] ^= 1;
  EXPECT_NE(problem_of([&] { unpack_optix_code(damaged); }).find("damaged"), std::string::npos);
}

}  // namespace
}  // namespace pt
