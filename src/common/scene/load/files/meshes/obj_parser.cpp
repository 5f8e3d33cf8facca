#include "common/scene/load/files/meshes/obj_parser.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/error/error.h"
#include "common/image/codecs/tone_mapping.h"
#include "common/scene/load/files/meshes/text_number.h"

namespace pt {
namespace {

float next_float(std::string_view& line) {
  return static_cast<float>(parse_number(next_word(line)));
}

Vec3 next_vec3(std::string_view& line) {
  const float x = next_float(line), y = next_float(line), z = next_float(line);
  return {x, y, z};
}

Vec3 next_position(std::string_view& line) {
  const Vec3 p = next_vec3(line);
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
    throw Error(fmt::format("position ({}, {}, {}), expected finite numbers", p.x, p.y, p.z));
  }
  return p;
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
    throw Error(fmt::format("expected the number of a {}, found '{}'", what, text.substr(0, 40)));
  }
  const auto signed_count = static_cast<std::int64_t>(count);
  if (failure != std::errc{} || index == 0 || index > signed_count || index < -signed_count) {
    throw Error(fmt::format("{} {}, of {} so far", what, text.substr(0, 40), count));
  }
  return static_cast<std::uint32_t>(index > 0 ? index - 1 : signed_count + index);
}

/// v, v/vt, v//vn or v/vt/vn.
ObjCorner parse_corner(std::string_view word, const ObjVertices& vertices) {
  std::string_view parts[3];
  for (std::string_view& part : parts) {
    const std::size_t slash = std::min(word.find('/'), word.size());
    part = word.substr(0, slash);
    word.remove_prefix(std::min(slash + 1, word.size()));
  }
  if (!word.empty()) throw Error("a corner with more than three indices");
  return {
      parse_index(parts[0], "vertex", vertices.positions.size()),
      parts[1].empty() ? obj_none : parse_index(parts[1], "texture vertex", vertices.uvs.size()),
      parts[2].empty() ? obj_none : parse_index(parts[2], "normal", vertices.normals.size())};
}

class ObjLines {
 public:
  explicit ObjLines(ObjSink& sink) : sink_(sink) {}

  void read(std::string_view line) {
    const std::string_view keyword = next_word(line);
    if (keyword == "v") {
      vertices_.positions.push_back(next_position(line));
      read_color(line);
    } else if (keyword == "vt") {
      vertices_.uvs.push_back(next_vec2(line));
    } else if (keyword == "vn") {
      vertices_.normals.push_back(next_vec3(line));
    } else if (keyword == "f") {
      read_face(line);
    } else if (keyword == "usemtl") {
      sink_.use_material(trim(line));
    } else if (keyword == "mtllib") {
      sink_.read_library(trim(line));
    }
  }

 private:
  /// What follows a position: a weight, a colour in the sRGB curve, or both.
  void read_color(std::string_view rest) {
    if (trim(rest).empty() || trim(rest).starts_with('#')) return;
    std::string_view words[4];
    std::size_t count = 0;
    while (count < 4 && !(words[count] = next_word(rest)).empty() &&
           !words[count].starts_with('#')) {
      ++count;
    }
    if (count < 3) return;
    Color color;
    for (int i = 0; i < 3; ++i) {
      std::string_view word = words[count - 3 + static_cast<std::size_t>(i)];
      const float value = next_float(word);
      color[i] = value > 0.0f ? srgb_curve.decode(std::min(value, 1.0f)) : 0.0f;
    }
    vertices_.colors.resize(vertices_.positions.size() - 1, Color(1.0f));
    vertices_.colors.push_back(color);
  }

  void read_face(std::string_view line) {
    corners_.clear();
    for (std::string_view word; !(word = next_word(line)).empty();) {
      if (word.starts_with('#')) break;
      corners_.push_back(parse_corner(word, vertices_));
    }
    if (corners_.size() < 3) {
      throw Error(fmt::format("a face with {} vertices, expected 3 or more", corners_.size()));
    }
    sink_.add_face(corners_, vertices_);
  }

  ObjSink& sink_;
  ObjVertices vertices_;
  std::vector<ObjCorner> corners_;  // of one face; kept for its memory
};

/// Takes the next line off the front of `text`; a \ at its end continues it, which `joined` then
/// holds. Adds the lines taken to `number`.
std::string_view next_line(std::string_view& text, std::string& joined, std::size_t& line_number) {
  joined.clear();
  for (;;) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
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

void parse_obj(std::string_view file, ObjSink& sink) {
  ObjLines lines(sink);
  std::string joined;
  file = without_byte_order_mark(file);
  for (std::size_t line_number = 0; !file.empty();) {
    const std::string_view line = next_line(file, joined, line_number);
    try {
      lines.read(line);
    } catch (const Error& error) {
      throw Error(fmt::format("line {}: {}", line_number, error.what()));
    }
  }
}

}  // namespace pt
