// Scenes in glTF 2.0 (Khronos, 'glTF 2.0 Specification', version 2.0.1), .gltf and .glb.
#pragma once

#include <filesystem>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/load_options.h"

namespace pt {

/// The default scene of the file (its first one where it names none). A mesh that one node uses is
/// put into world space, one that several use becomes a group and instances. Lights' candela, lux
/// and nits are taken as W/sr, W/m^2 and W/(m^2 sr). A scene without a camera gets one that frames
/// it, one that its own light does not show default lighting; `options.warn` is told so.
///
/// Meshes have the shape of their default weights, and skins that of their nodes. What has no
/// counterpart here is replaced by the nearest that has, and reported once a kind: what the
/// principled BSDF has otherwise, colours of vertices beside textures by their mean. Ignored:
/// points and lines, animations. A value or an element that cannot be used is left out, with a
/// warning.
///
/// Throws Error, one line with the file and the object's place in it
/// (meshes[3].primitives[0].attributes.POSITION), for a file that is missing, whose structure is
/// malformed or that needs an extension that we lack.
SceneData load_gltf(const std::filesystem::path& path, const LoadOptions& options);

}  // namespace pt
