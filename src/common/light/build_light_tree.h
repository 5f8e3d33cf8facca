// The tree of lights, built on the CPU.
#pragma once

#include <cstdint>
#include <vector>

#include "common/light/light_bounds.h"
#include "common/light/light_tree.h"

namespace pt {

/// The memory behind a LightTree.
struct LightTreeData {
  std::vector<LightPair> pairs;
  std::vector<std::uint32_t> trail;
  std::uint32_t root = 0;
};

/// Over all lights that have bounds, split by the surface area orientation heuristic. Without
/// pairs where there is no such light; where there is one alone, with one pair that nobody visits.
LightTreeData build_light_tree(const std::vector<Light>& lights);

}  // namespace pt
