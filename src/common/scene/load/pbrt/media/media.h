// Named media to ours, and which lie on the sides of a shape.
#pragma once

#include "common/scene/load/pbrt/colors/context.h"

namespace pt::pbrt {

/// The scene's number of the medium of this name, which is made once; no_medium for an empty name
/// and for a medium that is not supported, which is reported. Throws Error, with `place`, for a
/// name that no MakeNamedMedium defines. Adding a kind is adding a line to the table in media.cpp.
std::uint16_t medium_named(Context& context, const std::string& name, const Place& place);

/// What a shape has on its sides. Where both are the same, it keeps the medium of its surroundings.
MediumBoundary media_of(Context& context, const ShapeEntity& shape);

}  // namespace pt::pbrt
