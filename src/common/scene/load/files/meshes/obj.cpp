#include "common/scene/load/files/meshes/obj.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "common/error/error.h"
#include "common/image/tone_mapping.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/text.h"
#include "common/scene/load/files/whole_file.h"

namespace pt {

namespace {

/// Neighbours for neighbouring positions where all three numbers grow together, as in most files.
std::uint64_t hash_of(const ObjCorner& corner) {
  std::uint64_t hash = std::uint64_t{corner.uv - corner.position} * 0xbf58476d1ce4e5b9u;
  hash = (hash ^ (hash >> 32) ^ (corner.normal - corner.position)) * 0x94d049bb133111ebu;
  return 2 * std::uint64_t{corner.position} + (hash ^ (hash >> 32));
}

}  // namespace

std::uint32_t& ObjMeshBuilder::slot_of(const ObjCorner& corner) {
  for (std::uint64_t i = hash_of(corner);; ++i) {
    std::uint32_t& slot = slots_[i & (slots_.size() - 1)];
    if (slot == obj_none || corners_[slot] == corner) return slot;
  }
}

void ObjMeshBuilder::double_slots() {
  slots_.assign(std::max<std::size_t>(16, 2 * slots_.size()), obj_none);
  for (std::uint32_t vertex = 0; vertex < corners_.size(); ++vertex)
    slot_of(corners_[vertex]) = vertex;
}

std::uint32_t ObjMeshBuilder::vertex_of(const ObjCorner& corner, const ObjVertices& vertices) {
  if (2 * corners_.size() >= slots_.size()) double_slots();
  std::uint32_t& slot = slot_of(corner);
  if (slot != obj_none) return slot;
  slot = static_cast<std::uint32_t>(corners_.size());
  corners_.push_back(corner);
  has_uvs_ |= corner.uv != obj_none;
  has_normals_ |= corner.normal != obj_none;
  mesh_.positions.push_back(vertices.positions[corner.position]);
  if (corner.position < vertices.colors.size()) {
    mesh_.colors.resize(slot, Color(1.0f));
    mesh_.colors.push_back(vertices.colors[corner.position]);
  }
  mesh_.uvs.push_back(corner.uv == obj_none ? Vec2(0.0f) : vertices.uvs[corner.uv]);
  mesh_.normals.push_back(corner.normal == obj_none ? Vec3(0.0f) : vertices.normals[corner.normal]);
  return slot;
}

void ObjMeshBuilder::add_face(const std::vector<ObjCorner>& corners, const ObjVertices& vertices) {
  const std::uint32_t a = vertex_of(corners[0], vertices);
  std::uint32_t b = vertex_of(corners[1], vertices);
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const std::uint32_t c = vertex_of(corners[i], vertices);
    mesh_.triangles.push_back({{a, b, c}});
    b = c;
  }
  fans_.add(corners.size() - 2);
}

Mesh ObjMeshBuilder::finish(std::vector<std::string>* warnings) && {
  fans_.cut_concave(mesh_, warnings);
  if (!has_uvs_) mesh_.uvs = {};
  if (!has_normals_) mesh_.normals = {};
  if (!mesh_.colors.empty()) mesh_.colors.resize(mesh_.positions.size(), Color(1.0f));
  return std::move(mesh_);
}

