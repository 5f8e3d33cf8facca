// Shapes to spheres and meshes, objects to groups and instances.
#pragma once

#include <functional>

#include "common/geometry/mesh.h"
#include "common/scene/load/pbrt/surfaces/surfaces.h"

namespace pt::pbrt {

struct ShapeMaterial {
  MaterialDescription material;  ///< with its opacity, and its light but for `power`
  bool invisible = false;
  bool emits = false, two_sided = false;
  float power = 0.0f;       ///< above 0: all light that leaves it, instead of its radiance
  float light_mean = 1.0f;  ///< mean luminance of the picture that it shows; power counts it

  // What it needs of a shape:
  bool textured = false;   ///< texture coordinates
  TextureMapping mapping;  ///< which these are
  bool tangents = false;   ///< and the directions in which they grow
};

/// Reads each material and each area light once.
class ShapeMaterials {
 public:
  explicit ShapeMaterials(Context& context) : context_(context) {}

  ShapeMaterial read(const ShapeEntity& shape);

 private:
  struct AreaLight {
    Emission emission;
    bool two_sided = false;
    float power = 0.0f, mean = 1.0f;
  };
  const Surface& surface_of(const ShapeEntity& shape);
  const AreaLight& light_of(const Entity& entity);
  AreaLight read_light(const Entity& entity);
  void set_media(const ShapeEntity& shape, ShapeMaterial& result);
  void add_light(const ShapeEntity& shape, ShapeMaterial& result);

  Context& context_;
  std::map<MaterialReference, Surface> surfaces_;
  std::map<const Entity*, AreaLight> lights_;
};

// Shapes to spheres and meshes, objects to groups and instances.

/// Adds all shapes and instances of the description. Whole spheres stay spheres where their
/// transformation keeps angles; all else is triangles. Adding a kind of shape is adding a line to
/// the table in shapes.cpp.
void add_shapes(Context& context);

// The kinds of shapes: each makes one of triangles in its own space.

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

// Curved surfaces, given by formulas of (u, v), as triangles.

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

// Smooth surfaces of triangles (Loop 1987, 'Smooth Subdivision Surfaces Based on Triangles').

/// Divides each triangle of the cage into four, so many times, then moves the vertices to the
/// limit surface (at the border that of its spline, where pbrt weighs neighbours by 1/5, not 1/6)
/// and gives them its normals. Creases are at the border alone. As in pbrt the normals point to the
/// side from which the cage's triangles look clockwise. Throws Error where more than two triangles
/// share an edge or two that do are wound against each other.
Mesh subdivide_loop(const Mesh& cage, int levels);

}  // namespace pt::pbrt
