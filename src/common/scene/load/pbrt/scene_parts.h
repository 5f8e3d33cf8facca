// What makes a scene of a description: view, lights, media, shapes.
#pragma once

#include <functional>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/image/image.h"
#include "common/math/vec.h"
#include "common/scene/data/volume_data.h"
#include "common/scene/load/pbrt/surfaces/surfaces.h"
#include "common/scene/load/pbrt/surfaces/textures.h"
#include "common/scene/load/pbrt/syntax/context.h"
#include "common/scene/load/pbrt/syntax/description.h"
#include "common/scene/load/pbrt/syntax/parameters.h"

namespace pt::pbrt {

/// Before lights and shapes, as the film's imaging ratio multiplies all light. Without a camera the
/// scene's is left as it is.
void read_view(Context& context);

// Lights that are not on a shape.

/// A picture of all directions.
struct SkyPicture {
  Image image;
  bool is_equal_area = true;  ///< else by longitude and latitude, as earlier versions have it
  Affine to_light;
  Color scale = Color(1.0f);

  /// The radiance from a direction in the light's space, without the scale.
  Color at(const Vec3& direction) const;
};

/// Adds point, spot, distant and infinite lights to the scene; others are reported. Adding a kind
/// is adding a line to the table in lights.cpp.
void add_lights(Context& context);

/// Infinite lights. Their constants and pictures add up; what they sum to is one map.
class SkyLights {
 public:
  void add(Context& context, const Entity& entity);
  void store(SceneData& scene) const;

 private:
  std::vector<SkyPicture> pictures_;
};

/// A spot whose transformation does not keep angles: its cone is one of its own space, not of the
/// world. A picture of its share of the intensity is what such a spot throws. `cone` is that of the
/// light's space, by its cosines, about `axis`.
void stretch_spot(Context& context, const Entity& entity, const Vec3& axis, DeltaLight& light);

/// `scale` of a light, times the film's imaging ratio. A colour in pbrt-v3.
Color read_light_scale(Context& context, const Parameters& parameters);

/// The file of a light's picture: 'filename', or 'mapname' in pbrt-v3. Null: it has none.
const Parameter* find_picture(const Parameters& parameters);

// Media: named ones to ours, which lie on the sides of a shape, and what their kinds share.

/// The scene's number of the medium of this name, which is made once; no_medium for an empty name
/// and for a medium that is not supported, which is reported. Throws Error, with `place`, for a
/// name that no MakeNamedMedium defines. Adding a kind is adding a line to the table in media.cpp.
std::uint16_t medium_named(Context& context, const std::string& name, const FileLocation& place);

/// What a shape has on its sides. Where both are the same, it keeps the medium of its surroundings.
MediumBoundary media_of(Context& context, const ShapeEntity& shape);

// The kinds of media: each reads one, and adds the grids that it needs to the scene.

Medium read_homogeneous(Context& context, const Entity& entity);
Medium read_uniform_grid(Context& context, const Entity& entity);
Medium read_rgb_grid(Context& context, const Entity& entity);
Medium read_cloud(Context& context, const Entity& entity);
Medium read_nanovdb_grids(Context& context, const Entity& entity);

/// Extinction and albedo by sigma_a and sigma_s (both 1 unless they are given) times `scale`, and
/// the phase function by g.
Medium read_coefficients(Context& context, const Parameters& parameters, float scale);

/// By g, of which 0 is isotropic.
void read_phase(const Parameters& parameters, Medium& medium);

/// A factor, which must be finite and not negative.
float read_factor(const Parameters& parameters, std::string_view name, float fallback);

/// sigma_s of what has these coefficients, over their sum; 0 where there is nothing.
Color albedo_of(const Color& absorption, const Color& scattering);

// A box of regular samples, as pbrt's grids have them.

/// p0 to p1 in the space of a medium, filled with voxels; a sample lies in the middle of each.
struct SampleBox {
  std::uint32_t size[3] = {1, 1, 1};
  Vec3 low, high;   ///< in the medium's space
  Affine to_world;  ///< of the medium's space

  std::size_t voxels() const { return std::size_t{size[0]} * size[1] * size[2]; }

  /// The middle of a voxel, in the medium's space.
  Vec3 center(std::uint32_t i, std::uint32_t j, std::uint32_t k) const;
};

/// The place of the medium's samples, of which there is one. Throws Error for a box without volume.
SampleBox read_box(const Entity& entity);

/// The same with nx * ny * nz samples.
SampleBox read_sample_box(const Entity& entity);

/// The values of colours side by side, or with one channel their reds.
std::vector<float> channels_of(const std::vector<Color>& colors, std::uint32_t channels);

/// For all channels of a voxel, x fastest: how pbrt looks samples up. Beyond the outermost of them
/// they fade to zero, which a layer of zeros around the box says.
VolumeData faded_volume(const SampleBox& box, std::uint32_t channels,
                        const std::vector<float>& values);

/// The same, but the outermost samples go on beyond the box.
VolumeData plain_volume(const SampleBox& box, std::uint32_t channels, std::vector<float> values);

// The density of a cloud, as that of pbrt.

/// Gradient noise with cells of size 1: Perlin 2002, 'Improving Noise', with the directions in
/// which pbrt's slopes go. Zero at integers.
float perlin_noise(const Vec3& p);

struct CloudShape {
  float density = 1.0f, wispiness = 1.0f, frequency = 5.0f;
};

/// In [0, 1]: more the lower, and nothing but noise above y = 1/2.
float cloud_density(const CloudShape& shape, const Vec3& p);

// Shapes to spheres and meshes, objects to groups and instances.

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

inline constexpr int disk_rings = 32;   ///< where it is textured
inline constexpr int patch_cells = 16;  ///< of a bilinear patch, along u and along v
inline constexpr int curve_steps = 4;   ///< along a segment of a curve
inline constexpr int curve_sides = 8;   ///< around it

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
