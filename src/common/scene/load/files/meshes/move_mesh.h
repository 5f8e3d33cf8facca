// Meshes into other spaces, and inside out.
#pragma once

#include <optional>

#include "common/geometry/mesh.h"
#include "common/math/transform.h"

namespace pt {

/// Positions and normals; the winding stays as it is.
void transform_mesh(Mesh& mesh, const Affine& map);

/// Turns normals and winding.
void turn_mesh(Mesh& mesh);

/// Winds each triangle so that its geometric normal is on the side of its vertices' normals.
void wind_by_normals(Mesh& mesh);

/// The other side of a lamp that shines on both: a surface of its own, a little behind the first.
Mesh back_of(const Mesh& mesh);

/// The scale of a map that keeps angles, or none.
std::optional<float> uniform_scale(const Affine& map);

}  // namespace pt
