// Textures computed from others, texel by texel.
#pragma once

#include <functional>
#include <vector>

#include "common/scene/load/pbrt/textures/color_texture.h"

namespace pt::pbrt {

/// function(values of `parts`) as an image. Parts that are images with the same map of coordinates
/// give it theirs, and their size, so that texels meet texels; others are looked at over the unit
/// square of (u, v), which repeats.
ColorTexture bake(Context& context, const std::vector<ColorTexture>& parts,
                  const std::function<Color(const std::vector<Color>&)>& function);

}  // namespace pt::pbrt
