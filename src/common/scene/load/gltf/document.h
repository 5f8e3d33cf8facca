// A glTF file while it is read: its objects, extensions and arrays, and what the user is told.
#pragma once

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/error/error.h"
#include "common/math/vec.h"
#include "common/scene/load/files/load_options.h"

namespace pt::gltf {

/// Image formats without a decoder: a texture with only such an image is left out with a warning.
inline constexpr std::array<std::string_view, 4> image_extensions = {
    "EXT_texture_avif", "EXT_texture_webp", "KHR_texture_basisu", "MSFT_texture_dds"};

/// The extensions that are understood; others are ignored, or an Error where the file needs them.
inline constexpr std::array<std::string_view, 12> known_extensions = {
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform"};

/// Bytes of a message: names in files may be as long as the files.
inline constexpr std::size_t longest_message = 500;

/// A place is a path of names and numbers such as meshes[3].primitives[0].
[[noreturn]] inline void fail(const std::string& file, const std::string& place,
                              const std::string& message) {
  throw Error(fmt::format(
      "{}: {}", file,
      clipped(fmt::format("{}{}{}", place, place.empty() ? "" : ": ", message), longest_message)));
}

/// The same of a message with values in it.
template <class First, class... Rest>
[[noreturn]] void fail(const std::string& file, const std::string& place,
                       fmt::format_string<First, Rest...> text, First&& first, Rest&&... rest) {
  fail(file, place, fmt::format(text, std::forward<First>(first), std::forward<Rest>(rest)...));
}

class File {
 public:
  File(std::string name, tinygltf::Model objects, const LoadOptions& load_options)
      : model(std::move(objects)), name_(std::move(name)), options_(load_options) {}

  tinygltf::Model model;  ///< only pose_nodes changes it
  /// Zeros read so far for accessors without a bufferView: a file of a few bytes must not fill the
  /// memory.
  mutable std::size_t zeros = 0;

  [[noreturn]] void fail(const std::string& place, const std::string& message) const {
    gltf::fail(name_, place, message);
  }
  template <class First, class... Rest>
  [[noreturn]] void fail(const std::string& place, fmt::format_string<First, Rest...> text,
                         First&& first, Rest&&... rest) const {
    fail(place, fmt::format(text, std::forward<First>(first), std::forward<Rest>(rest)...));
  }

  /// Reports what is ignored or replaced, and by what; the same message once, with its first place.
  void report(const std::string& place, const std::string& message) {
    const std::string text = clipped(message, longest_message);
    if (!reported_.insert(text).second) return;
    last_report_ =
        clipped(fmt::format("{}{}{}", place, place.empty() ? "" : ": ", text), longest_message);
    options_.report(fmt::format("{}: {}", name_, last_report_));
  }
  template <class First, class... Rest>
  void report(const std::string& place, fmt::format_string<First, Rest...> text, First&& first,
              Rest&&... rest) {
    report(place, fmt::format(text, std::forward<First>(first), std::forward<Rest>(rest)...));
  }
  const std::string& last_report() const { return last_report_; }

  /// Reports that something is wrong at `place` and what is used instead: the same kind once,
  /// whatever its numbers. `kind` is what all its messages begin with.
  template <class... Values>
  void report_value(const std::string& place, const std::string& kind,
                    fmt::format_string<Values...> text, Values&&... values) {
    if (kinds_.insert(kind).second)
      report(place, fmt::format(text, std::forward<Values>(values)...));
  }
  /// A name for a part of the file.
  std::string describe(const std::string& place) const {
    return name_ + ": " + clipped(place, longest_message);
  }

  /// Says what was chosen where the file leaves it open.
  void note(const std::string& message) const {
    if (options_.warn) options_.warn(fmt::format("{}: {}", name_, message));
  }

  /// objects[index]; an Error at `place` if there is no such object. `kind` is the array's name.
  template <class T>
  const T& at(const std::vector<T>& objects, int index, const char* kind,
              const std::string& place) const {
    if (index < 0 || static_cast<std::size_t>(index) >= objects.size()) {
      fail(place, "{}[{}] does not exist, there are {}", kind, index, objects.size());
    }
    return objects[static_cast<std::size_t>(index)];
  }

  /// Whether there is objects[index]. If not, that is reported at `place`, with what is done
  /// instead.
  template <class T>
  bool has(const std::vector<T>& objects, int index, const char* kind, const std::string& place,
           const char* instead) {
    if (index >= 0 && static_cast<std::size_t>(index) < objects.size()) return true;
    report(place, "{}[{}] does not exist, there are {}: {}", kind, index, objects.size(), instead);
    return false;
  }

 private:
  std::string name_;
  const LoadOptions& options_;
  std::set<std::string> reported_, kinds_;
  std::string last_report_;
};

// Members of JSON objects as tinygltf keeps extensions.

/// The object's member, or a null value.
inline const tinygltf::Value& member(const tinygltf::Value& object, const char* key) {
  static const tinygltf::Value none;
  return object.IsObject() && object.Has(key) ? object.Get(key) : none;
}

/// An extension of an object, or null.
inline const tinygltf::Value* find_extension(const tinygltf::ExtensionMap& extensions,
                                             const char* name) {
  const auto found = extensions.find(name);
  return found == extensions.end() ? nullptr : &found->second;
}

inline float number_or(const tinygltf::Value& object, const char* key, float fallback) {
  const tinygltf::Value& value = member(object, key);
  return value.IsNumber() ? static_cast<float>(value.GetNumberAsDouble()) : fallback;
}

inline int integer_or(const tinygltf::Value& object, const char* key, int fallback) {
  const tinygltf::Value& value = member(object, key);
  return value.IsNumber() ? value.GetNumberAsInt() : fallback;
}

/// The first numbers of an array; the fallback's where it is shorter.
template <class Vector>
Vector vector_or(const tinygltf::Value& object, const char* key, const Vector& fallback) {
  const tinygltf::Value& value = member(object, key);
  Vector result = fallback;
  for (int i = 0; i < Vector::length() && static_cast<std::size_t>(i) < value.ArrayLen(); ++i) {
    if (value.Get(i).IsNumber()) result[i] = static_cast<float>(value.Get(i).GetNumberAsDouble());
  }
  return result;
}

// Accessors: typed, strided, perhaps sparse arrays in buffers (specification, section 3.6.2).

/// The accessor's elements, `components` (1 to 4, or 16) numbers each. Integers are converted:
/// normalised ones to [0, 1] or [-1, 1], others by value. Throws Error at `place` where the
/// accessor has another shape or exceeds its buffer.
std::vector<float> read_floats(const File& file, int accessor, int components,
                               const std::string& place);

/// Indices of 8, 16 or 32 bits; errors as above.
std::vector<std::uint32_t> read_indices(const File& file, int accessor, const std::string& place);

}  // namespace pt::gltf
