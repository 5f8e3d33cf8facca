// Simple shapes, added to a mesh: their triangles point outward.
#pragma once

#include <span>

#include "common/geometry/mesh.h"
#include "common/math/transform.h"

namespace pt {

/// Two triangles over the parallelogram corner + [0, 1] a + [0, 1] b, facing cross(a, b).
void add_rectangle(Mesh& mesh, const Vec3& corner, const Vec3& a, const Vec3& b);

/// Twelve triangles that share the eight corners of the cube [-1, 1]^3 as `place` maps it; with
/// `inward` they face its inside: a closed room. `place` must not mirror.
void add_box(Mesh& mesh, const Affine& place, bool inward = false);

/// A point of a profile in the half plane beside the axis of revolution, in scene units.
struct ProfilePoint {
  float radius, height;
};

/// A surface of revolution about the y axis moved to `base`: 2 `sides` triangles between each point
/// of the profile and the next, facing away from the axis where the profile rises. Where the radius
/// is zero, half of them have no area and are left out.
void add_revolution(Mesh& mesh, const Vec3& base, std::span<const ProfilePoint> profile, int sides);

}  // namespace pt
