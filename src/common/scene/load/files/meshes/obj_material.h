// MTL files: the materials of OBJ files.
#pragma once

#include <filesystem>
#include <string_view>

#include "common/scene/load/files/meshes/mesh_files.h"

namespace pt {

/// Appends the materials of an MTL file to those of `file`, each as the nearest of ours: glass
/// where light passes (illum 4, 6, 7, 9 or d < 0.5), metal where it is reflected (illum 3, 5, 8 or
/// metallic > 0.5), diffuse with a highlight where there is one (illum 2), else diffuse. What is
/// left out becomes a warning. Throws Error, without the file's name, for one that cannot be read.
void read_mtl(const std::filesystem::path& path, ObjFile& file);

/// The same of a file's content in memory; textures are beside `path`.
void decode_mtl(std::string_view bytes, const std::filesystem::path& path, ObjFile& file);

}  // namespace pt
