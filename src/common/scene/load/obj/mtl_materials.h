// What the materials of MTL files mean here: docs/scenes.md has the table.
#pragma once

#include "common/scene/load/obj/mtl_textures.h"

namespace pt::obj {

/// Adds the material to the scene, as the nearest of ours, and returns its number.
std::uint32_t add_material(const MtlMaterial& source, MtlTextures& textures, SceneData& scene,
                           CountedWarnings& warnings);

}  // namespace pt::obj
