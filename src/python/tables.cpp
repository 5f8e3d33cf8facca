// Options, scenes, devices, the build: plain tables.
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "app/options/option_list.h"
#include "common/device/devices.h"
#include "common/options/option_names.h"
#include "common/platform/build_info.h"
#include "common/scene/builtin/builtin_scenes.h"
#include "python/module.h"

namespace pt::python {
namespace {

namespace nb = nanobind;

const char* name_of(OptionForm form) {
  constexpr const char* names[] = {"text", "number", "vector", "list", "flag"};
  return names[static_cast<int>(form)];
}

nb::list options() {
  nb::list list;
  for (const OptionEntry& entry : option_list()) {
    nb::dict option;
    option["keyword"] = option_key(entry);
    option["name"] = entry.name;
    option["form"] = name_of(entry.form);
    option["placeholder"] = entry.placeholder;
    option["group"] = entry.group;
    option["help"] = entry.help;
    option["default"] = entry.text(Options());
    list.append(option);
  }
  return list;
}

nb::list scenes() {
  nb::list list;
  for (const SceneInfo& scene : scene_list())
    list.append(nb::make_tuple(scene.name, scene.parameter, scene.description));
  return list;
}

nb::list devices() {
  nb::list list;
  for (const DeviceInfo& device : list_devices())
    list.append(nb::make_tuple(to_string(device.choice), device.name, device.detail));
  return list;
}

nb::dict build() {
  const BuildInfo& info = build_info();
  nb::dict result;
  result["version"] = info.version;
  result["commit"] = info.commit;
  result["build_type"] = info.build_type;
  result["compiler"] = info.compiler;
  result["cuda"] = info.cuda;
  result["fast_math"] = info.fast_math;
  return result;
}

}  // namespace

void add_tables(nb::module_& m) {
  m.def("options", options, "The table of options: a dictionary each.");
  m.def("scenes", scenes, "Built-in scenes: (name, parameter, description).");
  m.def("devices", devices, "Devices of this machine: (name for device=, model, details).");
  m.def("build_info", build, "What the module was built from.");
}

}  // namespace pt::python
