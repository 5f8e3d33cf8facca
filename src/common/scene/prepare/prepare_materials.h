// Packs the materials' descriptions into what kernels read.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

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
