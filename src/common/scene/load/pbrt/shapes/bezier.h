// Cubic Bezier curves.
#pragma once

#include <array>
#include <vector>

#include "common/scene/load/pbrt/syntax/parameters.h"

namespace pt::pbrt {

using Bezier = std::array<Vec3, 4>;

Vec3 position_on(const Bezier& b, float t);

/// In proportion to the derivative.
Vec3 slope_on(const Bezier& b, float t);

/// The segments of a curve of any degree and basis that pbrt has. Throws Error.
std::vector<Bezier> read_beziers(const Parameters& parameters);

}  // namespace pt::pbrt
