#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>

#include "common/scene/load/files/meshes/ply.h"

namespace pt {
namespace {

constexpr std::uint64_t most_triangles = 0xffffffffu;

/// The number of the property that lists a face's vertices. Throws Error where there is none.
std::size_t find_indices(const PlyElement& element) {
  const std::optional<std::size_t> indices = element.find({"vertex_indices", "vertex_index"});
  if (!indices || !element.properties[*indices].count_type) {
    throw Error(element.name + " without a list vertex_indices");
  }
  if (!is_integer(element.properties[*indices].type)) throw Error("vertex_indices are no integers");
  return *indices;
}

/// The numbers of the properties red, green and blue, or none.
using FaceColor = std::array<std::optional<std::size_t>, 3>;

FaceColor find_color(const PlyElement& element) {
  const FaceColor color = {element.find({"red", "r", "diffuse_red", "color_0"}),
                           element.find({"green", "g", "diffuse_green", "color_1"}),
                           element.find({"blue", "b", "diffuse_blue", "color_2"})};
  for (const auto& component : color) {
    if (!component || element.properties[*component].count_type) return {};
  }
  return color;
}

/// Reads the vertices of one face. Returns what is wrong with them, or nothing.
template <class Values>
std::string read_polygon(Values& values, const PlyProperty& property, std::uint64_t vertex_count,
                         std::vector<std::uint32_t>& polygon) {
  polygon.clear();  // grows as vertices are read, whatever their count says
  std::string wrong;
  for (std::uint64_t n = next_ply_count(values, *property.count_type); n > 0; --n) {
    const double index = values.next(property.type);
    if (!(index >= 0 && index < static_cast<double>(vertex_count))) {
      if (wrong.empty()) wrong = fmt::format("index {} into {} vertices", index, vertex_count);
      continue;
    }
    polygon.push_back(static_cast<std::uint32_t>(index));
  }
  if (wrong.empty() && polygon.size() < 3) {
    wrong = fmt::format("{} vertices, expected 3 or more", polygon.size());
  }
  return wrong;
}

/// One face: its vertices and, where `color` says so, the three numbers of its colour. Returns what
/// is wrong with it, or nothing.
template <class Values>
std::string read_face(Values& values, const PlyElement& element, std::uint64_t vertex_count,
                      std::size_t indices, const FaceColor& color,
                      std::vector<std::uint32_t>& polygon, Color& numbers) {
  std::string wrong;
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    const auto component = std::ranges::find(color, p);
    if (p == indices) {
      wrong = read_polygon(values, element.properties[p], vertex_count, polygon);
    } else if (component != color.end()) {
      numbers[static_cast<int>(component - color.begin())] =
          static_cast<float>(values.next(element.properties[p].type));
    } else {
      skip_ply_property(values, element.properties[p]);
    }
  }
  return wrong;
}

void lose_face(std::uint64_t face, const std::string& wrong, PlyMesh& out) {
  if (out.lost++ == 0) out.first_lost = fmt::format("face {}: {}", face, wrong);
}

/// One face after the other, any properties.
template <class Values>
void read_in_turn(Values& values, const PlyElement& element, std::uint64_t vertex_count,
                  PlyMesh& out) {
  const std::size_t indices = find_indices(element);
  const FaceColor color = find_color(element);
  std::vector<std::uint32_t> polygon;
  Color numbers(0.0f);
  Mesh& mesh = out.mesh;
  mesh.triangles.reserve(mesh.triangles.size() + element.count);
  for (std::uint64_t i = 0; i < element.count; ++i) {
    std::string wrong;
    try {
      wrong = read_face(values, element, vertex_count, indices, color, polygon, numbers);
    } catch (const Error& error) {
      throw Error(fmt::format("face {}: {}", i, error.what()));
    }
    if (!wrong.empty()) {
      lose_face(i, wrong, out);
      continue;
    }
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      mesh.triangles.push_back({{polygon[0], polygon[k - 1], polygon[k]}});
    }
    out.fans.add(polygon.size() - 2);
    if (color[0]) mesh.face_colors.resize(mesh.triangles.size(), numbers);
  }
  if (color[0]) decode_ply_colors(mesh.face_colors, element.properties[*color[0]].type);
}

