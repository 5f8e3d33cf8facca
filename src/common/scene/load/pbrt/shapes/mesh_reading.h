// What shapes of given vertices share.
#pragma once

#include "common/scene/load/pbrt/shapes/shape_kinds.h"

namespace pt::pbrt {

/// Indices in groups of this size; without any, one group of the vertices in their order.
std::vector<int> read_indices(Context& context, const Parameters& parameters, std::size_t size,
                              std::size_t vertices);

/// Positions, and normals and texture coordinates where they are given.
Mesh read_vertices(Context& context, const Parameters& parameters);

/// As mesh_files.h promises; an Error has the place of the shape.
void finish(const Entity& entity, Mesh& mesh);

}  // namespace pt::pbrt
