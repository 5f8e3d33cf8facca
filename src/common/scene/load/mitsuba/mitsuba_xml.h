// Scenes in Mitsuba's XML, dialects 0.5, 0.6, 2 and 3.
#pragma once

#include <filesystem>
#include <string>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/load_options.h"

namespace pt {

/// Loads a scene and the meshes, textures and environment that it names. What we cannot do is
/// replaced by the nearest that we can, or left out, and reported through the options, once for
/// each kind. Throws Error, one line with file and line, for a file that is malformed or missing.
SceneData load_mitsuba_xml(const std::filesystem::path& path, const LoadOptions& options = {});

namespace mitsuba {
struct Element;
}

/// The same of a <scene> that somebody has made in memory.
SceneData load_mitsuba_scene(const mitsuba::Element& root, const std::string& name,
                             const LoadOptions& options);

}  // namespace pt
