// Stochastic opacity of a surface: a ray that a mask lets through continues as if it was not there.
#pragma once

#include "common/texture/texture.h"

namespace pt {

/// 16 bytes: one load. The opacity, offset + scale * the texture's luminance, at most 1, is the
/// probability that a ray hits the surface; with a cutoff the ray hits it where the opacity is at
/// least the cutoff.
struct alignas(16) Opacity {
  float offset = 1.0f;
  float scale = 0.0f;
  std::uint32_t texture = no_texture;
  float cutoff = 0.0f;  ///< 0: none; light_hidden: none, and camera rays do not hit it

  static constexpr float light_hidden = -1.0f;

  PT_HD bool is_opaque() const { return texture == no_texture && offset >= 1.0f; }
  PT_HD bool hides_from_camera() const { return cutoff < 0.0f; }
  PT_HD bool is_constant() const { return texture == no_texture; }
};

inline Opacity constant_opacity(float value) { return {value, 0.0f, no_texture, 0.0f}; }
inline Opacity textured_opacity(float scale, std::uint32_t texture, float cutoff = 0.0f) {
  return texture == no_texture ? Opacity{scale, 0.0f, no_texture, cutoff}
                               : Opacity{0.0f, scale, texture, cutoff};
}

}  // namespace pt
