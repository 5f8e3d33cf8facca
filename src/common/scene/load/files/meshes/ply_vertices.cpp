#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>

#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/scene/load/files/meshes/ply.h"

namespace pt {
namespace {

/// Where a property of a vertex goes.
enum Role : int { x, y, z, nx, ny, nz, red, green, blue, u, v, role_count };
using Roles = std::array<std::optional<std::size_t>, role_count>;  ///< the property of each

/// Forgets `count` components from `first` on where one of them is not there.
void drop_incomplete(Roles& roles, int first, int count, const char* what,
                     std::vector<std::string>& warnings) {
  const auto begin = roles.begin() + first, end = begin + count;
  const auto found = std::count_if(begin, end, [](const auto& role) { return role.has_value(); });
  if (found == count) return;
  std::fill(begin, end, std::nullopt);
  if (found > 0) {
    warnings.push_back(fmt::format("{} of the {} components of {} are there: these are ignored",
                                   found, count, what));
  }
}

/// Which properties mean what. Throws Error for vertices without positions.
Roles find_roles(const PlyElement& element, std::vector<std::string>& warnings) {
  Roles roles = {element.find({"x"}),
                 element.find({"y"}),
                 element.find({"z"}),
                 element.find({"nx", "normal_x"}),
                 element.find({"ny", "normal_y"}),
                 element.find({"nz", "normal_z"}),
                 element.find({"red", "r", "diffuse_red", "color_0"}),
                 element.find({"green", "g", "diffuse_green", "color_1"}),
                 element.find({"blue", "b", "diffuse_blue", "color_2"}),
                 element.find({"u", "s", "texture_u", "texture_s"}),
                 element.find({"v", "t", "texture_v", "texture_t"})};
  if (!roles[x] || !roles[y] || !roles[z]) throw Error("vertices without x, y and z");
  drop_incomplete(roles, nx, 3, "normals", warnings);
  drop_incomplete(roles, red, 3, "colours", warnings);
  drop_incomplete(roles, u, 2, "texture coordinates", warnings);
  for (const auto& property : roles) {
    if (property && element.properties[*property].count_type) {
      throw Error(
          fmt::format("vertex property {} is a list", clipped(element.properties[*property].name)));
    }
  }
  return roles;
}

/// Gives the mesh its vertices, all zero. Throws Error for too many.
void allocate(const PlyElement& element, const Roles& roles, Mesh& mesh) {
  if (element.count > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(fmt::format("{} vertices, expected fewer than 2^32", element.count));
  }
  check_host_memory(element.count * sizeof(Vec3) * 4, "the vertices of a mesh");
  mesh.positions.resize(element.count);
  if (roles[nx]) mesh.normals.resize(element.count);
  if (roles[red]) mesh.colors.resize(element.count);
  if (roles[u]) mesh.uvs.resize(element.count);
}

float* place_of(Mesh& mesh, int role, std::size_t vertex) {
  if (role < nx) return &mesh.positions[vertex][role - x];
  if (role < red) return &mesh.normals[vertex][role - nx];
  if (role < u) return &mesh.colors[vertex][role - red];
  return &mesh.uvs[vertex][role - u];
}

/// One vertex after the other, any properties.
template <class Values>
void read_in_turn(Values& values, const PlyElement& element, const Roles& roles, Mesh& mesh) {
  std::vector<int> role_of(element.properties.size(), role_count);
  for (int role = 0; role < role_count; ++role) {
    if (roles[role]) role_of[*roles[role]] = role;
  }
  for (std::size_t i = 0; i < element.count; ++i) {
    try {
      for (std::size_t p = 0; p < role_of.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (role_of[p] == role_count) {
          skip_ply_property(values, property);
        } else {
          *place_of(mesh, role_of[p], i) = static_cast<float>(values.next(property.type));
        }
      }
    } catch (const Error& error) {
      throw Error(fmt::format("vertex {}: {}", i, error.what()));
    }
  }
}

/// A value that every vertex has at the same place of its record.
struct Column {
  const char* first;   ///< in the file
  std::size_t stride;  ///< bytes, in the file
  PlyType type;
  float* out;              ///< of vertex 0
  std::size_t out_stride;  ///< floats

  void convert(std::size_t begin, std::size_t end, bool big_endian) const {
    visit_type(type, [&](auto kind) {
      for (std::size_t i = begin; i < end; ++i) {
        out[i * out_stride] =
            static_cast<float>(load_value<decltype(kind)>(first + i * stride, big_endian));
      }
    });
  }
};

/// Vertices of equal size in a file, in parallel.
void read_records(PlyBinaryValues& values, const PlyElement& element, const Roles& roles,
                  Mesh& mesh) {
  const std::size_t stride = element.least_bytes(false);
  const char* records = values.take(stride * element.count);  // in the file: checked before
  std::vector<Column> columns;
  for (int role = 0; role < role_count; ++role) {
    if (!roles[role] || element.count == 0) continue;
    std::size_t offset = 0;
    for (std::size_t p = 0; p < *roles[role]; ++p) offset += size_bytes(element.properties[p].type);
    columns.push_back({records + offset, stride, element.properties[*roles[role]].type,
                       place_of(mesh, role, 0), role < u ? std::size_t{3} : std::size_t{2}});
  }
  // A block's records stay in the cache from one column to the next.
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, element.count, 2048),
                    [&](const tbb::blocked_range<std::size_t>& block) {
                      for (const Column& column : columns) {
                        column.convert(block.begin(), block.end(), values.big_endian());
                      }
                    });
}

void decode_colors(const PlyElement& element, const Roles& roles, Mesh& mesh) {
  if (roles[red]) decode_ply_colors(mesh.colors, element.properties[*roles[red]].type);
}

}  // namespace

void check_ply_count(const PlyElement& element, std::size_t rest_bytes, bool ascii) {
  const std::size_t least_bytes = element.least_bytes(ascii);
  // The last number of a text needs no white space after it.
  if (least_bytes > 0 && element.count > (rest_bytes + (ascii ? 1 : 0)) / least_bytes) {
    throw Error(
        fmt::format("truncated or corrupted: {} bytes cannot hold the {} elements '{}' "
                    "that the header announces",
                    rest_bytes, element.count, clipped(element.name)));
  }
}

void read_ply_vertices(PlyBinaryValues& values, const PlyElement& element, PlyMesh& out) {
  const Roles roles = find_roles(element, out.warnings);
  check_ply_count(element, values.rest().size(), false);
  allocate(element, roles, out.mesh);
  if (element.has_lists()) {
    read_in_turn(values, element, roles, out.mesh);
  } else {
    read_records(values, element, roles, out.mesh);
  }
  decode_colors(element, roles, out.mesh);
}

void read_ply_vertices(PlyTextValues& values, const PlyElement& element, PlyMesh& out) {
  const Roles roles = find_roles(element, out.warnings);
  check_ply_count(element, values.rest().size(), true);
  allocate(element, roles, out.mesh);
  read_in_turn(values, element, roles, out.mesh);
  decode_colors(element, roles, out.mesh);
}

}  // namespace pt
