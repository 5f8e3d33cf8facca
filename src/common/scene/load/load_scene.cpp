#include "common/scene/load/load_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "common/scene/data/frame_scene.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/meshes/vertex_colors.h"
#include "common/scene/load/files/studio.h"
#include "common/scene/load/gltf/gltf.h"
#include "common/scene/load/mitsuba/mitsuba_xml.h"
#include "common/scene/load/obj/obj_scene.h"
#include "common/scene/load/pbrt/pbrt.h"

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
  const bool is_lit = has_light(scene);
  if (!is_lit) add_studio(scene);
  if (options.warn) {
    options.warn(fmt::format("{}: the format has no camera: one that frames the scene is used{}{}",
                             path.string(),
                             is_lit ? "" : ", and no light: ", is_lit ? "" : studio_text));
  }
}

SceneData load_ply(const std::filesystem::path& path, const LoadOptions& options) {
  SceneData scene;
  Mesh mesh = read_ply(path);
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

struct Format {
  const char* ending;
  SceneData (*load)(const std::filesystem::path&, const LoadOptions&);
};

constexpr std::array<Format, 6> formats = {{{".xml", load_mitsuba_xml},
                                            {".gltf", load_gltf},
                                            {".glb", load_gltf},
                                            {".pbrt", load_pbrt},
                                            {".obj", load_obj_alone},
                                            {".ply", load_ply}}};

}  // namespace

SceneData load_scene_file(const std::filesystem::path& path, const LoadOptions& options) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::string known;
  for (const Format& format : formats) {
    if (ending == format.ending) return format.load(path, options);
    known += fmt::format("{}{}", known.empty() ? "" : ", ", format.ending);
  }
  throw Error(fmt::format("{}: unknown kind of scene file '{}'; expected one of {}", path.string(),
                          ending, known));
}

}  // namespace pt
