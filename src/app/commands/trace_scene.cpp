#include "app/commands/trace_scene.h"

#include <fmt/format.h>

#include "app/render/make_renderer.h"
#include "common/device/devices.h"
#include "common/error/error.h"
#include "common/rays/ray_file.h"
#include "common/scene/prepare/convert_quads.h"

namespace pt {

SceneData load_traced_scene(const std::string& name) {
  SceneData scene;
  if (name.ends_with(".mesh")) {
    scene.meshes.push_back(read_trace_mesh(name));
    scene.add_material(MaterialDescription());
  } else {
    Options options;
    options.scene = name;
    scene = load_scene(options, choose_device({DeviceChoice::Kind::cpu, 0}));
    convert_quads(scene);
  }
  scene.name = name;
  return scene;
}

SceneData load_triangles(const std::string& name) {
  SceneData scene = load_traced_scene(name);
  scene.spheres.clear();
  scene.sphere_material.clear();
  if (scene.triangle_count() == 0) throw Error(fmt::format("{}: has no triangles", name));
  return scene;
}

}  // namespace pt
