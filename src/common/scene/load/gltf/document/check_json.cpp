#include "common/scene/load/gltf/document/check_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/scene/load/gltf/document/file.h"
#include "common/scene/load/gltf/document/json_forms.h"

namespace pt::gltf {

namespace {

using Json = nlohmann::json;

constexpr int max_depth = 64;  // glTF itself nests about eight deep

void check_data_uri(const std::string& uri, const std::string& file, const std::string& place) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos || !tinygltf::IsDataURI(uri)) {
    fail(file, place,
         fmt::format("'{:.60}': expected data:TYPE;base64, with TYPE application/octet-stream, "
                     "application/gltf-buffer, image/jpeg, image/png or image/bmp",
                     uri.substr(0, comma)));
  }
  std::string_view text = std::string_view(uri).substr(comma + 1);
  for (int i = 0; i < 2 && text.ends_with('='); ++i) text.remove_suffix(1);
  const auto is_base64 = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' ||
           c == '/';
  };
  const auto bad = std::find_if_not(text.begin(), text.end(), is_base64);
  if (bad != text.end() || text.size() % 4 == 1) {
    fail(file, place,
         fmt::format("invalid base64 at character {} of the data", bad - text.begin()));
  }
}

void check_value(const Json& value, const std::string& key, const std::string& file,
                 const std::string& place) {
  const std::string expected = expected_form(key, value);
  if (!expected.empty()) fail(file, place, "expected " + expected);
  if (key == "uri" && value.get_ref<const std::string&>().starts_with("data:")) {
    check_data_uri(value.get_ref<const std::string&>(), file, place);
  }
}

bool is_known_extension(std::string_view name) {
  return std::find(known_extensions.begin(), known_extensions.end(), name) !=
         known_extensions.end();
}

/// `understood`: the value's members mean what `forms` says.
void walk(const Json& value, const std::string& file, const std::string& place, int depth,
          bool understood, bool of_extensions) {
  if (depth > max_depth) fail(file, place.substr(0, 80), "nested too deeply");
  if (value.is_array()) {
    std::size_t i = 0;
    for (const Json& element : value) {
      if (element.is_structured()) {
        walk(element, file, fmt::format("{}[{}]", place, i), depth + 1, understood, false);
      }
      ++i;
    }
  } else if (value.is_object()) {
    for (const auto& [key, member] : value.items()) {
      const std::string member_place = place.empty() ? key : place + "." + key;
      const bool member_understood =
          understood && key != "extras" && (!of_extensions || is_known_extension(key));
      if (member_understood && !of_extensions) check_value(member, key, file, member_place);
      if (member.is_structured()) {
        walk(member, file, member_place, depth + 1, member_understood, key == "extensions");
      }
    }
  }
}

std::uint64_t size_of(const Json& object, const char* key, const std::string& file,
                      const std::string& place) {
  const auto found = object.find(key);
  if (found == object.end()) fail(file, place, fmt::format("{} is missing", key));
  return found->get<std::uint64_t>();
}

void check_buffer_views(const Json& root, const std::string& file) {
  const Json none = Json::array();
  const Json& buffers = root.contains("buffers") ? root["buffers"] : none;
  const Json& views = root.contains("bufferViews") ? root["bufferViews"] : none;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::string place = fmt::format("bufferViews[{}]", i);
    const std::uint64_t buffer = size_of(views[i], "buffer", file, place);
    if (buffer >= buffers.size()) {
      fail(file, place,
           fmt::format("buffers[{}] does not exist, there are {}", buffer, buffers.size()));
    }
    const std::uint64_t size =
        size_of(buffers[buffer], "byteLength", file, fmt::format("buffers[{}]", buffer));
    const std::uint64_t offset = views[i].value("byteOffset", std::uint64_t{0});
    const std::uint64_t length = size_of(views[i], "byteLength", file, place);
    // Integers are below 2^31, so the sum does not wrap.
    if (length == 0 || offset + length > size) {
      fail(file, place,
           fmt::format("bytes [{}, {}) are not within buffers[{}] of {} bytes", offset,
                       offset + length, buffer, size));
    }
  }
}

}  // namespace

void check_json(const Json& root, const std::string& file) {
  if (!root.is_object()) fail(file, "", "expected a JSON object");
  walk(root, file, "", 0, true, false);
  check_buffer_views(root, file);
}

}  // namespace pt::gltf
