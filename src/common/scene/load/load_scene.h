// Scene files of all formats.
#pragma once

#include <filesystem>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/load_options.h"

namespace pt {

/// Loads a scene; the ending of the name, in either case, says which format it has: .xml (Mitsuba),
/// .gltf, .glb, .pbrt (pbrt-v4), .obj or .ply. The last two have neither camera nor lights: they
/// get a camera that frames them, and models that their own light does not show default lighting
/// (studio.h); `options.warn` is told so. A .ply is grey, diffuse. Throws Error for other endings
/// and as the formats' loaders do.
SceneData load_scene_file(const std::filesystem::path& path, const LoadOptions& options = {});

}  // namespace pt
