// The parts of the module, each of which adds its functions and classes.
#pragma once

#include <nanobind/nanobind.h>

#include <string>

namespace pt::python {

/// Text for Python of bytes that need not be UTF-8; invalid bytes become \xNN.
nanobind::str text(const std::string& bytes);

void add_errors(nanobind::module_& m);
void add_tables(nanobind::module_& m);
void add_image(nanobind::module_& m);
void add_scene(nanobind::module_& m);
void add_from_dict(nanobind::module_& m);
void add_trace(nanobind::module_& m);
void add_compare(nanobind::module_& m);

}  // namespace pt::python
