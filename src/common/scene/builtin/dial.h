// The divergence dial: cells of many materials on a floor or on the walls of a room.
#pragma once

#include <cstdint>

#include "common/scene/builtin/scene_name.h"
#include "common/scene/data/material_description.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// How many materials there are, how they lie, how long paths are.
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

/// BSDFs that the dial has.
inline constexpr std::uint32_t dial_kinds = 13;

/// The material of this index of the dial. The first ones are one of each BSDF: ten that reflect
/// about 0.75 of the light, in hues that differ a little, then three kinds of glass, which absorb
/// nothing. The kinds repeat with other roughness, exponent or index, and then with the other
/// distribution of facets where they have two. The first one is diffuse.
MaterialDescription make_dial_material(std::uint32_t index);

/// Cells along each side of the floor, and of each of the room's six walls.
inline constexpr std::uint32_t dial_floor_cells = 128, dial_wall_cells = 64;

/// Cells of one square unit, two triangles each, in a mesh for each material, the first K. Open: a
/// floor about the origin under a bright sky, so that paths end early. Closed: the six walls of a
/// room with a lamp below its ceiling, so that no path leaves. A quarter of a unit behind the cells
/// there is one more floor or room, of the first material, for what passes through glass.
SceneData make_dial_scene(const DialSettings& settings);

}  // namespace pt
