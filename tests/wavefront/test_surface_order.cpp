// The order of surfaces by the kind of their BSDFs.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <span>

#include "common/scene/data/scene_data.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/scene/prepare/prepare_steps.h"
#include "scene/material_room.h"
#include "statistics.h"
#include "wavefront/surface_order.h"

namespace pt {
namespace {

using Slots = std::vector<std::uint32_t>;

/// As the descriptions have it, without the records.
int expected_kind(const SceneData& scene, std::uint32_t material) {
  const MaterialDescription& m = scene.materials[material];
  if (m.node == MaterialNode::none) return static_cast<int>(m.kind);
  const int first = expected_kind(scene, m.children[0]),
            second = expected_kind(scene, m.children[1]);
  return first == second ? first : Bsdfs::size;
}

/// Panels, and spheres in front of them.
SceneData panels_and_spheres() {
  SceneData scene = material_room(false);
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t glass = scene.add_material(make_dielectric(Color(1.0f), 1.5f));
    scene.add_sphere({float(i), 0, 3}, 0.2f, i == 1 ? 0 : glass);
  }
  prepare_scene(scene, Options());
  return scene;
}

class SurfaceOrderOf : public testing::TestWithParam<std::uint32_t> {};
INSTANTIATE_TEST_SUITE_P(Counts, SurfaceOrderOf,
                         testing::Values(0, 1, 2, 4095, 4097, order_tile, order_tile + 1, 100'000));

TEST_P(SurfaceOrderOf, AStableSortByKindInEachTile) {
  const SceneData data = panels_and_spheres();
  const Scene scene = host_view(data, 8, 8);
  const std::uint32_t count = GetParam(), slot_count = count + 100;
  const auto primitives = scene.primitives.count();
  const auto things = primitives + static_cast<std::uint32_t>(data.tree.triangles.size());
  TestRandom random(count + 1);
  std::vector<StoredHit> hits(slot_count);
  for (StoredHit& hit : hits) hit = {1.0f, random.below(things)};
  Slots slots(slot_count);
  for (std::uint32_t i = 0; i < slot_count; ++i) slots[i] = i;
  for (std::uint32_t i = slot_count; i > 1; --i) std::swap(slots[i - 1], slots[random.below(i)]);

  const auto kind = [&](std::uint32_t slot) {
    const std::uint32_t thing = hits[slot].primitive;
    return expected_kind(data, thing < primitives
                                   ? data.material_of[thing]
                                   : data.tree.triangles[thing - primitives].material);
  };
  Slots expected(slots.begin(), slots.begin() + count);
  for (std::uint32_t begin = 0; begin < count; begin += order_tile) {
    const std::uint32_t in_tile = std::min(order_tile, count - begin);
    std::ranges::stable_sort(std::span(expected).subspan(begin, in_tile), {}, kind);
  }

  SurfaceOrder order;
  order.pool.hit = hits.data();
  order.slots = slots.data(), order.count = &count;
  Slots ordered(slot_count, 0xdeadbeef);
  order.ordered = ordered.data();
  order_surfaces_cpu(scene, order);

  for (std::size_t i = count; i < slot_count; ++i) ASSERT_EQ(ordered[i], 0xdeadbeef) << i;
  ordered.resize(count);
  EXPECT_EQ(ordered, expected);
  if (count < 100'000) return;
  std::uint32_t present = 0;
  for (const std::uint32_t slot : ordered) present |= 1u << kind(slot);
  EXPECT_EQ(present, kinds_of(data));  // all of these are hit
  EXPECT_EQ(std::popcount(present), kind_count);
}

}  // namespace
}  // namespace pt
