// A scene as the kernels see it: a plain view, passed by value. scene_data.h owns the memory.
#pragma once

#include "common/accel/triangle_tree.h"
#include "common/choices/choices.h"
#include "common/geometry/mesh.h"
#include "common/geometry/motion.h"
#include "common/geometry/primitives.h"
#include "common/geometry/sphere.h"
#include "common/light/distant_lights.h"
#include "common/light/light_selector.h"
#include "common/light/sky/environment.h"
#include "common/material/material.h"
#include "common/medium/medium.h"
#include "common/sampling/pixel_filter.h"
#include "common/scene/data/camera.h"

namespace pt {

/// How a path's time in the shutter's interval is chosen (shutter_time.h).
struct ShutterTimes {
  SamplerKind sampler = SamplerKind::independent;
  std::uint32_t samples = 1;  ///< per pixel, for strata
};

struct Scene {
  Camera camera;
  PixelFilter filter;
  Sky sky;
  Sun sun;  ///< Lighting::full
  Primitives primitives;
  const Bvh2Node* bvh_nodes = nullptr;
  const Material* materials = nullptr;
  const Parameter* parameters = nullptr;             ///< see Material
  const Emission* emissions = nullptr;               ///< of those that emit
  const std::uint32_t* material_of = nullptr;        ///< [primitive]
  const SphereFrame* sphere_frames = nullptr;        ///< [sphere]; null: no sphere needs one
  const std::uint32_t* primitive_numbers = nullptr;  ///< [primitive], as the scene's maker had it
  const std::uint32_t* lights = nullptr;             ///< primitives that emit (Lighting::emitters)
  const std::uint32_t* light_emission = nullptr;     ///< what they do
  std::uint32_t light_count = 0;
  // Scenes with triangles, which also number their triangles' slots after their primitives:
  TriangleTree triangles;
  const CornerAttributes* corners = nullptr;  ///< [triangle id]; null: no mesh has attributes
  const Affine* to_world = nullptr;           ///< [InstanceRecord::number]
  LightSelector light_selector;               ///< Lighting::full
  LightMap light_map;                         ///< Lighting::full
  Environment environment;                    ///< Lighting::full
  const Opacity* opacities = nullptr;         ///< [material], in scenes with masks
  std::uint32_t mask_seed = 0;                ///< of this render
  Media media;                                ///< in scenes with media
  VolumeGrids grids;                          ///< of media
  const Vec4* light_points = nullptr;         ///< of point-like lights, in scenes with media
  std::uint32_t light_point_count = 0;
  std::uint32_t camera_medium_id = no_medium;  ///< see Media
  const Texture* textures = nullptr;
  const std::byte* texels = nullptr;
  const Motion* motion = nullptr;  ///< of a scene that moves, where its arrays are
  ShutterTimes shutter_times;      ///< of such a scene
  PT_LANE_COUNTER;                 ///< of all that is traced in it; set on CUDA

  bool has_only_triangles() const {
    return primitives.count() == 0 && triangles.instance_count == 0;
  }
  PT_HD Material material(std::uint32_t index) const { return load_wide(&materials[index]); }
  /// `material` emits.
  PT_HD Emission emission(const Material& material) const {
    return load_wide(&emissions[material.emission]);
  }
};

/// SceneTraits as a type, with the integrator. (A value as template argument, new in C++20, is
/// refused by nvcc's host pass.)
template <Accel accel_value, Geometry geometry_value, Lighting lighting_value,
          bool has_masks_value = false, bool has_media_value = false, bool has_sparse_value = false,
          bool has_motion_value = false>
struct Traits {
  static constexpr Accel accel = accel_value;
  static constexpr Geometry geometry = geometry_value;
  static constexpr Lighting lighting = lighting_value;
  static constexpr bool has_masks = has_masks_value;    ///< triangles that are there in part
  static constexpr bool has_media = has_media_value;    ///< between surfaces; with has_masks alone
  static constexpr bool has_sparse = has_sparse_value;  ///< see sample_grid(); with has_media alone
  static constexpr bool has_motion = has_motion_value;  ///< paths have a time
  static constexpr bool has_lights = lighting != Lighting::sky;
  static constexpr bool has_instances = geometry == Geometry::mixed;
  /// The BSDFs that a kernel shades.
  using BsdfList = std::conditional_t<lighting == Lighting::full, Bsdfs, PaperBsdfs>;
  static constexpr SceneTraits value() {
    return {accel, geometry, lighting, has_masks, has_media, has_sparse, has_motion};
  }
};

/// What shading depends on: scenes that differ in their structure, in masks or in how grids are
/// stored share its kernels.
template <class T>
using ShadingTraits =
    Traits<Accel::brute, T::geometry, T::lighting, false, T::has_media, false, T::has_motion>;

/// As ShadingTraits, for shading that all kernels of such scenes share
/// (transport/any_structure.cpp).
template <class T>
using SharedShadingTraits =
    Traits<T::lighting == Lighting::full ? Accel::any : Accel::brute, T::geometry, T::lighting,
           false, T::has_media, false, T::has_motion>;

/// The same at collisions in media, where grids are looked up.
template <class T>
using CollisionTraits = Traits<Accel::brute, T::geometry, T::lighting, false, T::has_media,
                               T::has_sparse, T::has_motion>;

/// As ShadingTraits of scenes that have triangles and nothing else.
template <class T>
using TrianglesAlone = std::conditional_t<
    T::geometry == Geometry::mixed,
    Traits<T::accel, Geometry::triangles, T::lighting, T::has_masks, T::has_media>, T>;

}  // namespace pt
