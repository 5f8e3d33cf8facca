// A scene in memory, owned: what the built-in scenes and loaders fill in.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/instance.h"
#include "common/geometry/mesh.h"
#include "common/math/transform.h"
#include "common/render/options.h"
#include "common/scene/scene.h"

namespace pt {

/// A light without extent.
struct DeltaLight {
  enum class Kind : std::uint32_t { point, spot, directional } kind = Kind::point;
  Vec3 position{0.0f};       ///< point, spot: world space
  Vec3 direction{0, 0, -1};  ///< spot, directional: the way the light goes, unit length
  Color intensity{1.0f};     ///< point, spot: W / sr; directional: irradiance across the rays
  float cos_inner = 1.0f;    ///< spot: full intensity within this angle,
  float cos_outer = -1.0f;   ///< none beyond this one, in between as the format asks
};

/// Light from infinitely far: a picture of all directions, latitude by longitude.
struct EnvironmentData {
  int width = 0, height = 0;  ///< 0: none
  std::vector<Color> pixels;  ///< radiance; row 0 is the zenith (+y before to_world), the middle
                              ///< column is the direction -z, u grows towards +x
  Affine to_world;            ///< a rotation
};

/// What a scene file asks for where the command line does not.
struct SceneDefaults {
  std::optional<int> width, height, spp, max_depth, rr_depth;
};

struct SceneData {
  std::string name;
  SceneDefaults defaults;
  CameraParameters camera;
  Sky sky;
  EnvironmentData environment;  ///< besides the sky, whose radiance it adds to
  std::vector<DeltaLight> delta_lights;
  std::vector<Sphere> spheres;
  std::vector<Quad> quads;
  std::vector<Mesh> meshes;         ///< those of group 0 in world space
  std::vector<Instance> instances;  ///< of the other groups
  std::vector<Material> materials;
  std::vector<MaterialTextures> material_textures = {{}};  ///< 0: none
  std::vector<Texture> textures;
  std::vector<std::byte> texels;                              ///< of all textures
  std::vector<std::uint32_t> sphere_material, quad_material;  ///< by sphere, by quad
  // Made from the above by prepare_scene():
  Accel accel = Accel::brute;
  std::vector<Bvh2Node> bvh_nodes;         ///< empty with Accel::brute
  std::vector<std::uint32_t> material_of;  ///< by primitive
  std::vector<std::uint32_t> lights;       ///< primitives that emit
  std::vector<Sphere> scan_spheres;        ///< Primitives::scan
  Vec3 scan_center = Vec3(0.0f);

  std::size_t primitive_count() const { return spheres.size() + quads.size(); }
  SceneTraits traits() const { return {accel, !lights.empty()}; }

  std::uint32_t add_material(const Material& material);
  void add_sphere(const Vec3& center, float radius, std::uint32_t material);
  void add_quad(const Vec3& corner, const Vec3& a, const Vec3& b, std::uint32_t material);
};

/// Applies the options' camera overrides and acceleration structure: checks the camera, builds the
/// structure (which reorders the primitives), lists the lights. Throws Error for a camera or a
/// scene that cannot be rendered.
void prepare_scene(SceneData& scene, const Options& options);

/// A view of `scene` in host memory, valid while `scene` is neither changed nor destroyed.
Scene host_view(const SceneData& scene, int width, int height);

}  // namespace pt
