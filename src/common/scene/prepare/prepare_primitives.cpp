#include <algorithm>
#include <numeric>

#include "common/accel/build/binary/build_bvh2.h"
#include "common/accel/traverse_brute.h"
#include "common/geometry/primitives.h"
#include "common/scene/prepare/prepare_half_spheres.h"
#include "common/scene/prepare/prepare_steps.h"

namespace pt {
namespace {

std::vector<Bounds> primitive_bounds(const SceneData& scene) {
  std::vector<Bounds> bounds;
  bounds.reserve(scene.primitive_count());
  for (const Sphere& s : scene.spheres) bounds.push_back(sphere_bounds(s));
  for (std::size_t i = 0; i < scene.motion.spheres.size(); ++i)
    bounds[scene.motion.spheres[i].sphere] = moving_sphere_bounds(scene, i);
  for (const Quad& q : scene.quads) bounds.push_back(quad_bounds(q));
  return bounds;
}

template <class T>
std::vector<T> permuted(const std::vector<T>& values, std::span<const std::uint32_t> order,
                        std::uint32_t first) {
  std::vector<T> result;
  result.reserve(values.size());
  for (const std::uint32_t i : order) result.push_back(values[i - first]);
  return result;
}

void build_structure(SceneData& scene, const Bounds& others) {
  const std::vector<Bounds> bounds = primitive_bounds(scene);
  Bounds all;
  for (const Bounds& b : bounds) all.grow(b);
  all.grow(scene.camera.look_from - scene.camera_extent);
  all.grow(scene.camera.look_from + scene.camera_extent);
  if (!others.is_empty()) all.grow(others);
  const float scale = std::max(max_abs(all.min), max_abs(all.max));
  const auto sphere_count = static_cast<std::uint32_t>(scene.spheres.size());
  Bvh2 bvh = build_bvh2(bounds, sphere_count, 16.0f * half_ulp * scale);
  const std::span<const std::uint32_t> order(bvh.order);
  const auto sphere_order = order.first(sphere_count);
  const auto quad_order = order.subspan(sphere_count);
  scene.spheres = permuted(scene.spheres, sphere_order, 0);
  scene.sphere_material = permuted(scene.sphere_material, sphere_order, 0);
  if (!scene.sphere_frames.empty()) {
    scene.sphere_frames = permuted(scene.sphere_frames, sphere_order, 0);
  }
  std::vector<std::uint32_t> places(sphere_order.size());
  for (std::uint32_t i = 0; i < places.size(); ++i) places[sphere_order[i]] = i;
  for (MotionData::MovingSphere& moving : scene.motion.spheres)
    moving.sphere = places[moving.sphere];
  scene.quads = permuted(scene.quads, quad_order, sphere_count);
  scene.quad_material = permuted(scene.quad_material, quad_order, sphere_count);
  scene.primitive_numbers = permuted(scene.primitive_numbers, order, 0);
  scene.bvh_nodes = std::move(bvh.nodes);
}

void join_materials(SceneData& scene) {
  scene.material_of = scene.sphere_material;
  scene.material_of.insert(scene.material_of.end(), scene.quad_material.begin(),
                           scene.quad_material.end());
}

// The middle of the spheres' centres, axis by axis: a ground of radius 1000 does not move it far.
Vec3 median_center(const std::vector<Sphere>& spheres) {
  Vec3 center(0.0f);
  if (spheres.empty()) return center;
  std::vector<float> values(spheres.size());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(spheres.begin(), spheres.end(), values.begin(),
                   [&](const Sphere& s) { return s.center[axis]; });
    std::nth_element(values.begin(), middle, values.end());
    center[axis] = *middle;
  }
  return center;
}

// Spheres for the scan of traverse_brute.h. Its rounding error, and that of the exact test after
// it, is a few ulps of the largest distance between the centre and an origin of rays: a surface or
// the camera. Widened by more than that, the scan loses no hit.
void make_scan(SceneData& scene) {
  const Vec3 center = median_center(scene.spheres);
  float extent = glm::length(scene.camera.look_from - center) + scene.camera_extent;
  for (const Sphere& s : scene.spheres) {
    extent = std::max(extent, glm::length(s.center - center) + s.radius());
  }
  for (const Quad& q : scene.quads) {
    const Bounds b = quad_bounds(q);
    extent = std::max(extent, glm::length(glm::max(b.max - center, center - b.min)));
  }
  const float padding = 48.0f * half_ulp * extent;
  scene.scan_center = center;
  scene.scan_spheres.clear();
  for (const Sphere& s : scene.spheres) {
    const float radius = s.radius() + padding;
    scene.scan_spheres.push_back({s.center - center, radius * radius});
  }
  HalfScan halves = prepare_half_spheres(scene.scan_spheres);
  scene.half_spheres = std::move(halves.groups);
  scene.half_scale = halves.scale;
  while (scene.scan_spheres.size() % scan_group != 0) {
    scene.scan_spheres.push_back({Vec3(0.0f), -HUGE_VALF});
  }
}

}  // namespace

void list_emitters(SceneData& scene) {
  const auto emission_of = [&](std::uint32_t primitive) {
    return scene.material_records[scene.material_of[primitive]].emission;
  };
  scene.lights.clear(), scene.light_emission.clear();
  for (std::uint32_t i = 0; i < scene.material_of.size(); ++i) {
    if (emission_of(i) != no_emission) scene.lights.push_back(i);
  }
  std::ranges::sort(scene.lights, {}, [&](auto i) { return scene.primitive_numbers[i]; });
  for (const std::uint32_t i : scene.lights) scene.light_emission.push_back(emission_of(i));
}

void prepare_primitives(SceneData& scene, bool tree, const Bounds& others) {
  join_materials(scene);
  scene.bvh_nodes.clear();
  scene.primitive_numbers.resize(scene.primitive_count());
  std::iota(scene.primitive_numbers.begin(), scene.primitive_numbers.end(), 0u);
  if (tree) {
    build_structure(scene, others);
    join_materials(scene);
  }
  list_emitters(scene);
  make_scan(scene);
}

}  // namespace pt
