// The module ptexp._ptexp: what Python gets of the program; python/ptexp turns it into the package
// that users see. Tables of options, scenes and devices.
#include "python/module.h"

#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <system_error>

#include "app/options/option_list.h"
#include "common/device/devices.h"
#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/error/terminal.h"
#include "common/options/option_names.h"
#include "common/platform/build_info.h"
#include "common/scene/builtin/builtin_scenes.h"
#include "python/unlocked.h"

namespace pt::python {

namespace nb = nanobind;

namespace {

/// By its message: ptexp.Error or ptexp.OptionError. Runs no Python code: if the interpreter ended
/// the thread there, no handler could stop that, since another exception is being handled.
void set_error(const std::exception& error) {
  const std::string message = message_line(message_of(error));
  const nb::object type = nb::module_::import_("ptexp._errors")
                              .attr(message.starts_with("--") ? "OptionError" : "Error");
  PyErr_SetObject(type.ptr(), text(message).ptr());
}

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
    option["group"] = heading(entry.group);
    option["help"] = entry.help;
    option["is_of_one_render"] = is_of_one_render(entry);
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

nb::str text(const std::string& bytes) {
  return nb::steal<nb::str>(PyUnicode_DecodeUTF8(
      bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "backslashreplace"));
}

/// pt::Error becomes ptexp.Error or ptexp.OptionError; memory that is too little, a MemoryError.
void add_errors(nb::module_&) {
  nb::register_exception_translator([](const std::exception_ptr& problem, void*) {
    try {
      std::rethrow_exception(problem);
    } catch (const Error& error) {
      set_error(error);
    } catch (const std::system_error& error) {  // no thread, a folder that cannot be read
      set_error(error);
    } catch (const std::length_error& error) {  // of a vector
      PyErr_SetString(PyExc_MemoryError, message_of(error).c_str());
    }
  });
}

void add_tables(nb::module_& m) {
  m.def("options", options, "The table of options: a dictionary each.");
  m.def("scenes", scenes, "Built-in scenes: (name, parameter, description).");
  m.def("devices", devices, "Devices of this machine: (name for device=, model, details).");
  m.def("build_info", build, "What the module was built from.");
}

}  // namespace pt::python

NB_MODULE(_ptexp, m) {
  using namespace pt::python;
  m.doc() = "What ptexp is made of in C++; use the package ptexp.";
  add_errors(m);
  add_end(m);
  add_tables(m);
  add_image(m);
  add_scene(m);
  add_from_dict(m);
  add_trace(m);
  add_compare(m);
}