/// A strip's list, in which every vertex but the first two makes a triangle with those before.
template <class Values>
void read_strip(Values& values, const PlyProperty& property, std::uint64_t strip,
                std::uint64_t vertex_count, PlyMesh& out) {
  std::uint64_t length = 0;  // of the strip so far
  std::uint32_t a = 0, b = 0;
  for (std::uint64_t n = next_ply_count(values, *property.count_type); n > 0; --n) {
    const double index = values.next(property.type);
    const bool is_good = index >= 0 && index < static_cast<double>(vertex_count);
    if (!is_good) {  // another strip begins
      if (index != -1.0) {
        lose_face(strip, fmt::format("index {} into {} vertices", index, vertex_count), out);
      }
      length = 0;
      continue;
    }
    const auto vertex = static_cast<std::uint32_t>(index);
    if (++length > 2 && a != b && b != vertex && a != vertex) {  // equal ones join strips
      const bool is_turned = length % 2 == 0;
      out.mesh.triangles.push_back(is_turned ? TriangleIndices{{b, a, vertex}}
                                             : TriangleIndices{{a, b, vertex}});
    }
    a = b, b = vertex;
  }
}

template <class Values>
void read_strips(Values& values, const PlyElement& element, std::uint64_t vertex_count,
                 PlyMesh& out) {
  const std::size_t indices = find_indices(element);
  const std::size_t before = out.mesh.triangles.size();
  for (std::uint64_t i = 0; i < element.count; ++i) {
    try {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (p == indices) {
          read_strip(values, property, i, vertex_count, out);
        } else {
          skip_ply_property(values, property);
        }
      }
    } catch (const Error& error) {
      throw Error(fmt::format("strip {}: {}", i, error.what()));
    }
  }
  out.fans.skip(out.mesh.triangles.size() - before);
}

/// Binary faces that all have as many vertices as the first, and no list but that of the vertices:
/// records of equal size.
struct EqualFaces {
  const char* first;         ///< the count of face 0
  std::size_t stride;        ///< bytes of a face
  PlyType count_type, type;  ///< of the list
  std::uint64_t corners;     ///< vertices of a face, 3 or more
  bool big_endian;

  /// Writes the triangles of the faces [begin, end), corners - 2 for each. False where one has
  /// another count or an index that is not below `vertex_count`.
  template <class Count, class Index>
  bool convert(std::uint64_t begin, std::uint64_t end, std::uint64_t vertex_count,
               TriangleIndices* triangles) const {
    for (std::uint64_t i = begin; i < end; ++i) {
      const char* face = first + i * stride;
      const char* list = face + sizeof(Count);
      if (static_cast<std::uint64_t>(load_value<Count>(face, big_endian)) != corners) return false;
      const auto index = [&](std::uint64_t k) {  // a negative one becomes huge
        return static_cast<std::uint64_t>(load_value<Index>(list + k * sizeof(Index), big_endian));
      };
      const std::uint64_t a = index(0);
      std::uint64_t b = index(1), largest = std::max(a, b);
      for (std::uint64_t k = 2; k < corners; ++k) {
        const std::uint64_t c = index(k);
        largest = std::max(largest, c);
        *triangles++ = {{static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                         static_cast<std::uint32_t>(c)}};
        b = c;
      }
      if (largest >= vertex_count) return false;
    }
    return true;
  }

  bool convert_any(std::uint64_t begin, std::uint64_t end, std::uint64_t vertex_count,
                   TriangleIndices* triangles) const {
    return visit_type(count_type, [&](auto count) {
      return visit_type(type, [&](auto index) {
        if constexpr (std::is_integral_v<decltype(count)> && std::is_integral_v<decltype(index)>) {
          return convert<decltype(count), decltype(index)>(begin, end, vertex_count, triangles);
        } else {
          return false;
        }
      });
    });
  }
};

