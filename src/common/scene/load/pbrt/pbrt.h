// Scenes in pbrt-v4's format.
#pragma once

#include <filesystem>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/load_options.h"

namespace pt {

/// Loads a scene and the meshes, textures and pictures that it names. What we cannot do is replaced
/// by the nearest that we can, or left out, and reported through the options, once for each kind.
/// Throws Error, one line with file, line and column, for a file that is malformed or missing.
SceneData load_pbrt(const std::filesystem::path& path, const LoadOptions& options = {});

}  // namespace pt
