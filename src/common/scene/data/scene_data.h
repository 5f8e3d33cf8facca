// A scene in memory, owned: filled in by built-in scenes and loaders.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/accel/build/triangle_tree_data.h"
#include "common/geometry/bounds.h"
#include "common/geometry/mesh.h"
#include "common/light/light.h"
#include "common/light/light_tree.h"
#include "common/math/transform.h"
#include "common/options/options.h"
#include "common/plan/render_properties.h"
#include "common/scene/data/material_description.h"
#include "common/scene/data/motion_data.h"
#include "common/scene/data/scene.h"

namespace pt {

/// Light from infinitely far: a picture of all directions, latitude by longitude.
struct EnvironmentData {
  int width = 0, height = 0;  ///< 0: none
  std::vector<Color>
      pixels;  ///< radiance, W / (m^2 sr), in the order of environment.h: row 0 is the zenith (+y
               ///< before to_world), the middle of a row -z, u grows towards +x
  Affine to_world;  ///< a rotation
};

/// Options in a scene file; the command line overrides them.
struct SceneDefaults {
  std::optional<int> width, height, spp, max_depth, rr_depth;
  std::optional<CropWindow> crop;
  std::optional<FilterChoice> filter;
  /// The file's radiance is unrelated to a display's white: photometric units, or default lighting.
  bool measure_exposure = false;
};

/// Names in files; parts without a name are missing.
struct SceneNames {
  std::map<std::uint32_t, std::string> materials;     ///< by material
  std::map<std::uint32_t, std::string> emitters;      ///< emitters, by their material
  std::map<std::uint32_t, std::string> delta_lights;  ///< by its index
  std::map<std::uint32_t, std::string> meshes;        ///< by mesh
};

/// What of a scene has changed since it was prepared. Each asks for another part of the preparation
/// (resolve_changes and prepare_changes, prepare_scene.h).
struct SceneChanges {
  bool camera = false;
  bool shading = false;    ///< parameters of materials and lights
  bool lights = false;     ///< with shading: emission, or what a mask leaves of it
  bool instances = false;  ///< their transforms
  bool vertices = false;   ///< positions of meshes, which keep their triangles
  bool normals = false;    ///< of the vertices of meshes that have some

