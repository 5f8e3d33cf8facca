#include "common/scene/prepare/weigh_textures.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <functional>
#include <map>
#include <tuple>

#include "common/light/light.h"
#include "common/texture/sample_texture.h"

namespace pt {

namespace {

/// The mean luminance of (image, factor), kept since many materials share both.
using Means = std::map<std::tuple<std::uint32_t, float, float, float>, double>;

double mean_of_image(const Texture& texture, const std::byte* texels, const Color& color) {
  // Deterministic: the sum must not depend on the number of threads.
  const double sum = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::uint32_t>(0, texture.height, 64), 0.0,
      [&](const tbb::blocked_range<std::uint32_t>& rows, double part) {
        for (std::uint32_t y = rows.begin(); y != rows.end(); ++y) {
          for (std::uint32_t x = 0; x < texture.width; ++x)
            part += std::fmax(0.0f, luminance(color * load_texel(texture, texels, x, y)));
        }
        return part;
      },
      std::plus<>());
  return sum / (static_cast<double>(texture.width) * static_cast<double>(texture.height));
}

/// Each texture once for each factor, although checkerboards may hold it 2^n times.
double mean_of_texture(const Texture* textures, std::uint32_t texture_index,
                       const std::byte* texels, const Color& factor, Means& means) {
  const std::tuple key(texture_index, factor.x, factor.y, factor.z);
  if (const auto known = means.find(key); known != means.end()) return known->second;
  const Texture& texture = textures[texture_index];
  double mean = 0;
  if (texture.kind == TextureKind::checkerboard) {
    const auto mean_of = [&](int square, const Color& color) {
      const std::uint32_t nested = texture.nested[square];
      return nested == no_texture
                 ? double{luminance(factor * color)}
                 : mean_of_texture(textures, nested, texels, factor * color, means);
    };
    mean = 0.5 * (mean_of(0, texture.color0) + mean_of(1, texture.color1));
  } else {
    mean = mean_of_image(texture, texels, factor * texture.color0);
  }
  return means[key] = mean;
}

}  // namespace

double mean_luminance(const Texture* textures, std::uint32_t texture_index, const std::byte* texels,
                      const Color& factor) {
  Means means;
  return mean_of_texture(textures, texture_index, texels, factor, means);
}

void weigh_emission_textures(SceneData& scene) {
  for (MaterialDescription& material : scene.materials) {
    Emission& emission = material.emission;
    if (emission.texture == no_texture || is_black(emission.radiance)) continue;
    const auto mean = static_cast<float>(
        mean_luminance(scene.textures.data(), emission.texture, scene.texels.data()));
    emission.texture_mean = std::isfinite(mean) ? mean : 1.0f;
    if (emission.texture_mean == 0.0f) emission.radiance = Color(0.0f);  // a black texture
  }
}

}  // namespace pt
