// Wavefront OBJ files with the materials of their MTL files.
#pragma once

#include <filesystem>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/load_options.h"

namespace pt {

/// The meshes, one for each material in use, and these materials; neither camera nor light but
/// what the materials emit. What a file names that is missing or wrong is left out, with a warning
/// of each kind. Throws Error for a file that cannot be read.
SceneData load_obj(const std::filesystem::path& path, const LoadOptions& options);

}  // namespace pt
