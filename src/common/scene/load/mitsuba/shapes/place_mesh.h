// Moves a mesh as a Mitsuba shape asks for.
#pragma once

#include "common/geometry/mesh.h"
#include "common/math/transform.h"

namespace pt::mitsuba {

/// Applies `to_world`, adds normals where there are none unless `face_normals`, turns the surface
/// inside out where `flip_normals`. Then winds each triangle so that its geometric normal is on
/// the side of its vertices' normals: in Mitsuba these decide on which side a surface emits, also
/// where a mirroring transform has turned the winding alone.
void place_mesh(Mesh& mesh, const Affine& to_world, bool face_normals, bool flip_normals);

}  // namespace pt::mitsuba
