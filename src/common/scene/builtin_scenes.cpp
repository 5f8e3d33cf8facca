#include "common/scene/builtin_scenes.h"

#include <fmt/format.h>

#include "common/error.h"
#include "common/scene/prepare_scene.h"

namespace pt {
namespace {

SceneData make_sphere_world(SphereWorldKind kind, std::uint32_t count,
                            const SphereWorldCreator& create_world) {
  SceneData scene;
  const std::uint32_t capacity = sphere_world_capacity(kind, count);
  scene.spheres.resize(capacity);
  scene.materials.resize(capacity);
  SphereWorld world{scene.spheres.data(), scene.materials.data(), capacity};
  create_world ? create_world(world, kind, count) : create_sphere_world(world, kind, count);
  scene.spheres.resize(world.count);
  scene.materials.resize(world.count);
  for (std::uint32_t i = 0; i < world.count; ++i) scene.sphere_material.push_back(i);
  // The book's camera; its CUDA port, with which rtow is compared, sees 30 degrees.
  const float fov = kind == SphereWorldKind::rtow ? 30.0f : 20.0f;
  scene.camera = {{13, 2, 3}, {0, 0, 0}, {0, 1, 0}, fov, 0.1f, 10.0f};
  scene.sky = {Color(1.0f), {0.5f, 0.7f, 1.0f}};
  return scene;
}

// A box of six quads whose normals point outward (or inward), turned about the y axis.
void add_box(SceneData& scene, const Vec3& center, const Vec3& size, float turn_degrees,
             std::uint32_t material, bool inward = false) {
  const float angle = turn_degrees * pi / 180.0f;
  const Vec3 half = 0.5f * size;
  const Vec3 x = half.x * Vec3(std::cos(angle), 0, -std::sin(angle));
  const Vec3 y = half.y * Vec3(0, 1, 0);
  const Vec3 z = half.z * Vec3(std::sin(angle), 0, std::cos(angle));
  const auto face = [&](const Vec3& out, const Vec3& a, const Vec3& b) {  // cross(a, b) along out
    const Vec3 corner = center + out - a - b;
    inward ? scene.add_quad(corner, 2.0f * b, 2.0f * a, material)
           : scene.add_quad(corner, 2.0f * a, 2.0f * b, material);
  };
  face(x, y, z), face(-x, z, y), face(y, z, x), face(-y, x, z), face(z, x, y), face(-z, y, x);
}

// Goral et al. 1984, with the measured reflectances rounded as in the Cornell Box of most papers.
SceneData make_cornell() {
  SceneData scene;
  const auto white = scene.add_material(make_diffuse({0.73f, 0.73f, 0.73f}));
  const auto red = scene.add_material(make_diffuse({0.65f, 0.05f, 0.05f}));
  const auto green = scene.add_material(make_diffuse({0.12f, 0.45f, 0.15f}));
  const auto lamp = scene.add_material(make_diffuse(Color(0.0f), {17.0f, 12.0f, 4.0f}));
  scene.add_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, white);  // floor
  scene.add_quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, white);  // ceiling
  scene.add_quad({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, white);  // back
  scene.add_quad({-1, 0, -1}, {0, 2, 0}, {0, 0, 2}, red);    // left
  scene.add_quad({1, 0, -1}, {0, 0, 2}, {0, 2, 0}, green);   // right
  scene.add_quad({-0.25f, 1.99f, -0.25f}, {0.5f, 0, 0}, {0, 0, 0.5f}, lamp);
  add_box(scene, {-0.35f, 0.6f, -0.3f}, {0.6f, 1.2f, 0.6f}, 17.0f, white);
  add_box(scene, {0.35f, 0.3f, 0.35f}, {0.6f, 0.6f, 0.6f}, -17.0f, white);
  scene.camera = {{0, 1, 4.8f}, {0, 1, 0}, {0, 1, 0}, 30.0f, 0.0f, 4.8f};
  return scene;
}

// Everything here emits e and reflects 1 - e of what arrives, so every ray carries radiance 1.
SceneData make_furnace() {
  SceneData scene;
  const auto half = scene.add_material(make_diffuse(Color(0.5f), Color(0.5f)));
  const auto most = scene.add_material(make_diffuse(Color(0.8f), Color(0.2f)));
  const auto mirror = scene.add_material(make_metal(Color(1.0f), 0.0f));
  const auto glass = scene.add_material(make_dielectric(Color(1.0f), 1.5f));
  add_box(scene, {0, 0, 0}, {4, 4, 4}, 0.0f, half, true);
  scene.add_sphere({-0.9f, -0.5f, 0}, 0.5f, most);
  scene.add_sphere({0.0f, 0.6f, -0.6f}, 0.5f, mirror);
  scene.add_sphere({0.9f, -0.5f, 0}, 0.5f, glass);
  scene.camera = {{0, 0, 1.9f}, {0, 0, 0}, {0, 1, 0}, 70.0f, 0.0f, 1.9f};
  return scene;
}

}  // namespace

const std::vector<SceneInfo>& scene_list() {
  static const std::vector<SceneInfo> list = {
      {"spheres", "the paper's: a ground and --spheres random diffuse and metal ones under a sky"},
      {"rtow", "the final scene of 'Ray Tracing in One Weekend': about 488 spheres, some of glass"},
      {"cornell", "the Cornell Box: quads, one area light, two blocks"},
      {"furnace", "a closed box in which every pixel must be 1: the test of energy"},
  };
  return list;
}

SceneData make_scene(const Options& options, const SphereWorldCreator& create_world) {
  const auto count = static_cast<std::uint32_t>(options.spheres);
  SceneData scene;
  if (options.scene == "spheres") {
    scene = make_sphere_world(SphereWorldKind::spheres, count, create_world);
  } else if (options.scene == "rtow") {
    scene = make_sphere_world(SphereWorldKind::rtow, count, create_world);
  } else if (create_world) {
    throw Error(fmt::format("--create-world device: scene '{}' has no random spheres to create",
                            options.scene));
  } else if (options.scene == "cornell") {
    scene = make_cornell();
  } else if (options.scene == "furnace") {
    scene = make_furnace();
  } else {
    std::string names;
    for (const SceneInfo& info : scene_list()) names += (names.empty() ? "" : ", ") + info.name;
    throw Error(fmt::format("--scene {}: no such scene; expected one of {}", options.scene, names));
  }
  scene.name = options.scene;
  prepare_scene(scene, options);
  return scene;
}

}  // namespace pt
