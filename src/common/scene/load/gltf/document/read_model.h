// From a file's bytes to tinygltf's objects.
#pragma once

#include <tiny_gltf.h>

#include <filesystem>
#include <string>
#include <vector>

namespace pt::gltf {

struct ReadModel {
  tinygltf::Model model;
  std::vector<std::string>
      warnings;  ///< of names that differ from their files' in case, of what was mended
};

/// Reads a .gltf or .glb file (its first bytes decide) with its buffers. Images stay encoded:
/// Image::image holds the file's content, or nothing where a buffer view has it or where the file
/// is missing. Throws Error as load_gltf does.
ReadModel read_model(const std::filesystem::path& path);

}  // namespace pt::gltf
