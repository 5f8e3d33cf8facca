#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/scene/load/gltf/document.h"
#include "common/scene/load/gltf/read_model.h"

namespace pt::gltf {

std::size_t component_size(const File& file, int component_type, const std::string& place) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      file.fail(place, "componentType {}: expected 5120 to 5123, 5125 or 5126", component_type);
  }
}

Elements locate(const File& file, int view_index, std::size_t byte_offset, std::size_t count,
                int component_type, int components, const std::string& place) {
  const auto& view = file.at(file.model.bufferViews, view_index, "bufferViews", place);
  const auto& buffer = file.at(file.model.buffers, view.buffer, "buffers", place);
  const std::size_t size =
      component_size(file, component_type, place) * static_cast<std::size_t>(components);
  const std::size_t stride = view.byteStride == 0 ? size : view.byteStride;
  if (stride < size) {
    file.fail(place, "byteStride {} of bufferViews[{}] is less than an element's {} bytes", stride,
              view_index, size);
  }
  const std::size_t end = view.byteOffset > buffer.data.size()
                              ? 0
                              : std::min(view.byteLength, buffer.data.size() - view.byteOffset);
  // byte_offset + (count - 1) * stride + size <= end, without overflow
  const bool fits = count == 0 || (size <= end && byte_offset <= end - size &&
                                   (count - 1) <= (end - size - byte_offset) / stride);
  if (!fits) {
    file.fail(place,
              "{} elements of {} bytes from byte {} on exceed the {} bytes of bufferViews[{}]",
              count, size, byte_offset, end, view_index);
  }
  return {buffer.data.data() + view.byteOffset + byte_offset, count, stride, component_type,
          components};
}

namespace {

using Json = nlohmann::json;

constexpr int max_depth = 64;  // glTF itself nests about eight deep

/// What is wrong with a data: URI, or "".
std::string problem_of_data_uri(const std::string& uri) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos || !tinygltf::IsDataURI(uri)) {
    return fmt::format(
        "'{:.60}': expected data:TYPE;base64, with TYPE application/octet-stream, "
        "application/gltf-buffer, image/jpeg, image/png or image/bmp",
        uri.substr(0, comma));
  }
  std::string_view text = std::string_view(uri).substr(comma + 1);
  for (int i = 0; i < 2 && text.ends_with('='); ++i) text.remove_suffix(1);
  const auto is_base64 = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' ||
           c == '/';
  };
  const auto bad = std::find_if_not(text.begin(), text.end(), is_base64);
  if (bad == text.end() && text.size() % 4 != 1) return "";
  return fmt::format("invalid base64 at character {} of the data", bad - text.begin());
}

/// Arrays of numbers that tinygltf refuses in another length.
bool has_length(const std::string& key, const Json& value) {
  if (key == "baseColorFactor") return value.size() == 4;
  return key != "emissiveFactor" || value.size() == 3;
}

bool is_known_extension(std::string_view name) {
  return std::find(known_extensions.begin(), known_extensions.end(), name) !=
         known_extensions.end();
}

/// Takes away what may be left out, and throws for what may not.
class Walk {
 public:
  Walk(const std::string& file, Mended& mended) : file_(file), mended_(mended) {}

  /// `understood`: the value's members mean what `forms` says.
  void visit(Json& value, const std::string& place, int depth, bool understood,
             bool of_extensions) {
    if (depth > max_depth) fail(file_, place.substr(0, 80), "nested too deeply");
    if (value.is_array()) {
      std::size_t i = 0;
      for (Json& element : value) {
        if (element.is_structured()) {
          visit(element, fmt::format("{}[{}]", place, i), depth + 1, understood, false);
        }
        ++i;
      }
    } else if (value.is_object()) {
      for (auto member = value.begin(); member != value.end();) {
        const std::string key = member.key();
        const std::string member_place = place.empty() ? key : place + "." + key;
        const bool member_understood =
            understood && key != "extras" && (!of_extensions || is_known_extension(key));
        if (member_understood && !of_extensions && !is_right(member.value(), key, member_place)) {
          member = value.erase(member);
          continue;
        }
        if (member.value().is_structured()) {
          visit(member.value(), member_place, depth + 1, member_understood, key == "extensions");
        }
        ++member;
      }
    }
  }