  bool operator==(const SceneChanges&) const = default;
  bool any() const { return *this != SceneChanges(); }
  bool any_but_camera() const { return shading || lights || instances || vertices || normals; }
  bool move_surfaces() const { return instances || vertices; }
  void add(const SceneChanges& more) {
    camera |= more.camera, shading |= more.shading, lights |= more.lights;
    instances |= more.instances, vertices |= more.vertices, normals |= more.normals;
  }
};

/// The memory behind a LightSelector and a LightMap.
struct LightListData {
  std::vector<Light> lights;
  std::vector<AliasEntry> selection;
  LightTreeData tree;                               ///< empty unless lights are chosen by it
  std::uint32_t sun = 0;                            ///< its index
  std::uint32_t table_first = 0;                    ///< see LightSelector
  std::vector<std::uint32_t> first, rank, spheres;  ///< see LightMap
  std::vector<MovingLight> moving;  ///< see Motion, but spheres, and triangles by their ids
  float total_weight = 0.0f;
  float environment_probability = 0.0f, table_probability = 1.0f;
};

struct SceneData {
  std::string source_hash;                ///< of the files that it was read from; empty: none
  std::vector<std::string> source_files;  ///< by absolute path
  std::string name;
  SceneNames names;
  SceneDefaults defaults;
  CameraParameters camera;
  float camera_extent = 0.0f;  ///< camera rays begin within this distance of look_from: set_camera
  Sky sky;
  EnvironmentData environment;  ///< besides the sky, whose radiance it adds to
  Sun sun;                      ///< likewise
  std::vector<DeltaLight> delta_lights;
  std::vector<Sphere> spheres;
  std::vector<Quad> quads;
  std::vector<Mesh> meshes;         ///< those of group 0 in world space
  std::vector<Instance> instances;  ///< of the other groups
  MotionData motion;
  std::vector<MaterialDescription> materials;
  std::vector<Medium> media;
  std::vector<VolumeGrid> grids;            ///< of media; add_grid() makes them
  std::vector<float> grid_values;           ///< of all grids
  std::vector<SparseBlock> grid_nodes;      ///< of the sparse ones
  std::uint32_t camera_medium = no_medium;  ///< in which the camera stands
  std::vector<Texture> textures;
  std::vector<std::byte> texels;                              ///< of all textures
  std::vector<std::uint32_t> sphere_material, quad_material;  ///< by sphere, by quad
  std::vector<SphereFrame> sphere_frames;                     ///< by sphere; empty: none needs one
  // Made from the above by prepare_scene():
  SceneProperties properties;
  SceneTraits traits;
  PixelFilter filter;                      ///< without its table
  std::vector<float> filter_quantiles;     ///< empty: a box of one pixel
  std::vector<Material> material_records;  ///< by material
  std::vector<Parameter> parameters;
  std::vector<Emission> emissions;
  std::vector<Opacity> opacities;          ///< by material; empty: there are no masks
  std::vector<MediumBoundary> boundaries;  ///< by material; empty: there are no media
  bool media_overlap = false;              ///< see Media
  std::vector<Vec4> light_points;          ///< places of point-like lights; empty: no media
  std::vector<float> majorants;            ///< of the grids of densities
  std::vector<Bvh2Node> bvh_nodes;         ///< over spheres and quads; empty: they are scanned
  std::vector<std::uint32_t> material_of;  ///< by primitive
  std::vector<std::uint32_t> primitive_numbers;  ///< by primitive: as they were before
  std::vector<std::uint32_t> lights;             ///< primitives that emit
  std::vector<std::uint32_t> light_emission;     ///< by light
  std::vector<Sphere> scan_spheres;              ///< Primitives::scan
  Vec3 scan_center = Vec3(0.0f);
  std::vector<HalfSpheres> half_spheres;  ///< Primitives::halves
  float half_scale = 1.0f;
  // In scenes with triangles:
  TriangleTreeData tree;                     ///< empty where --builder leaves it to the device
  std::shared_ptr<const EmbreeTree> embree;  ///< with Accel::embree, over `tree`
  std::vector<CornerAttributes> corners;     ///< by triangle; empty where no mesh has attributes
  std::vector<Affine> to_world;              ///< by instance
  LightListData light_list;
  EnvironmentMap environment_map;

  /// The most that a mesh has: 1 where none deforms.
  std::size_t vertex_sets() const {
    std::size_t most = 1;
    for (const Mesh& mesh : meshes) most = std::max(most, mesh.vertex_sets());
    return most;
  }
  bool deforms() const { return vertex_sets() > 1; }
  /// Whether anything moves while the shutter is open.
  bool moves() const { return motion.moves() || deforms(); }
  std::size_t primitive_count() const { return spheres.size() + quads.size(); }
  std::uint64_t triangle_count() const;

  std::uint32_t add_material(const MaterialDescription& material);
  void add_sphere(const Vec3& center, float radius, std::uint32_t material);
  void add_sphere(const Vec3& center, float radius, std::uint32_t material,
                  const SphereFrame& frame);
  void add_quad(const Vec3& corner, const Vec3& a, const Vec3& b, std::uint32_t material);
};

/// The box of what motion.spheres[i] moves, while the shutter is open.
Bounds moving_sphere_bounds(const SceneData& scene, std::size_t i);

/// The bounds of everything in world space. Those of instances may be too large: they are the
/// transformed boxes of their groups. Of those that move: at some of their poses.
Bounds scene_bounds(const SceneData& scene);

/// A camera that sees all of the scene from the front, right and above (+z, +x and +y) in an image
/// of any shape: the scene nearly fills the smaller side. It looks at the middle of the bounds.
CameraParameters frame_scene(const SceneData& scene);

}  // namespace pt
