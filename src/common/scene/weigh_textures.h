// How bright textures are on average.
#pragma once

#include "common/scene/scene_data.h"

namespace pt {

/// Luminance of a texture's colours, on average over the whole of it.
double mean_luminance(const Texture* textures, std::uint32_t texture_index, const std::byte* texels,
                      const Color& factor = Color(1.0f));

/// Sets Emission::texture_mean, and radiance to 0 where the texture is black, by which lights are
/// chosen.
void weigh_emission_textures(SceneData& scene);

}  // namespace pt
