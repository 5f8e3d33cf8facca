// Scenes from dictionaries, which python/ptexp/_dict.py turns into elements of a Mitsuba file.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <cstring>
#include <optional>

#include "app/terminal/warning_limit.h"
#include "common/rays/ray_file.h"
#include "common/scene/load/files/images/image_files.h"
#include "common/scene/load/load_scene.h"
#include "common/scene/load/mitsuba/scene_parts.h"
#include "common/scene/load/mitsuba/xml/elements.h"
#include "python/arrays.h"
#include "python/module.h"
#include "python/scene_object.h"
#include "python/unlocked.h"

namespace pt::python {
namespace {

namespace nb = nanobind;
using mitsuba::Element;

/// (tag, attributes, children, place)
Element element_of(const nb::handle& given, int depth) {
  const auto parts = nb::cast<nb::tuple>(given);
  Element element;
  element.tag = nb::cast<std::string>(parts[0]);
  if (depth > 64) throw Error("the scene: dictionaries are nested deeper than 64");
  for (const nb::handle pair : nb::cast<nb::list>(parts[1]))
    element.attributes.push_back(nb::cast<std::pair<std::string, std::string>>(pair));
  for (const nb::handle child : nb::cast<nb::list>(parts[2]))
    element.children.push_back(element_of(child, depth + 1));
  element.file = std::make_shared<const std::filesystem::path>(nb::cast<std::string>(parts[3]));
  return element;
}

Mesh mesh_of_parts(const std::string& name, const FloatsIn& vertices, const IndicesIn& triangles,
                   const std::optional<FloatsIn>& normals, const std::optional<FloatsIn>& uvs) {
  Mesh mesh = mesh_of(vertices, triangles);
  check_trace_mesh(mesh, name);
  if (normals) mesh.normals = rows_of<Vec3>(*normals, 3, "normals");
  if (uvs) mesh.uvs = rows_of<Vec2>(*uvs, 2, "uvs");
  const auto check = [&](const char* what, std::size_t count) {
    if (count == 0 || count == mesh.positions.size()) return;
    throw Error(fmt::format("{}: {} {} for {} vertices; expected one each", name, count, what,
                            mesh.positions.size()));
  };
  check("normals", mesh.normals.size()), check("uvs", mesh.uvs.size());
  return mesh;
}

template <class T>
using ArrayIn = nb::ndarray<const T, nb::c_contig, nb::device::cpu>;

/// (height, width, 3): bytes as a file of 8 bits has them, or linear floats.
TextureImage picture_of(const nb::handle& array) {
  TextureImage picture;
  const auto set_size = [&](const auto& a) {
    picture.height = static_cast<std::uint32_t>(a.shape(0));
    picture.width = static_cast<std::uint32_t>(a.shape(1));
  };
  if (ArrayIn<std::uint8_t> bytes; nb::try_cast(array, bytes, false)) {
    set_size(bytes);
    picture.texels.resize(bytes.size() / 3 * 4, std::byte{255});
    for (std::size_t i = 0; i < bytes.size(); ++i)
      picture.texels[i / 3 * 4 + i % 3] = std::byte{bytes.data()[i]};
    return picture;
  }
  const auto floats = nb::cast<ArrayIn<float>>(array);
  set_size(floats);
  picture.format = TextureFormat::rgb32f;
  picture.texels.resize(floats.size() * sizeof(float));
  std::memcpy(picture.texels.data(), floats.data(), picture.texels.size());
  return picture;
}

/// (z, y, x, channels)
VolumeData grid_of(const nb::handle& array) {
  const auto floats = nb::cast<ArrayIn<float>>(array);
  VolumeData grid;
  for (std::size_t i = 0; i < 3; ++i)
    grid.size[i] = static_cast<std::uint32_t>(floats.shape(2 - i));
  grid.channels = static_cast<std::uint32_t>(floats.shape(3));
  grid.values.assign(floats.data(), floats.data() + floats.size());
  return grid;
}

/// The options of loading among those of a render.
LoadOptions load_options_of(const Words& words, WarningLimit& limit) {
  const Options options = command_of(words).options;
  if (options.time) throw Error("--time: applies to .gltf and .glb files, which ptexp.load reads");
  return {options.definitions,      options.strict, limit.function(), {},
          options.default_lighting, options.camera, options.volume};
}

template <class Load>
std::unique_ptr<SceneObject> load_unlocked(Warnings& warnings, const Load& load) {
  std::unique_ptr<SceneObject> made;
  {
    const Unlocked unlocked;
    made = std::make_unique<SceneObject>(load());
  }
  warnings.give();
  return made;
}

std::unique_ptr<SceneObject> load_text(const std::string& text, const Words& words) {
  Warnings warnings;
  WarningLimit limit(warnings.collector());
  const LoadOptions options = load_options_of(words, limit);
  return load_unlocked(warnings, [&] { return load_mitsuba_text(text, options); });
}

/// `meshes`: (name, vertices, triangles, normals or None, uvs or None) each; `pictures` and
/// `grids`: (name, array) each.
std::unique_ptr<SceneObject> from_elements(const nb::tuple& root, const nb::list& meshes,
                                           const nb::list& pictures, const nb::list& grids,
                                           const std::string& name, const Words& words) {
  Warnings warnings;
  WarningLimit limit(warnings.collector());
  LoadOptions options = load_options_of(words, limit);
  for (const nb::handle one : pictures)
    options.images[nb::cast<std::string>(one[0])] =
        std::make_shared<const TextureImage>(picture_of(one[1]));
  for (const nb::handle one : grids)
    options.volumes[nb::cast<std::string>(one[0])] = grid_of(one[1]);
  for (const nb::handle entry : meshes) {
    const auto parts = nb::cast<nb::tuple>(entry);
    const auto key = nb::cast<std::string>(parts[0]);
    options.meshes[key] = mesh_of_parts(
        key, nb::cast<FloatsIn>(parts[1]), nb::cast<IndicesIn>(parts[2]),
        nb::cast<std::optional<FloatsIn>>(parts[3]), nb::cast<std::optional<FloatsIn>>(parts[4]));
  }
  const Element scene = element_of(root, 0);
  return load_unlocked(warnings, [&] { return load_mitsuba_scene(scene, name, options); });
}

}  // namespace

void add_from_dict(nb::module_& m) {
  m.def("from_elements", from_elements);
  m.def("load_text", load_text, nb::arg("text"), nb::arg("words"));
  m.def("plugin_types", mitsuba::plugin_types);
}

}  // namespace pt::python
