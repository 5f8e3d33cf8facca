// A scene in which paths of all kinds meet media, and how it is rendered to compare modes.
#pragma once

#include "medium/medium_scenes.h"

namespace pt {

/// A camera in a haze of varying density; in it a ball of coloured smoke, which glows in places, a
/// turned box, glass around a clear red medium, a floor and two lights.
inline SceneData clouds() {
  TestRandom random(71);
  SceneData scene;
  scene.name = "clouds";
  constexpr std::uint32_t smoke = 0, boxed = 1, haze = 2, dye = 3;
  scene.media.push_back(make_medium({1.5f, 0.9f, 3.0f}, Color(0.95f)));
  scene.media.push_back(
      make_medium(Color(2.0f), {0.9f, 0.8f, 0.5f}, phase_kind_of<HenyeyGreenstein>, 0.6f));
  scene.media.push_back(make_medium(Color(0.05f), Color(1.0f), phase_kind_of<Rayleigh>));
  scene.media.push_back(make_medium({0.0f, 1.0f, 1.0f}, {1.0f, 0.5f, 0.2f}));
  const auto add = [&](const GridSize& size, std::uint32_t channels, bool interpolates,
                       const Affine& to_world) {
    return add_grid(scene, random_volume(random, size, channels, interpolates, to_world));
  };
  const Affine ball = translate({-1.2f, 0.2f, 0}) * scale(Vec3(2.0f)) * translate(Vec3(-0.5f));
  scene.media[smoke].density_grid = add({9, 12, 20}, 3, true, ball);
  scene.media[smoke].albedo_grid = add_grid(
      scene, make_volume({3, 2, 1}, 3, true, ball,
                         [&](const GridSize&, std::uint32_t) { return random.uniform(0.5, 1); }));
  scene.media[smoke].emission = {0.3f, 0.2f, 0.1f};
  scene.media[smoke].emission_grid = add({2, 2, 3}, 1, false, ball);
  scene.media[boxed].density_grid =
      add({17, 3, 5}, 1, false, translate({1.2f, 0, 0}) * rotate({1, 2, 3}, 40.0f));
  scene.media[haze].density_grid =
      add({1, 30, 7}, 1, true, scale(Vec3(8.0f)) * translate(Vec3(-0.5f)));
  scene.add_sphere({-1.2f, 0.2f, 0}, 1, scene.add_material(make_boundary(haze, smoke)));
  add_cuboid(scene, {0.6f, -0.9f, -0.7f}, {1.8f, 0.6f, 0.5f},
             scene.add_material(make_boundary(haze, boxed)));
  scene.add_sphere(Vec3(0.0f), 5, scene.add_material(make_boundary(no_medium, haze)));
  MaterialDescription glass = make_dielectric(Color(1.0f), 1.5f);
  glass.is_boundary = true, glass.media = {haze, dye};
  scene.add_sphere({0.1f, -0.5f, 1.3f}, 0.4f, scene.add_material(glass));
  add_floor_and_lights(scene);
  scene.sky = {Color(0.2f), {0.5f, 0.6f, 0.9f}};
  scene.camera = {{0.3f, 0.8f, 3.8f}, {0, 0, 0}, {0, 1, 0}, 45.0f, 0.0f, 4.0f};
  scene.camera_medium = haze;
  return scene;
}

/// The same with priorities, and with shapes that overlap: a box reaches into the smoke and hides a
/// part of a ball of glass.
inline SceneData overlapping_clouds() {
  SceneData scene = clouds();
  scene.name = "overlapping clouds";
  constexpr std::uint32_t smoke = 0, boxed = 1, haze = 2, dye = 3;
  scene.media[smoke].priority = -1, scene.media[haze].priority = -2;
  scene.media[boxed].priority = 4, scene.media[dye].priority = 3;
  add_cuboid(scene, {-0.9f, -0.9f, -0.7f}, {0.2f, 0.3f, 0.8f}, material_around(scene, boxed));
  scene.add_sphere({0.2f, 0.1f, 0.6f}, 0.5f, material_around(scene, dye));
  return scene;
}

inline Options cloud_options(const std::string& mode, const Settings& more = {}) {
  return with(with(Options(), {{"device", "cpu"},
                               {"mode", mode},
                               {"width", "23"},
                               {"height", "15"},
                               {"spp", "4"},
                               {"max-depth", "9"},
                               {"rr", "5"}}),
              more);
}

inline Rendered render_clouds(SceneData scene, const Options& options) {
  const DeviceInfo device = choose_device(options.device);
  prepare_scene_for(scene, options, device);
  return take_image(*make_renderer(options, scene, device));
}

}  // namespace pt
