// Small scenes that move.
#pragma once

#include "make_render.h"
#include "scene/nested_scenes.h"

namespace pt {

inline DeviceInfo cpu_of_motion() { return choose_device({DeviceChoice::Kind::cpu, 0}); }

inline Options motion_options(int width, int height, int spp, int max_depth = 1) {
  Options options;
  options.width = width, options.height = height, options.spp = spp, options.max_depth = max_depth;
  options.filter = {FilterKind::box, 0.5f};
  return options;
}

inline Mesh square_of(float x0, float x1, float y0, float y1, float z, std::uint32_t material,
                      std::uint32_t group = 0) {
  Mesh mesh;
  mesh.positions = {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
  mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  mesh.material = material, mesh.group = group;
  return mesh;
}

/// A floor, something turning over it, and a lamp that moves beside others.
inline SceneData moving_room() {
  SceneData scene;
  scene.name = "moving room";
  scene.camera.look_from = {0, 3, 6}, scene.camera.look_at = {0, 0.5f, 0};
  scene.sky.nadir = scene.sky.zenith = Color(0.1f);
  const std::uint32_t grey = scene.add_material(make_diffuse({0.7f, 0.6f, 0.5f}));
  const std::uint32_t glow = scene.add_material(make_diffuse(Color(0.0f), {9, 8, 7}));
  Mesh floor = square_of(-4, 4, -4, 4, 0, grey);
  for (Vec3& p : floor.positions) p = {p.x, 0, -p.y};
  Mesh folded = square_of(-2, -1, 0.1f, 1, 1, grey);  // deforms, with its normals
  folded.normals = std::vector<Vec3>(4, Vec3(0, 0, 1));
  folded.later_positions = {{{-2, 0.1f, 1}, {-0.5f, 0.1f, 1}, {-1, 1.5f, 2}, {-2, 1, 0}}};
  folded.later_normals = {{{0, 0, 1}, {0.6f, 0, 0.8f}, {0, -0.6f, 0.8f}, {0, 0, 1}}};
  scene.meshes = {floor, square_of(-0.5f, 0.5f, -0.5f, 0.5f, 0, grey, 1),
                  square_of(-0.4f, 0.4f, -0.3f, 0.3f, 0, glow, 2), folded};
  const Affine down = translate({-1, 2, 0}) * rotate({1, 0, 0}, 90);
  const Affine stand = translate({0.5f, 0.6f, 0.5f});
  scene.instances = {{1, stand}, {2, down}, {2, translate({1.5f, 1, -1}) * rotate({1, 0, 0}, 60)}};
  scene.motion.instances = {
      {0, {{0.0f, stand}, {1.0f, stand * rotate({0, 1, 0.3f}, 140)}}},
      {1,
       {{0.0f, down},
        {0.5f, translate({0, 1.5f, 0.5f}) * rotate({1, 0, 0}, 90) * scale({2, 1, 1})},
        {1.0f, translate({1, 2, 1}) * rotate({1, 0.3f, 0}, 130)}}}};
  const Affine camera = translate({0, 3, 6}) * rotate({1, 0, 0}, -22.6199f);
  scene.motion.camera = {{0.0f, camera}, {1.0f, translate({0.2f, 0.1f, 0}) * camera}};
  return scene;
}

/// The room with lamps that deform, of four sets of vertices: in an instance that moves, in one
/// that stands and mirrors, and in the world.
inline SceneData glowing_room() {
  SceneData scene = moving_room();
  scene.name = "lamps that deform";
  Mesh& lamp = scene.meshes[2];
  lamp.later_positions = {
      {{-0.8f, -0.3f, 0.1f}, {0.4f, -0.6f, 0}, {0.2f, 0.3f, -0.2f}, {-0.4f, 0, 0}},
      {{-0.2f, -0.3f, 0}, {0.2f, -0.3f, 0.1f}, {0.2f, 0.3f, 0}, {-0.2f, 0.3f, 0.1f}},
      {{-0.3f, -0.2f, 0.2f}, {0.3f, -0.2f, 0.2f}, {0.5f, 0.5f, 0}, {-0.5f, 0.3f, 0}}};
  Mesh& folded = scene.meshes[3];
  folded.later_positions.insert(folded.later_positions.end(), {folded.positions, folded.positions});
  for (Vec3& p : folded.later_positions[1]) p.y += 0.5f;
  folded.later_normals.insert(folded.later_normals.end(),
                              {folded.normals, folded.later_normals[0]});
  lamp.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  folded.material = lamp.material;
  scene.materials[lamp.material].emission.texture =
      add_picture(scene, 2, 1, {Color(1.0f), Color(0.25f)});
  scene.instances[2].to_world = scene.instances[2].to_world * scale({-1, 1, 1});
  return scene;
}

/// The room with balls instead: one that turns about a point beside it, with a picture, a lamp that
/// goes, and one that stands.
inline SceneData moving_spheres() {
  SceneData scene = moving_room();
  scene.name = "moving spheres";
  scene.meshes.resize(1), scene.instances.clear(), scene.motion.instances.clear();
  const auto move = [&](const TransformKey& begin, const TransformKey& end) {
    const auto sphere = static_cast<std::uint32_t>(scene.spheres.size() - 1);
    scene.motion.spheres.push_back({sphere, {begin, end}});
  };
  scene.add_sphere({-1.5f, 0.5f, 0}, 0.5f, 0);
  std::vector<Color> stripes;
  for (int i = 0; i < 8; ++i) stripes.emplace_back(i % 2 == 0 ? 0.9f : 0.1f);
  MaterialDescription striped = make_diffuse(Color(1.0f));
  striped.parameters[0].texture = add_picture(scene, 8, 1, stripes);
  const Affine stand = translate({0.5f, 0.6f, 0.5f});
  scene.add_sphere(stand.point({0.6f, 0, 0}), 0.4f, scene.add_material(striped), SphereFrame());
  move({0.0f, stand}, {1.0f, stand * rotate({0, 1, 0.3f}, 140)});
  scene.add_sphere({-1, 2, 0}, 0.25f, 1);
  move({0.0f, translate({-1, 2, 0})}, {0.8f, translate({1, 1.6f, 0.5f})});
  return scene;
}

/// Two rows of lamps close above a floor: spheres, and squares that turn. They have come from afar
/// when the shutter opens. The camera sees the floor beside them.
inline SceneData passing_lamps() {
  SceneData scene;
  scene.name = "passing lamps";
  scene.camera = {{6, 9, 2.6f}, {6, 0, 2.6f}, {0, 0, 1}, 12.0f, 0.0f, 9.0f};
  Mesh floor = square_of(-2, 15, -3, 4, 0, scene.add_material(make_diffuse(Color(0.7f))));
  for (Vec3& p : floor.positions) p = {p.x, 0, -p.y};
  const auto shining = scene.add_material(make_diffuse(Color(0.0f), Color(30.0f)));
  Mesh lamp = square_of(-0.1f, 0.1f, -0.1f, 0.1f, 0, shining);
  lamp.group = 1;
  scene.meshes = {floor, lamp};
  for (std::uint32_t i = 0; i < 12; ++i) {
    const Vec3 place(static_cast<float>(i), 0.4f, 0.0f), way(1, 0, 0), beside(0, 0, 1);
    const auto keys_of = [&](const Affine& at) {
      return std::vector<TransformKey>{{-9.0f, translate(-9.0f * way) * at},
                                       {1.0f, translate(way) * at * rotate({1, 0, 0}, 70)}};
    };
    const Affine at = translate(place);
    scene.instances.push_back({1, keys_of(at)[0].to_world});
    scene.motion.instances.push_back({i, keys_of(at)});
    scene.add_sphere(place + beside - 9.0f * way, 0.05f, shining);
    scene.motion.spheres.push_back({i, keys_of(translate(place + beside))});
  }
  return scene;
}

}  // namespace pt
