// The divergence dial: cells of many materials on a floor or on the walls of a room.
#pragma once

#include "common/scene/builtin/dial_settings.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Cells along each side of the floor, and of each of the room's six walls.
inline constexpr std::uint32_t dial_floor_cells = 128, dial_wall_cells = 64;

/// Cells of one square unit, two triangles each, in a mesh for each material, the first K. Open: a
/// floor about the origin under a bright sky, so that paths end early. Closed: the six walls of a
/// room with a lamp below its ceiling, so that no path leaves. A quarter of a unit behind the cells
/// there is one more floor or room, of the first material, for what passes through glass.
SceneData make_dial_scene(const DialSettings& settings);

}  // namespace pt
