// The lanes of persistent warps, emulated: the hits of the CPU's traversal, bit for bit.
#include <gtest/gtest.h>

// The emulation comes before what it emulates.
// clang-format off
#include "emulated_gpu.h"
#include "common/accel/traverse_triangles.h"
#include "common/accel/trace_cuda/instanced_lane.cuh"
#include "common/accel/trace_cuda/persistent_cwbvh.cuh"
// clang-format on
#include "accel/instanced_meshes.h"
#include "common/accel/build/build_triangle_tree.h"
#include "common/scene/prepare/prepare_steps.h"

namespace pt {
namespace {

/// Rays of a set, whose hits are kept.
struct KeptHits {
  const RaySet& rays;
  std::uint32_t next = 0, count = 0;
  std::vector<Hit> hits;

  explicit KeptHits(const RaySet& set)
      : rays(set), count(static_cast<std::uint32_t>(set.rays.size())), hits(set.rays.size()) {}

  std::uint32_t fetch(unsigned lane, ReservedRays& reserved, RayRecord& record, int& got) {
    const std::uint32_t first = reserve_rays(&next, count, lane, reserved, got);
    if (static_cast<int>(lane) < got) record = rays.rays[first + lane];
    return first;
  }
  void finish(std::uint32_t ray_id, const ClosestTriangle& query) { hits[ray_id] = query.result(); }
};

template <class Lane, class Work>
std::vector<Hit> trace_emulated(const TriangleTree& tree, Work&& work) {
  const auto memory = std::make_unique<PersistentMemory<Lane, 64>>();
  EmulatedBlock(64).run([&] { trace_persistent<Lane>(tree, *memory, work); });
  return work.hits;
}

template <class Lane, bool instanced>
void expect_hits_of_cpu(const std::vector<Mesh>& meshes, const std::vector<Instance>& instances,
                        int least_found = 200) {
  TreeOptions options;
  options.accel = AccelKind::cwbvh;
  const TriangleTreeData data = build_triangle_tree(meshes, instances, options);
  const TriangleTree tree = data.view();
  const RaySet rays = rays_through(3000, RayType::closest);
  const std::vector<Hit> hits = trace_emulated<Lane>(tree, KeptHits(rays));
  // Spatial splits put a triangle into several slots, of which the order of visits chooses one.
  const auto id_of = [&](const Hit& hit) {
    return hit.is_miss() ? no_primitive : tree.triangles[hit.primitive].id;
  };
  int found = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const RayRecord& r = rays.rays[i];
    const Hit hit = closest_triangle<Accel::cwbvh, instanced>(tree, r.ray(), r.t_min, r.t_max);
    EXPECT_EQ(id_of(hits[i]), id_of(hit)) << i;
    if (hit.is_miss()) continue;
    ++found;
    EXPECT_EQ(hits[i].t, hit.t) << i;
    EXPECT_EQ(hits[i].instance, hit.instance) << i;
  }
  EXPECT_GT(found, least_found);
}

/// The same of a world that moves, where a ray has a time instead of t_min.
struct KeptHitsAtTimes : KeptHits {
  const Motion& motion;

  KeptHitsAtTimes(const RaySet& set, const Motion& moving) : KeptHits(set), motion(moving) {}
  InstanceRecord placed(const InstanceRecord& instance, float time) const {
    return placed_at(instance, motion, time);
  }
};

TEST(PersistentLanes, HaveTheHitsOfTheCpu) {
  expect_hits_of_cpu<CwbvhLane<ClosestTriangle>, false>({make_soup(5000, 30, {}, 3)}, {});
}

TEST(PersistentLanes, HaveTheHitsOfTheCpuIfTheySpeculate) {
  using Lane = CwbvhLane<ClosestTriangle, true>;
  expect_hits_of_cpu<Lane, false>({make_soup(5000, 30, {}, 3)}, {});
  const Mesh few = make_soup(7, 30, {}, 3);  // all are in leaves of the root
  expect_hits_of_cpu<Lane, false>({few}, {}, 5);
}

TEST(PersistentLanes, HaveTheHitsOfTheCpuInInstances) {
  const InstancedMeshes world = make_instanced_meshes(60);
  expect_hits_of_cpu<InstancedLane<ClosestTriangle>, true>(world.meshes, world.instances);
}

TEST(PersistentLanes, HaveTheHitsOfTheCpuInInstancesThatMove) {
  const InstancedMeshes world = make_instanced_meshes(60);
  SceneData scene;
  scene.meshes = world.meshes, scene.instances = world.instances;
  for (std::uint32_t i = 0; i < scene.instances.size(); i += 2) {
    const Affine& begin = scene.instances[i].to_world;
    const Affine middle = translate({2, 3, -1}) * begin * rotate({1, 2, 3}, 100);
    scene.motion.instances.push_back({i, {{0, begin}, {0.4f, middle}, {1, begin}}});
  }
  TreeOptions options;
  options.accel = AccelKind::cwbvh;
  prepare_motion(scene);
  const Motion& motion = scene.motion.prepared->view;
  const TriangleTreeData data =
      build_triangle_tree(scene.meshes, scene.instances, options, scene.motion.tracks());
  const TriangleTree tree = data.view();
  RaySet rays = rays_through(20'000, RayType::closest);
  for (std::size_t i = 0; i < rays.rays.size(); ++i)
    rays.rays[i].t_min = static_cast<float>(i % 97) / 97;  // the time

  const std::vector<Hit> hits = trace_emulated<InstancedLane<TimedQuery<ClosestTriangle>>>(
      tree, KeptHitsAtTimes(rays, motion));
  int found = 0, moving = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const RayRecord& r = rays.rays[i];
    MovingQuery<ClosestTriangle> query(0.0f, r.t_max, motion, r.t_min);
    traverse_triangles<Accel::cwbvh, true>(tree, r.ray(), query);
    const Hit hit = query.result();
    EXPECT_EQ(hits[i].is_miss(), hit.is_miss()) << i;
    if (hit.is_miss() || hits[i].is_miss()) continue;
    ++found;
    moving += tree.instances[hit.instance].track.moves() ? 1 : 0;
    EXPECT_EQ(hits[i].t, hit.t) << i;
    EXPECT_EQ(hits[i].instance, hit.instance) << i;
    EXPECT_EQ(tree.triangles[hits[i].primitive].id, tree.triangles[hit.primitive].id) << i;
  }
  EXPECT_GT(found, 200);
  EXPECT_GT(moving, 50);
}

}  // namespace
}  // namespace pt
