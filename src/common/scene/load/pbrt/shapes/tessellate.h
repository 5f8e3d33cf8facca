// Curved surfaces, given by formulas of (u, v), as triangles.
#pragma once

#include <functional>

#include "common/geometry/mesh.h"

namespace pt::pbrt {

inline constexpr int circle_segments = 256;    ///< a chord is within 7.5e-5 radii of its arc
inline constexpr int meridian_segments = 128;  ///< of a sphere, pole to pole
inline constexpr int disk_rings = 32;          ///< where it is textured
inline constexpr int patch_cells = 16;         ///< of a bilinear patch, along u and along v
inline constexpr int curve_steps = 4;          ///< along a segment of a curve
inline constexpr int curve_sides = 8;          ///< around it

struct SurfacePoint {
  Vec3 position, normal;  ///< the normal has unit length
};

/// Appends columns x rows cells over the unit square, wound by their normals; triangles that a pole
/// makes points or lines are left out.
void tessellate(Mesh& mesh, int columns, int rows,
                const std::function<SurfacePoint(float u, float v)>& surface);

}  // namespace pt::pbrt
