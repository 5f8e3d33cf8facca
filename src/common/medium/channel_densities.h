// Spectral multiple importance sampling over the channels.
//
// A distance can be sampled by the extinction of one channel alone, and in a coloured medium each
// channel prefers other paths. So a path is sampled by a channel chosen at random, and weighed by
// the mean density with which the three would have sampled all of it (the balance heuristic; Miller
// et al. 2019, 'A null-scattering path integral formulation of light transport', section 5;
// pbrt-v4, section 14.1.4). The channel need not be remembered: choosing it again for each event,
// with the probability that the path so far was sampled by it, gives the same paths.
#pragma once

#include "common/math/vec.h"

namespace pt {

/// Of what a path has met so far: the density with which each channel samples it, over their mean.
struct ChannelDensities {
  float red = 1.0f, green = 1.0f;  ///< blue is what is missing to a sum of 3

  PT_HD Color all() const { return {red, green, fmaxf(3.0f - red - green, 0.0f)}; }

  /// The channel for the next event; `u` is uniform in [0, 1).
  PT_HD int choose(float u) const {
    const float at = 3.0f * u;
    return at < red ? 0 : at < red + green ? 1 : 2;
  }

  /// The next event has happened, which the channels sample with these densities. Returns its
  /// weight: `value`, which each channel brings, over the mean density.
  PT_HD Color weigh(const Color& value, const Color& densities) {
    const Color weighted = multiply_rounded(all(), densities);
    const float sum = mean(weighted);
    if (!(sum > 0.0f)) return Color(0.0f);
    const Color inverse(divide(1.0f, sum));
    red = multiply_rounded(weighted.x, inverse.x), green = multiply_rounded(weighted.y, inverse.x);
    return multiply_rounded(value, inverse);
  }
};

PT_HD float channel(const Color& color, int index) {
  return index == 0 ? color.x : index == 1 ? color.y : color.z;
}

PT_HD bool is_grey(const Color& color) { return color.x == color.y && color.y == color.z; }

}  // namespace pt
