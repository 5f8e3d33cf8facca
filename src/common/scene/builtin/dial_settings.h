// The divergence dial's settings: how many materials there are, how they lie, how long paths are.
#pragma once

#include <cstdint>

#include "common/scene/builtin/scene_name.h"

namespace pt {

struct DialSettings {
  std::uint32_t materials = 16;  ///< K, from 1 to dial_materials_most
  float coherence = 0;           ///< C in [0, 1]: 0 is noise, 1 is stripes
  bool closed = true;            ///< F: a room, else a floor under a sky
};
inline constexpr std::uint32_t dial_materials_most = 32;

/// Reads dial:K:C:F, of which the last parts may be left out. Throws Error that names the part.
DialSettings parse_dial(const SceneName& scene);

/// The material of a cell in `column` of `columns`: with probability `coherence` that of its
/// stripe, of which there is one for each material, else any; decided by the cell's number alone.
std::uint32_t dial_material_of(const DialSettings& settings, std::uint32_t cell,
                               std::uint32_t column, std::uint32_t columns);

}  // namespace pt
