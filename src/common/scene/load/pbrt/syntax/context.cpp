#include "common/scene/load/pbrt/syntax/context.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/load/files/whole_file.h"

namespace pt::pbrt {

bool TextureMapping::operator==(const TextureMapping& other) const {
  return kind == other.kind && u_axis == other.u_axis && v_axis == other.v_axis &&
         shift == other.shift &&
         std::equal(to_texture.row, to_texture.row + 3, other.to_texture.row);
}

Vec2 TextureMapping::at(const Vec3& point) const {
  const Vec3 p = to_texture.point(point);
  if (kind == MappingKind::planar) {
    return shift + Vec2(glm::dot(p, u_axis), glm::dot(p, v_axis));
  }
  const float turn = std::atan2(p.y, p.x) * 0.5f * inverse_pi;
  if (kind == MappingKind::cylindrical) return {0.5f + turn, p.z};
  const float length = glm::length(p);
  const float cosine = length > 0.0f ? glm::clamp(p.z / length, -1.0f, 1.0f) : 1.0f;
  return {std::acos(cosine) * inverse_pi, turn < 0.0f ? turn + 1.0f : turn};
}

TextureMapping common_mapping(const std::vector<TextureMapping>& mappings,
                              const FileLocation& place, Reporter& reporter) {
  if (mappings.empty()) return {};
  for (const TextureMapping& mapping : mappings) {
    if (mapping == mappings.front()) continue;
    reporter.warn_once("mappings", place,
                       "textures of different mappings on one surface are not supported: uv is "
                       "used for all");
    return {};
  }
  return mappings.front();
}

namespace {

std::string text_of(const Color& c) { return fmt::format("{} {} {}", c.x, c.y, c.z); }

std::string key_of(const MaterialDescription& m) {
  std::string key = fmt::format("{} {} {} {} {}", static_cast<int>(m.kind), m.one_sided,
                                static_cast<int>(m.node), m.children[0], m.children[1]);
  if (m.is_boundary) key += fmt::format(" {} {} {}", m.passes, m.media.outside, m.media.inside);
  for (const pt::Parameter& p : m.parameters)
    key += fmt::format(" {} {}", text_of(p.value), p.texture);
  key += fmt::format(" {} {} {}", text_of(m.emission.radiance), m.emission.texture,
                     m.emission.texture_mean);
  return key + fmt::format(" {} {} {} {}", m.opacity.offset, m.opacity.scale, m.opacity.texture,
                           m.opacity.cutoff);
}

}  // namespace

std::uint32_t Context::add_material(const MaterialDescription& material) {
  const auto [entry, is_new] = materials_.try_emplace(key_of(material), 0);
  if (is_new) entry->second = scene.add_material(material);
  return entry->second;
}

void Context::add_mapping(const TextureMapping& mapping) {
  const bool is_known = !mappings.empty() && mappings.front() == mapping;
  if (!is_known && mappings.size() < 2) mappings.push_back(mapping);
}

bool Context::has_alpha(const std::filesystem::path& path) {
  const auto [entry, is_new] = alphas_.try_emplace(path, false);
  if (!is_new) return entry->second;
  return entry->second = read_texture_image(path).has_alpha();
}

namespace {

/// A path of Windows whose backslashes were taken for escapes: "textures\\tree.png".
std::string with_slashes(const std::string& name) {
  static const std::map<char, std::string> letters = {{'\b', "/b"}, {'\f', "/f"}, {'\n', "/n"},
                                                      {'\r', "/r"}, {'\t', "/t"}, {'\\', "/"}};
  std::string path;
  for (const char c : name) {
    const auto letter = letters.find(c);
    path += letter == letters.end() ? std::string(1, c) : letter->second;
  }
  return path;
}

}  // namespace

std::filesystem::path Context::resolve(const FileLocation& place, const std::string& name) {
  return find(name,
              [&](const std::string& line) { reporter.warn_once("case " + name, place, line); });
}

std::filesystem::path Context::find(const std::string& name, const WarnOfName& warn) const {
  std::filesystem::path found = find_file(description.folder, name, warn);
  if (const std::string other = with_slashes(name); found.empty() && other != name) {
    found = find_file(description.folder, other, warn);
  }
  return found.empty() ? description.folder / name : found;
}

}  // namespace pt::pbrt
