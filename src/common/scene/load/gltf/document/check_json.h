// Checks of a glTF file's JSON that must come before tinygltf reads it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace pt::gltf {

/// tinygltf 2.7 replaces a value of the wrong type or sign by the default without a word, recurses
/// as deeply as the JSON nests, and follows the buffer views of images unchecked. Throws Error with
/// the place of a value of the wrong type, of a negative or huge integer, of a `data:` URI that is
/// not base64 or of a type unknown to tinygltf, and of a buffer view that exceeds its buffer.
/// Leaves `extras` and unknown extensions alone, up to a depth.
void check_json(const nlohmann::json& root, const std::string& file);

}  // namespace pt::gltf
