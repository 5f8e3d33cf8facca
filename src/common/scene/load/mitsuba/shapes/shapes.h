// <shape>s to spheres, quads, meshes and instances.
#pragma once

#include "common/scene/load/mitsuba/xml/context.h"

namespace pt::mitsuba {

/// Adds a shape to group `group` of the scene; 0 is the world. Rectangles and cubes of the world
/// become quads, spheres stay spheres; textured ones, flipped or squeezed spheres and what is in
/// another group become meshes, as our quads and spheres have no texture coordinates and face
/// outward. Adding a kind of shape is adding a line to the table in shapes.cpp.
void add_shape(Context& context, const Object& shape, std::uint32_t group);

/// The number of the material of a shape's bsdf and emitter, or none where the shape is invisible.
/// What is repeated (in a group but 0) does not emit.
std::optional<std::uint32_t> material_of(Context& context, const Object& shape,
                                         std::uint32_t group);

}  // namespace pt::mitsuba
