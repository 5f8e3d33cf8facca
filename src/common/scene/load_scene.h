// Scenes from files.
#pragma once

#include <filesystem>
#include <string>

#include "common/scene/load_options.h"
#include "common/scene/scene_data.h"

namespace pt {

/// Whether `name` is that of a scene file, by its ending: .xml, .gltf, .glb, .obj, .ply.
bool is_scene_file(const std::string& name);

SceneData load_scene_file(const std::filesystem::path& path, const LoadOptions& options);

}  // namespace pt
