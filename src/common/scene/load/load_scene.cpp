#include "common/scene/load/load_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/default_lighting.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/meshes/vertex_colors.h"
#include "common/scene/load/files/text.h"

namespace pt {
namespace {

/// What a file of meshes alone does not say.
void complete(const std::filesystem::path& path, const LoadOptions& options, SceneData& scene) {
  const Bounds bounds = scene_bounds(scene);
  if (bounds.is_empty()) {
    throw Error(fmt::format("{}: no triangles: expected at least one", path.string()));
  }
  scene.name = path.filename().string();
  scene.camera = frame_scene(scene);
  const std::string light = light_model(options, true, scene);
  if (options.warn) {
    options.warn(fmt::format("{}: the format has no camera: one that frames the scene is used{}{}",
                             path.string(), light.empty() ? "" : "; ", light));
  }
}

SceneData load_ply(const std::filesystem::path& path, const LoadOptions& options) {
  SceneData scene;
  std::vector<std::string> warnings;
  MeshFileOptions reading;
  reading.warnings = &warnings;
  Mesh mesh = read_ply(path, reading);
  for (const std::string& warning : warnings) options.report(path.string() + ": " + warning);
  VertexColors colors(scene, options);
  mesh.material = scene.add_material(make_diffuse(Color(mesh.colors.empty() ? 0.5f : 1.0f)));
  colors.tint(mesh, false, path.string());
  scene.meshes.push_back(std::move(mesh));
  colors.finish();
  complete(path, options, scene);
  return scene;
}

SceneData load_obj_alone(const std::filesystem::path& path, const LoadOptions& options) {
  SceneData scene = load_obj(path, options);
  complete(path, options, scene);
  return scene;
}

/// A format whose files say what lights them.
template <SceneData (*load)(const std::filesystem::path&, const LoadOptions&)>
SceneData load_lit(const std::filesystem::path& path, const LoadOptions& options) {
  SceneData scene = load(path, options);
  const std::string light = light_scene(options, scene);
  if (options.warn && !light.empty()) options.warn(fmt::format("{}: {}", path.string(), light));
  return scene;
}

struct Format {
  const char* ending;
  SceneData (*load)(const std::filesystem::path&, const LoadOptions&);
};

constexpr std::array<Format, 6> formats = {{{".xml", load_lit<load_mitsuba_xml>},
                                            {".gltf", load_gltf},
                                            {".glb", load_gltf},
                                            {".pbrt", load_lit<load_pbrt>},
                                            {".obj", load_obj_alone},
                                            {".ply", load_ply}}};

}  // namespace

SceneData load_scene_file(const std::filesystem::path& path, const LoadOptions& options) {
  const std::string ending = lower_case(path.extension().string());
  std::string known;
  for (const Format& format : formats) {
    if (ending == format.ending) {
      if (options.time && format.load != load_gltf) {
        throw Error(fmt::format("{}: --time {}: has no effect; it applies to .gltf and .glb",
                                path.string(), *options.time));
      }
      return format.load(path, options);
    }
    known += fmt::format("{}{}", known.empty() ? "" : ", ", format.ending);
  }
  throw Error(fmt::format("{}: unknown kind of scene file '{}'; expected one of {}", path.string(),
                          ending, known));
}

}  // namespace pt
