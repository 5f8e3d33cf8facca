// The kinds of lights but the environment, by name. lights.h has their types.
#pragma once

#include "common/platform/platform.h"

namespace pt {

/// Triangles come first. A turned one has its last two vertices exchanged: it belongs to an
/// instance that mirrors, and mirroring would turn the side that shines away.
enum class LightKind : std::uint8_t {
  triangle,
  flipped_triangle,
  sphere,
  sun,
  point,
  spot,
  projector,
  directional
};

PT_HD bool is_triangle(LightKind kind) { return kind <= LightKind::flipped_triangle; }

}  // namespace pt
