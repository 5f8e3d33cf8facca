#include "wavefront/path_costs.h"

#include <bit>

#include "common/material/material.h"
#include "common/scene/prepare_materials.h"

namespace pt {

bool order_pays_for(std::uint32_t kinds) {
  constexpr int few = 5;
  constexpr std::uint32_t one = 1, long_ones = one << static_cast<int>(kind_of<Principled>) |
                                               one << static_cast<int>(kind_of<PrincipledThin>);
  return std::popcount(kinds) > ((kinds & long_ones) != 0 ? 1 : few);
}

std::uint32_t finish_paths_of(const Options& options, const SceneData& scene) {
  if (options.finish_paths) return *options.finish_paths;
  if (scene.traits.geometry == Geometry::spheres_and_quads) return 1u << 17;
  const bool is_dear = !scene.instances.empty() || order_pays_for(kinds_of(scene));
  return is_dear ? 1u << 13 : 1u << 15;
}

}  // namespace pt
