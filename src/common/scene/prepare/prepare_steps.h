// The steps of resolve_scene and prepare_scene (prepare_scene.h).
#pragma once

#include "common/accel/build/build_triangle_tree.h"
#include "common/geometry/bounds.h"
#include "common/options/options.h"
#include "common/plan/execution_plan.h"
#include "common/scene/data/scene_data.h"

namespace pt {

void override_camera(CameraParameters& camera, const CameraOverrides& overrides);

/// Throws Error naming the option that can mend it when the parameters describe no camera.
void check_camera(const CameraParameters& camera);

/// Takes away a far plane behind all: rays without one are faster.
void drop_idle_far_plane(SceneData& scene);

/// Within this distance of look_from all rays of an image of width x height pixels begin.
float camera_extent(const CameraParameters& parameters, int width, int height);

/// Orders media by their priorities, where one has any, and lists the boundaries of media by
/// material and the places of point-like lights, and bounds the grids of densities: a majorant for
/// each cell of 8^3 voxels or, where a grid would have more than 64^3 of them, larger ones. Throws
/// Error, which names the scene, where more have to be ordered than overlapping_media_max.
void prepare_media(SceneData& scene);

/// Moves the boundaries of media off the surfaces that they touch, by what rays can tell apart, so
/// that a ray hits both and in the right order (docs/design/media.md). What touches nothing keeps
/// its bits. After convert_quads() and prepare_media().
void separate_boundaries(SceneData& scene);

/// Decomposes the keys of all that moves. Throws Error, which names it, for keys that are none.
void prepare_motion(SceneData& scene);

/// Tells which lights move, after they have been listed.
void prepare_moving_lights(SceneData& scene);
/// What kernels know of spheres that move, in their final order.
void prepare_moving_spheres(SceneData& scene);

/// As Scene has it. After prepare_media().
std::uint32_t camera_medium_id(const SceneData& scene);

/// Lists the emitters, joins the material numbers, makes the spheres of the scan and, if `tree`,
/// the binary BVH, which reorders the primitives. `others`: where else rays may begin.
void prepare_primitives(SceneData& scene, bool tree, const Bounds& others = {});

/// Lists the primitives that emit in the order of primitive_numbers, whatever tree is over them: on
/// it depends the image.
void list_emitters(SceneData& scene);

/// Turns quads into triangles, builds the plan's structure over them, collects the vertices'
/// attributes, the lights, the environment, and sets the traits. Throws Error for what cannot be
/// built.
void prepare_triangles(SceneData& scene, const ExecutionPlan& plan);

/// What tree is to be built for a structure, on either device. Embree, which builds its own, wants
/// the triangles alone.
TreeOptions tree_options(Accel accel, TreeBuilder builder);

/// Replaces the scene's quads by meshes of two triangles each, one mesh per material.
void convert_quads(SceneData& scene);

// Packs the materials' descriptions into what kernels read.

/// Whether --multiple-scattering changes it.
bool is_rough_conductor(const MaterialDescription& material);

/// Camera rays do not hit it.
bool is_hidden_light(const SceneData& scene, const MaterialDescription& material);

/// Whether its triangles are there in part, or not for all rays.
bool is_masked(const SceneData& scene, const MaterialDescription& material);

/// A bit for each MaterialKind of the materials that surfaces have.
std::uint32_t kinds_of(const SceneData& scene);

/// Fills material_records, parameters and emissions from the materials: the first parameters by
/// material and then the others, emissions only of emissive ones, textures' means measured. With
/// `multiple_scattering` rough conductors become CompensatedConductors; without `panes_pass` thin
/// glass ends shadow rays and costs depth, whatever the scene says.
void prepare_materials(SceneData& scene, bool multiple_scattering, bool panes_pass = true);

/// Whether it needs kernels with media: it has some, or thin glass that lets shadow rays through.
/// After prepare_materials().
bool needs_media(const SceneData& scene);

/// Luminance of a texture's colours, on average over the whole of it.
double mean_luminance(const Texture* textures, std::uint32_t texture_index, const std::byte* texels,
                      const Color& factor = Color(1.0f));

/// Sets Emission::texture_mean, and radiance to 0 where the texture is black, by which lights are
/// chosen.
void weigh_emission_textures(SceneData& scene);

}  // namespace pt
