// FLIP by tiles, in parallel: a pixel's error depends on those within the filters' reach alone.
#pragma once

#include <functional>
#include <vector>

#include "common/image/compare/flip.h"

namespace pt {

/// The errors [y][x] of parts of two images, which have one size.
using FlipOfParts = std::function<std::vector<float>(const Image& test, const Image& reference)>;

/// The same values as `flip_of_parts` of the whole images. Where pixels have the same bits as far
/// as the filters reach, errors are 0 and not computed.
std::vector<float> flip_by_tiles(const Image& test, const Image& reference, const FlipView& view,
                                 const FlipOfParts& flip_of_parts);

}  // namespace pt
