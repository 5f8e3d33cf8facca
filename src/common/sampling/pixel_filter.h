// Reconstruction filters by importance sampling (Ernst, Stamminger and Greiner, Filter Importance
// Sampling, 2006): a sample belongs to one pixel, and its position is drawn with the density |f|
// of the filter. So nothing is added to neighbours, and the film stays without order.
#pragma once

#include "common/math/vec.h"

namespace pt {

/// A separable filter f(x) f(y), centred on the pixel: a view. prepare_filter.h makes one. A box of
/// one pixel has no table, and is what a camera without filter does.
struct PixelFilter {
  static constexpr int cells = 1024;  ///< of the table; a power of two, so that u * cells is exact
  static constexpr int changes_max = 8;  ///< of sign, on one side

  /// [k]: half of |f|'s integral times k / cells lies within this distance of the centre, in
  /// pixels.
  const float* quantiles = nullptr;
  std::uint32_t has_table = 0;  ///< 0: a box of one pixel
  /// Shares of half of |f|'s integral, ascending: f changes its sign where so much lies within.
  float sign_changes[changes_max] = {};
  std::uint32_t change_count = 0;
  /// The image is positive_weight * mean of the samples where f(x) f(y) > 0, minus negative_weight
  /// * mean of the others. The difference of the two is 1.
  float positive_weight = 1.0f, negative_weight = 0.0f;

  PT_HD bool has_negative() const { return change_count > 0; }

  /// From the pixel's lower edge, in pixels; u in [0, 1).
  PT_HD float offset(float u) const { return has_table == 0 ? u : 0.5f + from_centre(u); }

  /// (offset(x), offset(y)), past whose table a box branches: for specialised kernels (random.h).
  PT_HD Vec2 offsets(float x, float y) const {
    for (bool look_up = has_table != 0; look_up; look_up = is_never()) {
      x = offset(x);
      y = offset(y);
    }
    return {x, y};
  }

  /// Whether the filter is negative at the sample of these two numbers.
  PT_HD bool is_negative(float u0, float u1) const {
    return ((changes_within(u0) ^ changes_within(u1)) & 1u) != 0;
  }

 private:
  // In an operation that is fused everywhere: a sample's position is the same in all kernels.
  PT_HD float from_centre(float u) const {
    const float v = 2.0f * u - 1.0f;
    const float scaled = fabsf(v) * static_cast<float>(cells);
    const int cell = static_cast<int>(scaled) < cells ? static_cast<int>(scaled) : cells - 1;
    const float near = quantiles[cell], far = quantiles[cell + 1];
    const float x = fused_multiply_add(scaled - static_cast<float>(cell), far - near, near);
    return v < 0.0f ? -x : x;
  }

  // By the number itself, not by the position from the table: so each sign has the
  // samples that it should have, and those of a cell with both signs are a little displaced.
  PT_HD std::uint32_t changes_within(float u) const {
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < change_count; ++i) {
      count += fabsf(2.0f * u - 1.0f) > sign_changes[i] ? 1u : 0u;
    }
    return count;
  }
};

}  // namespace pt
