// The kinds of shapes: each makes one of triangles in its own space.
#pragma once

#include "common/scene/load/pbrt/shapes/shape_material.h"

namespace pt::pbrt {

/// Their normals point to where pbrt's do, before ReverseOrientation; without normals, by their
/// winding. Only what `material` needs is fine: see tessellate.h.
using MeshReader = Mesh (*)(Context&, const Entity&, const ShapeMaterial&);

Mesh read_triangle_mesh(Context& context, const Entity& entity, const ShapeMaterial& material);
Mesh read_ply_mesh(Context& context, const Entity& entity, const ShapeMaterial& material);
Mesh read_bilinear_mesh(Context& context, const Entity& entity, const ShapeMaterial& material);
Mesh read_loop_mesh(Context& context, const Entity& entity, const ShapeMaterial& material);
Mesh read_sphere(Context& context, const Entity& entity, const ShapeMaterial& material);
Mesh read_disk(Context& context, const Entity& entity, const ShapeMaterial& material);
Mesh read_cylinder(Context& context, const Entity& entity, const ShapeMaterial& material);
Mesh read_curve(Context& context, const Entity& entity, const ShapeMaterial& material);

/// The radius of a whole sphere, or none of one that is cut.
std::optional<float> whole_sphere(const Entity& entity);

}  // namespace pt::pbrt
