// What the tree of lights knows of lights.
#pragma once

#include "common/geometry/bounds.h"
#include "common/light/light.h"

namespace pt {

inline constexpr float half_turn = pi, quarter_turn = 0.5f * pi;

/// What is known of some lights together: where they are, where they shine, how much.
struct LightBounds {
  Bounds box;
  Vec3 axis{0, 0, 1};      ///< of the cone of normals
  float cone = 0.0f;       ///< its half angle, in radians
  float emission = 0.0f;   ///< light goes where the angle to a normal is below this one
  float intensity = 0.0f;  ///< see LightNode
};

/// Of a light without extent that sends its intensity everywhere.
inline LightBounds bounds_of_place(const Light& light) {
  LightBounds bounds;
  bounds.box.grow(light.a);
  bounds.cone = half_turn;
  bounds.emission = quarter_turn;
  bounds.intensity = luminance(light.radiance);
  return bounds;
}

}  // namespace pt
