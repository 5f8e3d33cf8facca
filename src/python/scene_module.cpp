// Scene in Python.
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include "common/image/codecs/image_io.h"
#include "python/module.h"
#include "python/scene_object.h"

namespace pt::python {
namespace {

namespace nb = nanobind;

/// (name, shape) of each.
nb::list parameters(const SceneObject& self) {
  nb::list list;
  for (const SceneParameter& p : self.parameters()) {
    nb::list shape;
    for (const std::size_t n : p.shape) shape.append(n);
    list.append(nb::make_tuple(text(p.name), nb::tuple(shape)));
  }
  return list;
}

nb::list plan(SceneObject& self, const Words& words) {
  nb::list list;
  for (const Decision& d : self.plan(words)) {
    nb::dict decision;
    decision["option"] = text(d.option);
    decision["value"] = text(d.value);
    decision["reason"] = text(d.reason);
    list.append(decision);
  }
  return list;
}

nb::dict defaults(const SceneObject& self) {
  nb::dict result;
  self.report_defaults(result);
  return result;
}

}  // namespace

void add_scene(nb::module_& m) {
  nb::class_<SceneObject>(m, "Scene")
      .def("render", &SceneObject::render, nb::arg("words"), nb::arg("progress").none(),
           nb::arg("on_device"))
      .def("plan", plan)
      .def_prop_ro("name", [](const SceneObject& self) { return text(self.name()); })
      .def("defaults", defaults)
      .def("parameters", parameters)
      .def("get", &SceneObject::get)
      .def("set", &SceneObject::set);
  m.def("load", &SceneObject::load, nb::arg("words"));
  m.def("check_output", check_image_path);  // before any work
}

}  // namespace pt::python
