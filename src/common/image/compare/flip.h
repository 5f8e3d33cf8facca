// FLIP, how different two images look when one alternates between them: from 0, the same, to 1.
// LDR: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem and Fairchild, FLIP: A Difference
// Evaluator for Alternating Images, 2020. HDR: Andersson, Nilsson, Shirley and Akenine-Moeller,
// Visualizing Errors in Rendered High Dynamic Range Images, 2021.
#pragma once

#include <vector>

#include "common/image/compare/compare.h"
#include "common/image/image.h"

namespace pt {

/// Pixels per degree of the papers' viewer: 0.7 m before a display 0.7 m wide of 3840 pixels.
inline constexpr double flip_pixels_per_degree = 0.7 * 3840 / 0.7 * 3.14159265358979323846 / 180;

/// How one looks, and at how much at once.
struct FlipView {
  double pixels_per_degree = flip_pixels_per_degree;
  int tile = 256;  ///< pixels: large beside what the filters reach, small enough for a cache
};

/// The exposures, in stops, at which HDR images are looked at.
struct FlipExposures {
  double start = 0, stop = 0;
  int count = 2;
};

/// From the luminance of the reference.
FlipExposures flip_exposures(const Image& reference);

/// [y][x], of two images of one size. Values are linear and clamped to [0, 1].
std::vector<float> ldr_flip(const Image& test, const Image& reference, const FlipView& view = {});

/// FLIP of linear radiance: the largest LDR-FLIP of all exposures, tone mapped by the ACES curve.
/// Negative values and NaN count as 0.
std::vector<float> hdr_flip(const Image& test, const Image& reference, const FlipView& view = {});

/// The one or the other. Where no pixel differs nothing is seen, which is not computed.
std::vector<float> flip_of(const Image& test, const Image& reference, bool is_hdr,
                           const ImageDifference& difference);

double mean_of(const std::vector<float>& values);

}  // namespace pt