namespace {

float next_float(std::string_view& line) {
  return static_cast<float>(parse_number(next_word(line)));
}

Vec3 next_vec3(std::string_view& line) {
  const float x = next_float(line), y = next_float(line), z = next_float(line);
  return {x, y, z};
}

bool all_finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

Vec3 next_position(std::string_view& line) {
  const Vec3 p = next_vec3(line);
  if (all_finite(p)) return p;
  throw Error(fmt::format("position ({}, {}, {}), expected finite numbers", p.x, p.y, p.z));
}

/// Texture coordinates: a missing v is 0.
Vec2 next_vec2(std::string_view& line) {
  const float x = next_float(line);
  line = trim(line);
  return {x, line.empty() ? 0.0f : next_float(line)};
}

/// An index as files have them: from 1, or from -1 backwards from the last so far.
std::uint32_t parse_index(std::string_view text, const char* what, std::size_t count) {
  std::int64_t index = 0;
  const auto [stop, failure] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (failure == std::errc::invalid_argument || stop != text.data() + text.size()) {
    throw Error(fmt::format("expected the number of a {}, found {}", what, in_quotes(text, 40)));
  }
  const auto signed_count = static_cast<std::int64_t>(count);
  if (failure != std::errc{} || index == 0 || index > signed_count || index < -signed_count) {
    throw Error(fmt::format("{} {}, of {} so far", what, clipped(text, 40), count));
  }
  return static_cast<std::uint32_t>(index > 0 ? index - 1 : signed_count + index);
}

/// Takes what is before the next slash, and the slash, off the front of a corner.
std::string_view next_part(std::string_view& corner) {
  const auto end = std::find(corner.begin(), corner.end(), '/');
  const std::string_view part(corner.begin(), end);
  corner.remove_prefix(std::min(part.size() + 1, corner.size()));
  return part;
}

class ObjLines {
 public:
  ObjLines(ObjSink& sink, CountedWarnings& warnings) : sink_(sink), warnings_(warnings) {}

  void read(std::string_view line, std::size_t line_number) {
    line_number_ = line_number;
    const std::string_view keyword = next_word(line);
    if (keyword == "v") {
      read_position(line);
    } else if (keyword == "vt") {
      vertices_.uvs.push_back(read_or(Vec2(0.0f), "it is (0, 0)", [&] { return next_vec2(line); }));
    } else if (keyword == "vn") {
      // One without a direction: see mesh_files.h.
      vertices_.normals.push_back(
          read_or(Vec3(0.0f), "that of the triangle is used", [&] { return next_vec3(line); }));
    } else if (keyword == "f") {
      read_face(line);
    } else if (keyword == "usemtl") {
      sink_.use_material(trim(line), line_number);
    } else if (keyword == "mtllib") {
      sink_.read_library(trim(line));
    } else if (keyword == "curv" || keyword == "surf") {
      lose("a curve or surface", "free-form curves and surfaces are left out");
    }
  }

 private:
  /// What `instead` says becomes of an element.
  void lose(const char* instead, std::string_view why) {
    warnings_.add(instead, fmt::format("line {}: {}", line_number_, why));
  }

  /// What `read` returns, or where it throws `fallback`, of which `instead` tells.
  template <class Value, class Read>
  Value read_or(const Value& fallback, const char* instead, const Read& read) {
    try {
      return read();
    } catch (const Error& error) {
      lose(instead, fmt::format("{}: {}", error.what(), instead));
      return fallback;
    }
  }

  /// One that is wrong keeps its number, and the faces that name it are left out.
  void read_position(std::string_view line) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    vertices_.positions.push_back(read_or(Vec3(nan), "faces that use the vertex are left out",
                                          [&] { return next_position(line); }));
    if (!all_finite(vertices_.positions.back())) return;
    if (const std::optional<Color> color = read_or(std::optional<Color>(), "the vertex is white",
                                                   [&] { return color_in(line); })) {
      vertices_.colors.resize(vertices_.positions.size() - 1, Color(1.0f));
      vertices_.colors.push_back(*color);
    }
  }

  /// What follows a position: a weight, a colour in the sRGB curve, or both.
  static std::optional<Color> color_in(std::string_view rest) {
    if (trim(rest).empty() || trim(rest).starts_with('#')) return {};
    std::string_view words[4];
    std::size_t count = 0;
    while (count < 4 && !(words[count] = next_word(rest)).empty() &&
           !words[count].starts_with('#')) {
      ++count;
    }
    if (count < 3) return {};
    Color color;
    for (int i = 0; i < 3; ++i) {
      std::string_view word = words[count - 3 + static_cast<std::size_t>(i)];
      const float value = next_float(word);
      color[i] = value > 0.0f ? srgb_curve.decode(std::min(value, 1.0f)) : 0.0f;
    }
    return color;
  }

