// Light from infinitely far: a gradient, and an environment map that is sampled by its luminance
// (pbrt-v4, section 12.5).
//
// The picture is a map by latitude and longitude: in its own space the middle column's border is -z
// and u grows towards +x. Columns are centred in their share of the turn, as texels are; rows reach
// from pole to pole: row 0 is the zenith (+y) itself and the last row the nadir. That is Mitsuba's
// convention, whose scenes bring such maps. Radiance is interpolated between them, around in u.
//
// Directions are chosen by cells: as wide as a column, from one row to the next. Density per solid
// angle is constant over a cell, proportional to the mean luminance of its directions, so that
// every direction with light can be sampled: the ratio of the two is at most 12 times that of their
// means. Within a cell directions are uniform in solid angle, so no density is infinite at the
// poles.
#pragma once

#include <span>
#include <vector>

#include "common/math/functions.h"
#include "common/math/transform.h"
#include "common/sampling/alias_table.h"

namespace pt {

/// A vertical gradient, the paper's background; equal colours give a constant sky.
struct Sky {
  Color nadir = Color(0.0f);   ///< radiance from straight below, W / (m^2 sr)
  Color zenith = Color(0.0f);  ///< radiance from straight above, W / (m^2 sr)
};

/// `direction` has unit length and points away from the scene.
PT_HD Color sky_radiance(const Sky& sky, const Vec3& direction) {
  const float t = 0.5f * (direction.y + 1.0f);
  return interpolate(sky.nadir, sky.zenith, t);
}

/// One 16-byte load.
struct alignas(16) EnvironmentTexel {
  Color radiance = Color(0.0f);  ///< at the middle of the column, on the row
  float pdf = 0.0f;  ///< per solid angle, of the cell from here to the next row; last row: none
};

/// A view for kernels. EnvironmentMap owns the memory.
struct Environment {
  const EnvironmentTexel* texels = nullptr;  ///< [row * width + column]
  const AliasEntry* alias = nullptr;         ///< [cell], numbered as texels
  std::uint32_t width = 0, height = 0;       ///< 0: none
  float average = 0.0f;                      ///< luminance, over the sphere
  Affine to_world;                           ///< orthogonal

