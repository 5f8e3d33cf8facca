// For tests of the glTF loader: files made of JSON and bytes.
#pragma once

#include <cstring>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/scene/load/load_scene.h"
#include "temp_folder.h"

namespace pt {

using Json = nlohmann::json;

inline std::string base64(std::string_view bytes) {
  static constexpr char digits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      const auto byte = i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0u;
      word = word << 8 | byte;
    }
    for (std::size_t j = 0; j < 4; ++j) {
      text += i + j > bytes.size() ? '=' : digits[word >> (18 - 6 * j) & 63];
    }
  }
  return text;
}

template <class T>
std::string bytes_of(std::initializer_list<T> values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.begin(), bytes.size());
  return bytes;
}

/// A glTF file in the making: JSON, and one buffer that grows.
struct GltfMaker {
  Json root = {{"asset", {{"version", "2.0"}}},
               {"scene", 0},
               {"scenes", {{{"nodes", {0}}}}},
               {"nodes", {{{"mesh", 0}}}}};
  std::string buffer;

  GltfMaker() {
    for (const char* name : {"accessors", "bufferViews", "meshes"}) root[name] = Json::array();
  }

  /// Appends bytes as a buffer view, 4-byte aligned; its number.
  int view(const std::string& bytes, int stride = 0) {
    buffer.resize((buffer.size() + 3) / 4 * 4);
    Json json = {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
    if (stride) json["byteStride"] = stride;
    buffer += bytes;
    return push("bufferViews", json);
  }

  int push(const char* array, const Json& object) {
    root[array].push_back(object);
    return static_cast<int>(root[array].size()) - 1;
  }

  int accessor(int view, int component_type, std::size_t count, const char* type) {
    return push("accessors", {{"bufferView", view},
                              {"componentType", component_type},
                              {"count", count},
                              {"type", type}});
  }

  int floats(std::initializer_list<float> values, const char* type) {
    const std::size_t width = std::string(type) == "SCALAR" ? 1u : std::size_t(type[3] - '0');
    return accessor(view(bytes_of(values)), 5126, values.size() / width, type);
  }

  template <class T>
  int indices(std::initializer_list<T> values) {
    return accessor(view(bytes_of(values)), sizeof(T) == 1 ? 5121 : (sizeof(T) == 2 ? 5123 : 5125),
                    values.size(), "SCALAR");
  }

  /// A mesh of one primitive; its number.
  int mesh(const Json& primitive) { return push("meshes", {{"primitives", {primitive}}}); }

  Json with_buffer(const std::string& uri) const {
    Json json = root;
    json["buffers"] = {{{"byteLength", buffer.size()}}};
    if (!uri.empty()) json["buffers"][0]["uri"] = uri;
    return json;
  }

  /// The buffer as a data: URI.
  std::string gltf() const {
    return with_buffer("data:application/octet-stream;base64," + base64(buffer)).dump();
  }

  std::string glb() const {
    std::string json = with_buffer("").dump();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string bin = buffer;
    bin.resize((bin.size() + 3) / 4 * 4, '\0');
    const auto word = [](std::size_t value) {
      return bytes_of({static_cast<std::uint32_t>(value)});
    };
    return "glTF" + word(2) + word(28 + json.size() + bin.size()) + word(json.size()) + "JSON" +
           json + word(bin.size()) + std::string("BIN\0", 4) + bin;
  }
};

/// One triangle in the plane z = 0: (0, 0), (1, 0), (0, 2).
inline GltfMaker triangle_file() {
  GltfMaker maker;
  const int positions = maker.floats({0, 0, 0, 1, 0, 0, 0, 2, 0}, "VEC3");
  maker.mesh({{"attributes", {{"POSITION", positions}}}});
  return maker;
}

/// The triangle with a material.
inline GltfMaker with_material(const Json& material) {
  GltfMaker maker = triangle_file();
  maker.root["materials"] = Json::array({material});
  maker.root["meshes"][0]["primitives"][0]["material"] = 0;
  return maker;
}

/// Loads `content` and keeps what was said.
struct Loaded {
  std::vector<std::string> messages;
  SceneData scene;

  explicit Loaded(const std::string& content, bool strict = false,
                  const std::string& name = "scene.gltf", LoadOptions options = {}) {
    TempFolder folder;
    write_text(folder.file(name), content);
    options.strict = strict;
    options.warn = [this](const std::string& message) { messages.push_back(message); };
    scene = load_gltf(folder.file(name), options);
  }

  explicit Loaded(const GltfMaker& maker, bool strict = false) : Loaded(maker.gltf(), strict) {}

  /// How many messages contain `part`.
  std::size_t count(const std::string& part) const {
    return static_cast<std::size_t>(std::count_if(
        messages.begin(), messages.end(),
        [&](const std::string& message) { return message.find(part) != std::string::npos; }));
  }
};

/// The file with its animations at a time.
inline Loaded at_time(const GltfMaker& maker, float time, const std::string& animation = "",
                      bool strict = false) {
  LoadOptions options;
  options.time = time;
  options.animation = animation;
  return Loaded(maker.gltf(), strict, "scene.gltf", options);
}

}  // namespace pt
