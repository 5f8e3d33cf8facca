// The module ptexp._ptexp: what Python is given of the program. python/ptexp makes it what a user
// sees.
#include "python/module.h"

#include <system_error>

#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/error/terminal.h"
#include "python/unlocked.h"

namespace pt::python {

namespace nb = nanobind;

namespace {

/// By its message: ptexp.Error or ptexp.OptionError.
void set_error(const std::exception& error) {
  const nb::object made =
      nb::module_::import_("ptexp._errors").attr("error_of")(text(message_line(message_of(error))));
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(made.ptr())), made.ptr());
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
