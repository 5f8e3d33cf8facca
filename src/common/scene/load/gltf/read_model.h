// From a file's bytes to tinygltf's objects: what its JSON may be, and what is mended.
#pragma once

#include <tiny_gltf.h>

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/scene/load/gltf/document.h"

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

// Elements of an accessor where they lie: in a part of a buffer.

/// Strided elements, checked to lie within their buffer.
struct Elements {
  const unsigned char* first = nullptr;  ///< null: all zeros
  std::size_t count = 0, stride = 0;
  int component_type = 0;
  int components = 1;

  template <class T>
  T component(std::size_t element, int i) const {
    T value;
    std::memcpy(&value, first + element * stride + static_cast<std::size_t>(i) * sizeof(T),
                sizeof value);
    return value;
  }
};

/// Bytes of a component; an Error at `place` for types that glTF 2.0 does not have.
std::size_t component_size(const File& file, int component_type, const std::string& place);

/// `count` elements from `byte_offset` of a buffer view on. An Error at `place` where they exceed
/// it.
Elements locate(const File& file, int view_index, std::size_t byte_offset, std::size_t count,
                int component_type, int components, const std::string& place);

// Which kind of value each key of glTF's JSON has.

/// What a value of `key` should be, in words, if `value` is something else; else "". Keys that are
/// not known may be anything. Integers are from 0 to 2^31 - 1, as tinygltf stores them.
std::string expected_form(const std::string& key, const nlohmann::json& value);

/// Whether a value of the wrong form may be left out: it is a quantity or a flag, not part of the
/// file's structure.
bool may_be_lost(const std::string& key);

// Checks of a glTF file's JSON that must come before tinygltf reads it.

/// Filled in where an animation does not say which object it means.
inline constexpr int no_object = 0x7fffffff;

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
