// What each part of the module adds to it.
#pragma once

#include <nanobind/nanobind.h>

namespace pt::python {

void add_errors(nanobind::module_& m);
void add_tables(nanobind::module_& m);
void add_image(nanobind::module_& m);
void add_scene(nanobind::module_& m);
void add_from_dict(nanobind::module_& m);
void add_trace(nanobind::module_& m);
void add_compare(nanobind::module_& m);

}  // namespace pt::python
