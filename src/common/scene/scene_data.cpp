#include "common/scene/scene_data.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/accel/build_bvh2.h"
#include "common/accel/traverse_brute.h"
#include "common/error.h"

namespace pt {

std::uint32_t SceneData::add_material(const Material& material) {
  materials.push_back(material);
  return static_cast<std::uint32_t>(materials.size() - 1);
}

void SceneData::add_sphere(const Vec3& center, float radius, std::uint32_t material) {
  spheres.push_back({center, radius * radius});
  sphere_material.push_back(material);
}

void SceneData::add_quad(const Vec3& corner, const Vec3& a, const Vec3& b, std::uint32_t material) {
  quads.push_back(make_quad(corner, a, b));
  quad_material.push_back(material);
}

namespace {

Vec3 to_vec3(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

void override_camera(CameraParameters& camera, const CameraOverrides& overrides) {
  if (overrides.look_from) camera.look_from = to_vec3(*overrides.look_from);
  if (overrides.look_at) camera.look_at = to_vec3(*overrides.look_at);
  if (overrides.up) camera.up = to_vec3(*overrides.up);
  camera.vertical_fov_degrees =
      overrides.vertical_fov_degrees.value_or(camera.vertical_fov_degrees);
  camera.aperture = overrides.aperture.value_or(camera.aperture);
  camera.focus_distance = overrides.focus_distance.value_or(camera.focus_distance);
}

void check_camera(const CameraParameters& camera) {
  const Vec3 backward = camera.look_from - camera.look_at;
  if (glm::dot(backward, backward) == 0.0f) {
    throw Error("--look-from and --look-at are the same point; the camera needs a direction");
  }
  const Vec3 side = glm::cross(camera.up, backward);
  if (glm::dot(side, side) <=
      1e-12f * glm::dot(camera.up, camera.up) * glm::dot(backward, backward)) {
    throw Error("--up is zero or parallel to the view direction; choose another vector");
  }
  if (!(camera.vertical_fov_degrees > 0.0f && camera.vertical_fov_degrees < 180.0f)) {
    throw Error(fmt::format("--fov {}: expected degrees between 0 and 180, both excluded",
                            camera.vertical_fov_degrees));
  }
  if (!(camera.aperture >= 0.0f)) {
    throw Error(fmt::format("--aperture {}: expected a diameter >= 0", camera.aperture));
  }
  if (!(camera.focus_distance > 0.0f)) {
    throw Error(fmt::format("--focus-distance {}: expected a distance > 0", camera.focus_distance));
  }
}

Bounds quad_bounds(const Quad& quad) {
  Bounds bounds;
  for (int i = 0; i < 4; ++i) {
    bounds.grow(quad.corner + static_cast<float>(i & 1) * quad.edge_a +
                static_cast<float>(i >> 1) * quad.edge_b);
  }
  return bounds;
}

std::vector<Bounds> primitive_bounds(const SceneData& scene) {
  std::vector<Bounds> bounds;
  bounds.reserve(scene.primitive_count());
  for (const Sphere& s : scene.spheres) {
    bounds.push_back({s.center - s.radius(), s.center + s.radius()});
  }
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

void build_structure(SceneData& scene) {
  const std::vector<Bounds> bounds = primitive_bounds(scene);
  Bounds all;
  for (const Bounds& b : bounds) all.grow(b);
  all.grow(scene.camera.look_from);
  const float scale = std::max(max_abs(all.min), max_abs(all.max));
  const auto sphere_count = static_cast<std::uint32_t>(scene.spheres.size());
  Bvh2 bvh = build_bvh2(bounds, sphere_count, 16.0f * half_ulp * scale);
  const std::span<const std::uint32_t> order(bvh.order);
  const auto sphere_order = order.first(sphere_count);
  const auto quad_order = order.subspan(sphere_count);
  scene.spheres = permuted(scene.spheres, sphere_order, 0);
  scene.sphere_material = permuted(scene.sphere_material, sphere_order, 0);
  scene.quads = permuted(scene.quads, quad_order, sphere_count);
  scene.quad_material = permuted(scene.quad_material, quad_order, sphere_count);
  scene.bvh_nodes = std::move(bvh.nodes);
  // The lights keep their order, and with it the image.
  std::vector<std::uint32_t> place(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  for (std::uint32_t& light : scene.lights) light = place[light];
}

void list_lights(SceneData& scene) {
  scene.lights.clear();
  for (std::uint32_t i = 0; i < scene.material_of.size(); ++i) {
    if (!is_black(scene.materials[scene.material_of[i]].emission)) scene.lights.push_back(i);
  }
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
  float extent = glm::length(scene.camera.look_from - center) + scene.camera.aperture;
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
  while (scene.scan_spheres.size() % scan_group != 0) {
    scene.scan_spheres.push_back({Vec3(0.0f), -HUGE_VALF});
  }
}

// Up to here testing every primitive is faster than walking a tree: results/ has the measurement.
constexpr std::size_t brute_force_max = 96;

}  // namespace

void prepare_scene(SceneData& scene, const Options& options) {
  if (scene.primitive_count() == 0) {
    throw Error(fmt::format("scene '{}' is empty: expected at least one primitive", scene.name));
  }
  override_camera(scene.camera, options.camera);
  check_camera(scene.camera);
  join_materials(scene);
  list_lights(scene);
  const bool brute =
      options.accel == AccelKind::brute ||
      (options.accel == AccelKind::automatic && scene.primitive_count() <= brute_force_max);
  scene.accel = brute ? Accel::brute : Accel::bvh2;
  scene.bvh_nodes.clear();
  if (!brute) {
    build_structure(scene);
    join_materials(scene);
  }
  make_scan(scene);
}

Scene host_view(const SceneData& scene, int width, int height) {
  Scene view;
  view.camera = make_camera(scene.camera, width, height);
  view.sky = scene.sky;
  view.primitives = {scene.spheres.data(), scene.quads.data(),
                     static_cast<std::uint32_t>(scene.spheres.size()),
                     static_cast<std::uint32_t>(scene.quads.size())};
  view.primitives.scan = scene.scan_spheres.data();
  view.primitives.scan_count = static_cast<std::uint32_t>(scene.scan_spheres.size());
  view.primitives.scan_center = scene.scan_center;
  view.bvh_nodes = scene.bvh_nodes.data();
  view.materials = scene.materials.data();
  view.material_of = scene.material_of.data();
  view.lights = scene.lights.data();
  view.light_count = static_cast<std::uint32_t>(scene.lights.size());
  return view;
}

}  // namespace pt
