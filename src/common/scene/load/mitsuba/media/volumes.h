// <volume>s: what varies in a medium.
#pragma once

#include "common/scene/load/mitsuba/spectra/spectra.h"

namespace pt::mitsuba {

/// A quantity of a medium: `value`, times the grid where it has one.
struct VolumeQuantity {
  Color value = Color(1.0f);
  const Object* grid = nullptr;  ///< in Context::volumes
  Affine to_world{};             ///< of what has no grid: from the cube in which it is
};

/// A number, a colour or a <volume> of `medium`, or `fallback` where it has none. None where it is
/// of a kind that is not supported.
std::optional<VolumeQuantity> read_volume_quantity(Context& context, const Object& medium,
                                                   std::string_view name, const Color& fallback,
                                                   Quantity quantity);

}  // namespace pt::mitsuba
