// Metals by name.
#pragma once

#include "common/scene/load/mitsuba/xml/context.h"

namespace pt::mitsuba {

/// The complex index of refraction eta + i k, in linear sRGB as Mitsuba 3 has it.
struct ConductorIndex {
  std::string_view name;
  Color eta, k;
};

/// All that Mitsuba knows, and "none", which reflects everything.
extern const std::vector<ConductorIndex> conductors;

/// By the property `material`; one that is not known becomes aluminium with a warning.
const ConductorIndex& read_named_metal(Context& context, const Object& bsdf);

}  // namespace pt::mitsuba