 private:
  bool is_right(Json& value, const std::string& key, const std::string& place) {
    if (key == "baseColorFactor" && value.is_array() && value.size() == 3) {
      value.push_back(1);
      mended_.changed = true;
    }
    std::string expected = expected_form(key, value);
    if (expected.empty() && !has_length(key, value)) expected = "another number of components";
    if (expected.empty()) return true;
    if (!may_be_lost(key)) fail(file_, place, "expected " + expected);
    mended_.changed = true;
    mended_.lines.push_back(fmt::format("{}: expected {}: it is left out", place, expected));
    return false;
  }

  const std::string& file_;
  Mended& mended_;
};

/// Fills in what tinygltf takes for required, with values that the loader will not take for good.
struct Filler {
  Mended& mended;

  void ensure(Json& object, const char* key, const Json& value) const {
    if (object.contains(key)) return;
    object[key] = value;
    mended.changed = true;
  }

  void fill_camera(Json& camera) const {
    ensure(camera, "type", camera.contains("orthographic") ? "orthographic" : "perspective");
    if (camera["type"] == "orthographic") {
      ensure(camera, "orthographic", Json::object());
      for (const char* key : {"xmag", "ymag", "zfar", "znear"}) {
        ensure(camera["orthographic"], key, 0.0);
      }
    } else if (camera["type"] == "perspective") {
      ensure(camera, "perspective", Json::object());
      for (const char* key : {"yfov", "znear"}) ensure(camera["perspective"], key, 0.0);
    }
  }

  void fill_animation(Json& animation) const;

  void fill_light(Json& light) const {
    ensure(light, "type", "");
    if (light["type"] == "spot") ensure(light, "spot", Json::object());
  }
};

/// The array's objects; none where there is no array.
Json& objects_of(Json& root, const char* key) {
  thread_local Json none;
  none = Json::array();
  return root.is_object() && root.contains(key) ? root[key] : none;
}

void Filler::fill_animation(Json& animation) const {
  for (Json& channel : objects_of(animation, "channels")) {
    ensure(channel, "sampler", no_object);
    if (!channel.contains("target") || !channel["target"].is_object()) {
      channel["target"] = Json::object();
      mended.changed = true;
    }
    ensure(channel["target"], "node", no_object);
    ensure(channel["target"], "path", "");
  }
  for (Json& sampler : objects_of(animation, "samplers")) {
    for (const char* key : {"input", "output"}) ensure(sampler, key, no_object);
  }
}

/// Its content, and not the type that the URI names, says how a picture is decoded.
void mend_image(Json& image, std::size_t views, const std::string& place, Mended& mended) {
  static constexpr const char* undecodable = "data:image/png;base64,AAAA";
  std::string problem;
  if (image.contains("bufferView")) {
    mended.changed = image.erase("uri") > 0 || mended.changed;
    if (image["bufferView"].get<std::size_t>() < views) return;
    problem = fmt::format("bufferViews[{}] does not exist, there are {}",
                          image["bufferView"].get<std::size_t>(), views);
    image.erase("bufferView");
  } else if (!image.contains("uri")) {
    problem = "neither uri nor bufferView";
  } else if (const std::string uri = image["uri"]; uri.starts_with("data:")) {
    static constexpr std::string_view base64 = ";base64,";
    const std::size_t data = uri.find(base64);
    const std::string known = data == std::string::npos ? uri : "data:image/png" + uri.substr(data);
    problem = problem_of_data_uri(known);
    if (problem.empty() && data + base64.size() == uri.size()) problem = "no data";
    if (problem.empty() && !tinygltf::IsDataURI(uri)) {
      image["uri"] = known;
      mended.changed = true;
    }
  }
  if (problem.empty()) return;
  mended.lines.push_back(fmt::format("{}: {}: the picture is missing", place, problem));
  mended.changed = true;
  image["uri"] = undecodable;
}

std::uint64_t size_of(const Json& object, const char* key, const std::string& file,
                      const std::string& place) {
  const auto found = object.find(key);
  if (found == object.end()) fail(file, place, "{} is missing", key);
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
      fail(file, place, "buffers[{}] does not exist, there are {}", buffer, buffers.size());
    }
    const std::uint64_t size =
        size_of(buffers[buffer], "byteLength", file, fmt::format("buffers[{}]", buffer));
    const std::uint64_t offset = views[i].value("byteOffset", std::uint64_t{0});
    const std::uint64_t length = size_of(views[i], "byteLength", file, place);
    // Integers are below 2^31, so the sum does not wrap.
    if (length == 0 || offset + length > size) {
      fail(file, place, "bytes [{}, {}) are not within buffers[{}] of {} bytes", offset,
           offset + length, buffer, size);
    }
  }
}

