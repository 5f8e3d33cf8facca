// Shapes to spheres and meshes, objects to groups and instances.
#pragma once

#include "common/scene/load/pbrt/shapes/shape_material.h"

namespace pt::pbrt {

/// Adds all shapes and instances of the description. Whole spheres stay spheres where their
/// transformation keeps angles; all else is triangles. Adding a kind of shape is adding a line to
/// the table in shapes.cpp.
void add_shapes(Context& context);

}  // namespace pt::pbrt
