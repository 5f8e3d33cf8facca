// <emitter>s that are not on a shape.
#pragma once

#include "common/scene/load/mitsuba/xml/context.h"

namespace pt::mitsuba {

/// Adds point, spot, projector, directional, constant, envmap or sunsky to the scene; others are
/// reported. Adding a kind is adding a line to the table in emitters.cpp.
void add_emitter(Context& context, const Object& emitter);

/// `sunsky`, `sky`, `sun`.
void add_daylight(Context& context, const Object& emitter);

}  // namespace pt::mitsuba