  PT_HD bool is_empty() const { return width == 0; }
  /// Rows of cells; a picture of one row is one band from pole to pole.
  PT_HD std::uint32_t bands() const { return height > 1 ? height - 1 : 1; }
};

/// A position in the map: cell (i, j) reaches from i to i + 1 and from j to j + 1.
struct MapPoint {
  float x, y;
};

/// `direction` is in the map's own space; its length is free. Exact at the poles, where arc cosine
/// is not.
PT_HD MapPoint environment_point(const Environment& env, const Vec3& direction) {
  const float azimuth = atan2f(direction.x, -direction.z);
  const float from_axis =
      square_root(fused_multiply_add(direction.x, direction.x, direction.z * direction.z));
  const float from_zenith = atan2f(from_axis, direction.y);
  // Rounded: what comes next takes the whole part off, and might be fused with the product.
  return {fused_multiply_add(0.5f * inverse_pi, azimuth, 0.5f) * static_cast<float>(env.width),
          inverse_pi * from_zenith * static_cast<float>(env.bands())};
}

/// The index of the cell that contains the point.
PT_HD std::uint32_t environment_cell(const Environment& env, const MapPoint& point) {
  const auto column = static_cast<std::uint32_t>(fmaxf(point.x, 0.0f));
  const auto band = static_cast<std::uint32_t>(fmaxf(point.y, 0.0f));
  return (band < env.bands() ? band : env.bands() - 1) * env.width +
         (column < env.width ? column : env.width - 1);
}

/// Radiance, W / (m^2 sr), interpolated between four texels.
PT_HD Color environment_lookup(const Environment& env, const MapPoint& point) {
  const float x = point.x - 0.5f, y = point.y;
  const float left = floorf(x), top = floorf(y);
  const int width = static_cast<int>(env.width), height = static_cast<int>(env.height);
  const auto wrap = [width](int i) { return i < 0 ? i + width : i >= width ? i - width : i; };
  const auto clamp = [height](int j) { return j < 0 ? 0 : j >= height ? height - 1 : j; };
  const int column0 = wrap(static_cast<int>(left)), column1 = wrap(static_cast<int>(left) + 1);
  const EnvironmentTexel* row0 = env.texels + std::int64_t{clamp(static_cast<int>(top))} * width;
  const EnvironmentTexel* row1 =
      env.texels + std::int64_t{clamp(static_cast<int>(top) + 1)} * width;
  const auto radiance = [](const EnvironmentTexel* texel) { return load_wide(texel).radiance; };
  return interpolate(interpolate(radiance(row0 + column0), radiance(row0 + column1), x - left),
                     interpolate(radiance(row1 + column0), radiance(row1 + column1), x - left),
                     y - top);
}

/// `direction` has unit length and points away from the scene, in world space.
PT_HD Color environment_radiance(const Environment& env, const Vec3& direction) {
  return environment_lookup(env, environment_point(env, env.to_world.transposed(direction)));
}

/// Density per solid angle with which sample_environment chooses `direction`.
PT_HD float environment_pdf(const Environment& env, const Vec3& direction) {
  const MapPoint point = environment_point(env, env.to_world.transposed(direction));
  return env.texels[environment_cell(env, point)].pdf;
}

struct EnvironmentSample {
  Vec3 wi = Vec3(0.0f);  ///< unit vector away from the scene, in world space
  float pdf = 0.0f;      ///< per solid angle, positive
  Color radiance = Color(0.0f);
};

/// A direction of band `band` of `bands`, uniform in solid angle, as its distance from the nearer
/// pole, measured in sin^2(theta / 2): uniform on the sphere like cos(theta), and precise at the
/// pole.
PT_HD float sample_band(std::uint32_t band, std::uint32_t bands, float u) {
  const float step = divide(0.25f, static_cast<float>(bands));  // half an angle, in turns
  const float sin0 = sincos_2pi(static_cast<float>(band) * step).sin;
  const float sin1 = sincos_2pi(static_cast<float>(band + 1) * step).sin;
  return fused_multiply_add(u, (sin1 - sin0) * (sin1 + sin0), sin0 * sin0);
}

/// From three uniform numbers, multiples of 2^-24 in [0, 1). Where rounding moves a direction over
/// the border of its cell, `pdf` is that of the cell which was chosen.
PT_HD EnvironmentSample sample_environment(const Environment& env, float u0, float u1, float u2) {
  const std::uint32_t bands = env.bands();
  const AliasSample chosen = sample_alias(env.alias, env.width * bands, u0, u1);
  const std::uint32_t band = chosen.index / env.width, column = chosen.index % env.width;
  const bool below = 2 * band >= bands;
  const float h = fminf(sample_band(below ? bands - 1 - band : band, bands, u2), 1.0f);
  const float sin_theta = 2.0f * square_root(h * (1.0f - h));
  const float cos_theta = 1.0f - 2.0f * h;
  const SinCos phi =  // of the angle from column 0, which is +z
      sincos_2pi(divide(static_cast<float>(column) + chosen.u, static_cast<float>(env.width)));
  const Vec3 local = {-sin_theta * phi.sin, below ? -cos_theta : cos_theta, sin_theta * phi.cos};
  const Vec3 wi = normalize(env.to_world.vector(local));
  return {wi, env.texels[chosen.index].pdf, environment_radiance(env, wi)};
}

/// The memory behind an Environment.
struct EnvironmentMap {
  std::vector<EnvironmentTexel> texels;
  std::vector<AliasEntry> alias;
  std::uint32_t width = 0, height = 0;
  float average = 0.0f;
  Affine to_world;

  /// Valid while the map is neither changed nor destroyed.
  Environment view() const {
    return {texels.data(), alias.data(), width, height, average, to_world};
  }
};

/// Prepares a map of `width` x `height` radiances, row by row. A uniform scale in `to_world` is
/// removed. A black map is sampled uniformly. Throws Error for a size that does not fit `pixels` or
/// exceeds 2^31 - 1 texels, a negative or non-finite pixel, and a `to_world` that shears.
EnvironmentMap make_environment(int width, int height, std::span<const Color> pixels,
                                const Affine& to_world);

}  // namespace pt
