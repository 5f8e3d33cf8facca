// Curved shapes as triangles, in their own space, with normals and texture coordinates.
//
// (u, v) are Mitsuba's but for v, which Mesh counts from the image's foot. Triangles are
// counterclockwise seen from where the normals point.
#pragma once

#include "common/geometry/mesh.h"

namespace pt::mitsuba {

inline constexpr int circle_segments = 256;    ///< a chord is within 7.5e-5 radii of its arc
inline constexpr int meridian_segments = 128;  ///< of a sphere, pole to pole

/// The unit sphere around the origin.
Mesh tessellate_sphere();

/// The unit disk in the plane z = 0, facing +z; u is the radius, v the angle. Along v it is the
/// longer the farther from the centre, which triangles have for constant: where shading asks for
/// that, each of this many rings is 5 % narrower than the one around it.
Mesh tessellate_disk(int rings = 1);
inline constexpr int disk_rings = 64;

/// The side of the cylinder of radius 1 around z, 0 <= z <= 1, facing outward.
Mesh tessellate_cylinder();

/// The square [-1, 1]^2 in the plane z = 0, facing +z.
Mesh tessellate_rectangle();

/// The cube [-1, 1]^3, facing outward; every face shows a texture once.
Mesh tessellate_cube();

}  // namespace pt::mitsuba