/// The faces as EqualFaces if the first and the size of the file allow that they are.
std::optional<EqualFaces> guess_equal_faces(PlyBinaryValues values, const PlyElement& element) {
  if (find_color(element)[0]) return {};
  const std::size_t indices = find_indices(element);
  const PlyProperty& list = element.properties[indices];
  std::size_t before = 0, after = 0;
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    if (p == indices) continue;
    if (element.properties[p].count_type) return {};
    (p < indices ? before : after) += size_bytes(element.properties[p].type);
  }
  if (element.count == 0 || values.rest().size() < before + size_bytes(*list.count_type)) return {};
  values.take(before);
  const char* first = values.rest().data();
  const double corners = values.next(*list.count_type);
  if (!(corners >= 3 && corners <= 255)) return {};
  const auto n = static_cast<std::uint64_t>(corners);
  const std::size_t stride =
      before + size_bytes(*list.count_type) + n * size_bytes(list.type) + after;
  const std::size_t bytes = values.rest().size() + before + size_bytes(*list.count_type);
  if (element.count > bytes / stride || element.count * (n - 2) > most_triangles) return {};
  return EqualFaces{first, stride, *list.count_type, list.type, n, values.big_endian()};
}

/// False, with the mesh as before, where the faces are not equal or one of them is wrong.
bool read_equal_faces(PlyBinaryValues& values, const PlyElement& element,
                      std::uint64_t vertex_count, PlyMesh& out) {
  const std::optional<EqualFaces> faces = guess_equal_faces(values, element);
  if (!faces) return false;
  const std::uint64_t per_face = faces->corners - 2;
  std::vector<TriangleIndices>& triangles = out.mesh.triangles;
  const std::size_t before = triangles.size();
  triangles.resize(before + element.count * per_face);
  std::atomic<bool> good = true;
  using Range = tbb::blocked_range<std::uint64_t>;
  tbb::parallel_for(Range(0, element.count, 8192), [&](const Range& block) {
    TriangleIndices* const first = triangles.data() + before + block.begin() * per_face;
    if (good && !faces->convert_any(block.begin(), block.end(), vertex_count, first)) good = false;
  });
  if (good) {
    values.take(element.count * faces->stride);
    out.fans.add_equal(element.count, per_face);
  } else {
    triangles.resize(before);
  }
  return good;
}

/// What a face says beside its vertices and is not ours.
void report_ignored(const PlyElement& element, std::vector<std::string>& warnings) {
  const auto coordinates = element.find({"texcoord", "texcoords", "texture_uv"});
  if (coordinates && element.properties[*coordinates].count_type) {
    warnings.emplace_back(
        "texture coordinates of faces are not supported and ignored; expected u "
        "and v of vertices");
  }
}

}  // namespace

void read_ply_faces(PlyBinaryValues& values, const PlyElement& element, std::uint64_t vertex_count,
                    PlyMesh& out) {
  check_ply_count(element, values.rest().size(), false);
  report_ignored(element, out.warnings);
  if (!read_equal_faces(values, element, vertex_count, out)) {
    read_in_turn(values, element, vertex_count, out);
  }
}

void read_ply_faces(PlyTextValues& values, const PlyElement& element, std::uint64_t vertex_count,
                    PlyMesh& out) {
  check_ply_count(element, values.rest().size(), true);
  report_ignored(element, out.warnings);
  read_in_turn(values, element, vertex_count, out);
}

void read_ply_strips(PlyBinaryValues& values, const PlyElement& element, std::uint64_t vertex_count,
                     PlyMesh& out) {
  check_ply_count(element, values.rest().size(), false);
  read_strips(values, element, vertex_count, out);
}

void read_ply_strips(PlyTextValues& values, const PlyElement& element, std::uint64_t vertex_count,
                     PlyMesh& out) {
  check_ply_count(element, values.rest().size(), true);
  read_strips(values, element, vertex_count, out);
}

}  // namespace pt
