// Simple shapes. The triangles of meshes point outward.
#pragma once

#include <span>

#include "common/geometry/mesh.h"
#include "common/math/transform.h"
#include "common/scene/data/scene_data.h"

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

/// A box of six quads whose normals point outward (or inward), turned about the y axis.
void add_quad_box(SceneData& scene, const Vec3& center, const Vec3& size, float turn_degrees,
                  std::uint32_t material, bool inward = false);

}  // namespace pt
