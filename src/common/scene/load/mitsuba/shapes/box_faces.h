// Mitsuba's rectangle and the faces of its cube.
#pragma once

#include <array>

#include "common/math/vec.h"

namespace pt::mitsuba {

/// corner + a edge_a + b edge_b, cross(edge_a, edge_b) pointing out. Mitsuba's (u, v) is (a, b), or
/// (b, a) where swapped.
struct BoxFace {
  Vec3 corner, edge_a, edge_b;
  bool uv_swapped = false;
};

inline BoxFace rectangle_face() { return {{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}; }

/// With the (u, v) of Mitsuba 3.9's vertices, which mirror a texture.
inline std::array<BoxFace, 6> cube_faces() {
  return {{{{-1, -1, -1}, {2, 0, 0}, {0, 0, 2}, true},
           {{1, 1, 1}, {0, 0, -2}, {-2, 0, 0}, true},
           {{1, -1, 1}, {0, 0, -2}, {0, 2, 0}, true},
           {{-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, true},
           {{-1, -1, -1}, {0, 0, 2}, {0, 2, 0}, true},
           {{-1, 1, -1}, {2, 0, 0}, {0, -2, 0}, true}}};
}

}  // namespace pt::mitsuba
