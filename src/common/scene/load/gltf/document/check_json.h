// Checks of a glTF file's JSON that must come before tinygltf reads it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace pt::gltf {

/// What check_json took away or filled in.
struct Mended {
  bool changed = false;
  std::vector<std::string> lines;  ///< of what the user should know
};

/// Throws Error for a version other than 2.x, for an extension that the file requires and we lack,
/// and for a buffer whose bytes are not in the file: before anything else, since what else such a
/// file has wrong follows from that.
void check_promises(const nlohmann::json& root, const std::string& file, bool is_glb);

/// tinygltf 2.7 replaces a value of the wrong type or sign by the default without a word, recurses
/// as deeply as the JSON nests, follows the buffer views of images unchecked, and refuses files for
/// what concerns one picture, lamp or camera. Throws Error with the place of an index, a size or an
/// array of the wrong type, of a buffer's `data:` URI that is not base64 or of a type unknown to
/// tinygltf, and of a buffer view that exceeds its buffer. Takes away numbers and flags of the
/// wrong type, and gives pictures that have no bytes some that cannot be decoded. Leaves `extras`
/// and unknown extensions alone, up to a depth.
Mended check_json(nlohmann::json& root, const std::string& file);

}  // namespace pt::gltf
