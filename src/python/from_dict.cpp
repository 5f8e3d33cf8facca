// Scenes from dictionaries, which python/ptexp/_dict.py turns into elements of a Mitsuba file.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <optional>

#include "app/terminal/warning_limit.h"
#include "common/rays/ray_file.h"
#include "common/scene/load/load_scene.h"
#include "common/scene/load/mitsuba/surfaces/surfaces.h"
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

/// `meshes`: (name, vertices, triangles, normals or None, uvs or None) each.
std::unique_ptr<SceneObject> from_elements(const nb::tuple& root, const nb::list& meshes,
                                           const std::string& name, bool strict) {
  Warnings warnings;
  LoadOptions options;
  options.strict = strict;
  WarningLimit limit(warnings.collector());
  options.warn = limit.function();
  for (const nb::handle entry : meshes) {
    const auto parts = nb::cast<nb::tuple>(entry);
    const auto key = nb::cast<std::string>(parts[0]);
    options.meshes[key] = mesh_of_parts(
        key, nb::cast<FloatsIn>(parts[1]), nb::cast<IndicesIn>(parts[2]),
        nb::cast<std::optional<FloatsIn>>(parts[3]), nb::cast<std::optional<FloatsIn>>(parts[4]));
  }
  const Element scene = element_of(root, 0);
  std::unique_ptr<SceneObject> made;
  {
    const Unlocked unlocked;
    made = std::make_unique<SceneObject>(load_mitsuba_scene(scene, name, options));
  }
  warnings.give();
  return made;
}

}  // namespace

void add_from_dict(nb::module_& m) {
  m.def("from_elements", from_elements);
  m.def("surface_types", mitsuba::surface_types);
}

}  // namespace pt::python
