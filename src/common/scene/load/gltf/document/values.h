// Members of JSON objects as tinygltf keeps extensions.
#pragma once

#include <tiny_gltf.h>

#include "common/math/vec.h"

namespace pt::gltf {

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

}  // namespace pt::gltf