/// A primitive whose indices have no bytes, which tinygltf takes for an error of the file: those of
/// an extension that compresses them.
void drop_empty_primitives(Json& root, Mended& mended) {
  const Json& accessors = objects_of(root, "accessors");
  const auto has_indices = [&](const Json& primitive) {
    if (!primitive.contains("indices") || !primitive["indices"].is_number()) return true;
    const auto index = primitive["indices"].get<std::size_t>();
    return index >= accessors.size() || accessors[index].contains("bufferView");
  };
  Json& meshes = objects_of(root, "meshes");
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    Json& primitives = objects_of(meshes[i], "primitives");
    for (std::size_t j = primitives.size(); j-- > 0;) {
      if (has_indices(primitives[j])) continue;
      const Json extensions = primitives[j].value("extensions", Json::object());
      mended.lines.push_back(fmt::format(
          "meshes[{}].primitives[{}]: {}: the primitive is left out", i, j,
          extensions.empty() ? "indices without a bufferView"
                             : fmt::format("{:.80} is not supported", extensions.begin().key())));
      mended.changed = true;
      primitives.erase(j);
    }
  }
}

bool starts_with_2(const Json& version) {
  return version.is_string() && version.get_ref<const std::string&>().starts_with("2.");
}

}  // namespace

void check_promises(const Json& root, const std::string& file, bool is_glb) {
  if (!root.is_object()) fail(file, "", "expected a JSON object");
  const auto asset = root.find("asset");
  const bool has_version = asset != root.end() && asset->is_object() && asset->contains("version");
  if (has_version && !starts_with_2((*asset)["version"])) {
    const Json& version = (*asset)["version"];
    fail(file, "asset.version", "{}: this version of glTF is not supported: expected 2.x",
         version.is_string() ? version.get_ref<const std::string&>() : "no text");
  }
  const auto meshes = root.find("meshes");
  if (!has_version && meshes != root.end() && meshes->is_object()) {
    fail(file, "asset.version",
         "missing, and meshes by name as in glTF 1.0, which is not supported: expected 2.x");
  }
  const auto required = root.find("extensionsRequired");
  if (required != root.end() && required->is_array()) {
    for (const Json& name : *required) {
      if (!name.is_string()) continue;
      const auto& text = name.get_ref<const std::string&>();
      if (!is_known_extension(text) &&
          std::ranges::find(image_extensions, text) == image_extensions.end()) {
        fail(file, "extensionsRequired", "{:.80} is not supported", text);
      }
    }
  }
  const auto buffers = root.find("buffers");
  if (buffers == root.end() || !buffers->is_array()) return;
  for (std::size_t i = is_glb ? 1 : 0; i < buffers->size(); ++i) {
    const Json& buffer = (*buffers)[i];
    if (!buffer.is_object() || buffer.contains("uri")) continue;
    std::string why = "missing: expected a file or data";
    if (buffer.contains("extensions") && buffer["extensions"].is_object() &&
        !buffer["extensions"].empty()) {
      why = fmt::format("missing: the data is in {:.80}, which is not supported",
                        buffer["extensions"].begin().key());
    }
    fail(file, fmt::format("buffers[{}].uri", i), why);
  }
}

Mended check_json(Json& root, const std::string& file) {
  if (!root.is_object()) fail(file, "", "expected a JSON object");
  Mended mended;
  Walk(file, mended).visit(root, "", 0, true, false);
  check_buffer_views(root, file);
  for (std::size_t i = 0; i < objects_of(root, "buffers").size(); ++i) {
    const std::string uri = root["buffers"][i].value("uri", "");
    const std::string problem = uri.starts_with("data:") ? problem_of_data_uri(uri) : "";
    if (!problem.empty()) fail(file, fmt::format("buffers[{}].uri", i), problem);
  }
  const std::size_t views = objects_of(root, "bufferViews").size();
  for (std::size_t i = 0; i < objects_of(root, "images").size(); ++i) {
    mend_image(root["images"][i], views, fmt::format("images[{}]", i), mended);
  }
  drop_empty_primitives(root, mended);
  const Filler filler{mended};
  for (Json& camera : objects_of(root, "cameras")) filler.fill_camera(camera);
  for (Json& animation : objects_of(root, "animations")) filler.fill_animation(animation);
  if (root.contains("extensions") && root["extensions"].contains("KHR_lights_punctual")) {
    for (Json& light : objects_of(root["extensions"]["KHR_lights_punctual"], "lights")) {
      filler.fill_light(light);
    }
  }
  return mended;
}

}  // namespace pt::gltf
