// Lights that are not on a shape.
#pragma once

#include "common/scene/load/pbrt/colors/read_color.h"

namespace pt::pbrt {

/// Adds point, spot, distant and infinite lights to the scene; others are reported. Adding a kind
/// is adding a line to the table in lights.cpp.
void add_lights(Context& context);

/// An infinite light: a constant, or a picture.
void add_infinite(Context& context, const Entity& entity);

/// `scale` of a light, times the film's imaging ratio.
float read_light_scale(const Context& context, const Parameters& parameters);

}  // namespace pt::pbrt
