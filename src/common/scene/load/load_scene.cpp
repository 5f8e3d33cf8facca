#include "common/scene/load/load_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "common/scene/data/frame_scene.h"
#include "common/scene/load/files/images/texture_store.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/meshes/vertex_colors.h"
#include "common/scene/load/files/studio.h"
#include "common/scene/load/gltf/gltf.h"
#include "common/scene/load/mitsuba/mitsuba_xml.h"
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

/// The alpha of the picture where it has one, else its luminance.
void add_opacity_map(const std::filesystem::path& map, TextureStore& textures,
                     MaterialDescription& material) {
  if (map.empty()) return;
  Texture look;
  look.format = TextureFormat::linear8;
  const std::uint32_t grey = textures.add_file(map, look), alpha = textures.add_alpha_of(grey);
  material.opacity = textured_opacity(1.0f, alpha != no_texture ? alpha : grey);
}

/// A material under its map of heights or, where its picture looks like that, of normals.
std::uint32_t add_bumped(const ObjMaterial& source, MaterialDescription material,
                         TextureStore& textures, SceneData& scene) {
  if (source.bump_map.empty()) return scene.add_material(material);
  Texture look;
  look.format = TextureFormat::linear8;
  const std::uint32_t map = textures.add_file(source.bump_map, look);
  const bool normals = textures.is_normal_map(map);
  MaterialDescription bumped =
      make_mapped(normals ? MaterialNode::gltf_normal_map : MaterialNode::bump_map,
                  {{source.bump_scale, 0.0f, 0.0f}, map}, 0);
  std::swap(bumped.emission, material.emission);
  std::swap(bumped.opacity, material.opacity);
  bumped.children[0] = bumped.children[1] = scene.add_material(material);
  return scene.add_material(bumped);
}

std::uint32_t add_obj_material(const ObjMaterial& source, TextureStore& textures,
                               SceneData& scene) {
  const auto add = [&](const std::filesystem::path& map) {
    return map.empty() ? no_texture : textures.add_file(map);
  };
  MaterialDescription material = source.material;
  material.parameters[color_parameter].texture = add(source.albedo_map);
  if (material.kind == kind_of<Phong>)
    material.parameters[Phong::Index::specular].texture = add(source.specular_map);
  material.emission.texture = add(source.emission_map);
  add_opacity_map(source.opacity_map, textures, material);
  return add_bumped(source, material, textures, scene);
}

SceneData load_obj(const std::filesystem::path& path, const LoadOptions& options) {
  SceneData scene;
  ObjFile file = read_obj_with_materials(path);
  for (const std::string& warning : file.warnings) options.report(warning);
  TextureStore textures(scene.textures, scene.texels);
  std::vector<std::uint32_t> numbers;
  for (const ObjMaterial& material : file.materials) {
    numbers.push_back(add_obj_material(material, textures, scene));
    if (!material.name.empty()) scene.names.materials[numbers.back()] = material.name;
  }
  scene.meshes = std::move(file.meshes);
  VertexColors colors(scene, options);
  for (Mesh& mesh : scene.meshes) {
    mesh.material = numbers[mesh.material];
    colors.tint(mesh, false, path.string());
  }
  colors.finish();
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
                                            {".obj", load_obj},
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
