#include "common/scene/builtin/builtin_scenes.h"

#include <fmt/format.h>

#include "common/accel/build/build_triangle_tree.h"
#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/scene/builtin/dial.h"
#include "common/scene/builtin/generated_scenes.h"
#include "common/scene/builtin/quad_scenes.h"
#include "common/scene/prepare/prepare_scene.h"

namespace pt {
namespace {

// Rounded down from the peaks of resident memory of a million, so that nothing is refused that
// would fit.
constexpr std::uint64_t sphere_bytes = 450, instance_bytes = 500;
constexpr std::uint64_t mesh_bytes = 18;       // a triangle and half a vertex
constexpr std::uint64_t slot_bytes = 48;       // in the order of the leaves
constexpr std::uint64_t building_bytes = 100;  // a reference and a node besides the mesh
constexpr std::uint64_t voxel_bytes = 8;       // as it is made, and in the scene

std::uint64_t triangle_bytes(const Options& options) {
  if (is_device_builder(options.builder)) return mesh_bytes;
  return mesh_bytes + (options.accel == AccelKind::brute ? slot_bytes : building_bytes);
}

}  // namespace

void check_triangle_memory(const SceneRequest& request, std::uint64_t count) {
  check_host_memory(count * triangle_bytes(request.options), "--scene " + request.name.full);
}

void check_instance_memory(const SceneRequest& request, std::uint64_t count) {
  check_host_memory(count * instance_bytes, "--scene " + request.name.full);
}

void check_cloud_memory(const SceneRequest& request, std::uint64_t side) {
  check_host_memory(side * side * side * voxel_bytes, "--scene " + request.name.full);
}

void check_sphere_memory(std::uint64_t count) {
  check_host_memory(count * sphere_bytes, fmt::format("--spheres {}", count));
}

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

template <SphereWorldKind kind>
SceneData make_spheres(const SceneRequest& request) {
  const auto count = static_cast<std::uint32_t>(request.options.spheres);
  if (kind == SphereWorldKind::spheres) check_sphere_memory(count);
  return make_sphere_world(kind, count, request.create_world);
}

SceneData make_terrain(const SceneRequest& request) {
  const std::uint64_t count = parse_count(request.name, 1'000'000, terrain_least, terrain_most);
  check_triangle_memory(request, count);
  return make_terrain_scene(count);
}

SceneData make_statue(const SceneRequest& request) {
  const std::uint64_t count = parse_count(request.name, 1'000'000, statue_least, statue_most);
  check_triangle_memory(request, count);
  return make_statue_scene(count);
}

SceneData make_instances(const SceneRequest& request) {
  const ForestSettings settings = parse_forest(request.name);
  check_instance_memory(request, settings.trees);
  return make_forest_scene(settings.trees, settings.percent);
}

const SceneInfo& find_scene(const SceneName& name) {
  std::string names;
  for (const SceneInfo& info : scene_list()) {
    if (info.name == name.name) return info;
    names += (names.empty() ? "" : ", ") + info.name;
  }
  throw Error(fmt::format("--scene {}: no such scene; expected one of {}", name.full, names));
}

}  // namespace

const std::vector<SceneInfo>& scene_list() {
  static const std::vector<SceneInfo> list = {
      {"spheres", "",
       "the paper's: a ground and --spheres random diffuse and metal ones under a sky",
       make_spheres<SphereWorldKind::spheres>},
      {"rtow", "",
       "the final scene of 'Ray Tracing in One Weekend': about 488 spheres, some of glass",
       make_spheres<SphereWorldKind::rtow>},
      {"cornell", "", "the Cornell Box: quads, one area light, two blocks",
       [](const SceneRequest&) { return make_cornell_scene(); }},
      {"furnace", "", "a closed box in which every pixel must be 1: the test of energy",
       [](const SceneRequest&) { return make_furnace_scene(); }},
      {"ajar", "", "a room that gets its light through the gap of a door alone",
       [](const SceneRequest&) { return make_ajar_scene(); }},
      {"caustic", "", "light focused on a floor by a glass ball and a ring of mirrors",
       [](const SceneRequest&) { return make_caustic_scene(); }},
      {"fog", "", "the Cornell Box filled with a homogeneous medium",
       [](const SceneRequest&) { return make_fog_scene(); }},
      {"cloud", "N:T:A[:sparse[:P]]",
       "a cumulus on a grid of N^3 voxels (128), of optical depth T (10) and albedo A (0.999); "
       "sparse: several, which fill P (2) % of it",
       [](const SceneRequest& request) {
         const CloudSettings settings = parse_cloud(request.name);
         if (!settings.is_sparse) check_cloud_memory(request, settings.side);
         return make_cloud_scene(settings, request.options.volume);
       }},
      {"terrain", "N", "mountains of N triangles under a sky, 1M unless N is given", make_terrain},
      {"statue", "N", "a carved knot of N triangles under a sky and a lamp, 1M unless N is given",
       make_statue},
      {"instances", "N[:P]",
       "a forest of N trees (10K), repeating four; P (0) % of them sway while the shutter is open",
       make_instances},
      {"boxes", "SCALE", "512 boxes in a closed room, lit by a lamp; all lengths times SCALE",
       [](const SceneRequest& request) { return make_boxes_scene(parse_scale(request.name)); }},
      {"dial", "K:C:F",
       "cells of K materials (1 to 32), coherent by C (0 noise, 1 stripes), F open or closed",
       [](const SceneRequest& request) { return make_dial_scene(parse_dial(request.name)); }},
  };
  return list;
}

SceneData build_scene(const Options& options, const SphereWorldCreator& create_world) {
  const SceneName name = parse_scene_name(options.scene);
  const SceneInfo& info = find_scene(name);
  if (info.parameter.empty() && !name.parameter.empty()) {
    throw Error(fmt::format("--scene {}: scene '{}' takes no parameter", name.full, name.name));
  }
  const bool has_spheres = name.name == "spheres" || name.name == "rtow";
  if (create_world && !has_spheres) {
    throw Error(fmt::format("--create-world device: scene '{}' has no random spheres to create",
                            options.scene));
  }
  SceneData scene = info.make({name, options, create_world});
  scene.name = options.scene;
  return scene;
}

SceneData make_scene(const Options& options, const SphereWorldCreator& create_world) {
  SceneData scene = build_scene(options, create_world);
  prepare_scene(scene, options);
  return scene;
}

}  // namespace pt
