// Smooth surfaces of triangles (Loop 1987, 'Smooth Subdivision Surfaces Based on Triangles').
#pragma once

#include "common/geometry/mesh.h"

namespace pt::pbrt {

/// Divides each triangle of the cage into four, so many times, then moves the vertices to the
/// limit surface (at the border that of its spline, where pbrt weighs neighbours by 1/5, not 1/6)
/// and gives them its normals. Creases are at the border alone. As in pbrt the normals point to the
/// side from which the cage's triangles look clockwise. Throws Error where more than two triangles
/// share an edge or two that do are wound against each other.
Mesh subdivide_loop(const Mesh& cage, int levels);

}  // namespace pt::pbrt