  /// v, v/vt, v//vn or v/vt/vn.
  ObjCorner parse_corner(std::string_view word) {
    std::string_view parts[3];
    for (std::string_view& part : parts) part = next_part(word);
    if (!word.empty()) throw Error("a corner with more than three indices");
    ObjCorner corner{parse_index(parts[0], "vertex", vertices_.positions.size()), obj_none,
                     obj_none};
    if (!all_finite(vertices_.positions[corner.position])) {
      throw Error(fmt::format("vertex {} is not valid", clipped(parts[0], 40)));
    }
    if (!parts[1].empty()) {
      corner.uv = read_or(obj_none, "the corner has no texture coordinates", [&] {
        return parse_index(parts[1], "texture vertex", vertices_.uvs.size());
      });
    }
    if (!parts[2].empty()) {
      corner.normal = read_or(obj_none, "the corner has the normal of its triangle", [&] {
        return parse_index(parts[2], "normal", vertices_.normals.size());
      });
    }
    return corner;
  }

  void read_face(std::string_view line) {
    const bool is_whole = read_or(false, "the face is left out", [&] {
      corners_.clear();
      for (std::string_view word; !(word = next_word(line)).empty();) {
        if (word.starts_with('#')) break;
        corners_.push_back(parse_corner(word));
      }
      return true;
    });
    if (!is_whole) return;
    if (corners_.size() >= 3) return sink_.add_face(corners_, vertices_);
    lose("too few vertices", fmt::format("a face with {} vertices, expected 3 or more: the face is "
                                         "left out",
                                         corners_.size()));
  }

  ObjSink& sink_;
  CountedWarnings& warnings_;
  std::size_t line_number_ = 0;
  ObjVertices vertices_;
  std::vector<ObjCorner> corners_;  // of one face; kept for its memory
};

/// Takes the next line off the front of `text`; a \ at its end continues it, which `joined` then
/// holds. Adds the lines taken to `number`.
std::string_view next_line(std::string_view& text, std::string& joined, std::size_t& line_number) {
  joined.clear();
  for (;;) {
    std::size_t end = 0;  // find_first_of() calls memchr for each character
    while (end < text.size() && text[end] != '\n' && text[end] != '\r') ++end;
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + (text.substr(end, 2) == "\r\n" ? 2 : 1), text.size()));
    ++line_number;
    const bool continued = line.ends_with('\\') && !text.empty();
    if (!continued && joined.empty()) return line;
    joined.append(continued ? line.substr(0, line.size() - 1) : line).append(" ");
    if (!continued) return joined;
  }
}

}  // namespace

void parse_obj(std::string_view file, ObjSink& sink, CountedWarnings& warnings) {
  ObjLines lines(sink, warnings);
  std::string joined;
  file = without_byte_order_mark(file);
  for (std::size_t line_number = 0; !file.empty();) {
    const std::string_view line = next_line(file, joined, line_number);
    lines.read(line, line_number);
  }
}

namespace {

/// All faces in one mesh.
class OneMesh : public ObjSink {
 public:
  void add_face(const std::vector<ObjCorner>& corners, const ObjVertices& vertices) override {
    builder.add_face(corners, vertices);
  }

  ObjMeshBuilder builder;
};

Mesh decode(std::string_view bytes, const MeshFileOptions& options) {
  OneMesh sink;
  CountedWarnings warnings;
  parse_obj(bytes, sink, warnings);
  if (options.warnings) std::ranges::copy(warnings.lines(), std::back_inserter(*options.warnings));
  Mesh mesh = std::move(sink.builder).finish(options.warnings);
  finish_mesh(mesh, options, options.warnings);
  return mesh;
}

}  // namespace

Mesh decode_obj(std::string_view bytes, const std::string& name, const MeshFileOptions& options) {
  return explaining("cannot read " + name, [&] { return decode(bytes, options); });
}

Mesh read_obj(const std::filesystem::path& path, const MeshFileOptions& options) {
  return explaining("cannot read " + path.string(),
                    [&] { return decode(WholeFile(path).bytes(), options); });
}

}  // namespace pt
