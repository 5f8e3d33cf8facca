// The tree of lights, built on the CPU.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/bounds.h"
#include "common/light/light.h"
#include "common/light/light_tree.h"

namespace pt {

/// Bounds of some lights together: of position, direction and intensity (pbrt-v4, section 12.6.3).
struct LightBounds {
  Bounds box;
  Vec3 axis{0, 0, 1};      ///< of the cone of normals
  float cone = 0.0f;       ///< its half angle, in radians
  float emission = 0.0f;   ///< light goes where the angle to a normal is below this one
  float intensity = 0.0f;  ///< see LightNode
};

/// None for a light without position (directional) and for one that emits nothing.
std::optional<LightBounds> bounds_of(const Light& light);

/// The memory behind a LightTree.
struct LightTreeData {
  std::vector<LightPair> pairs;
  std::vector<std::uint32_t> trail;
  std::uint32_t root = 0;
};

/// Over all lights that have bounds, split by the surface area orientation heuristic. Without
/// pairs where there is no such light; where there is one alone, with one pair that is never
/// visited.
LightTreeData build_light_tree(const std::vector<Light>& lights);

}  // namespace pt
