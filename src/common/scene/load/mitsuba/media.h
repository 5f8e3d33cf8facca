// <medium>s to ours, and which lie on the sides of a shape.
#pragma once

#include "common/scene/load/mitsuba/xml/context.h"

namespace pt::mitsuba {

/// The number of a medium in the scene; made once. None where it is of a kind that is not
/// supported, which is reported.
std::optional<std::uint16_t> read_medium(Context& context, const Object& medium);

/// What a shape has inside and outside of it.
struct ShapeMedia {
  bool any = false;  ///< it has at least one that is supported
  MediumBoundary boundary;
};
ShapeMedia media_of(Context& context, const Object& shape);

/// All types of phase functions that are read.
std::vector<std::string> phase_types();

// The grids of media become the scene's.

/// To be called when the scene has its shapes and its sensor. Outside of the box around its density
/// there is nothing of a medium: where shapes leave it room there, its grid gets a layer of zeros.
void add_grids(Context& context);

}  // namespace pt::mitsuba
