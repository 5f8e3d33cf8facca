// Mitsuba's .serialized (Mitsuba 0.6's manual, 10.1.5): shapes, each a header and a zlib stream,
// then their offsets, then their number. All little-endian.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "common/error/error.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/whole_file.h"

namespace pt {
namespace {

enum Flags : std::uint32_t {
  has_normals = 0x0001,
  has_uvs = 0x0002,
  has_colors = 0x0008,
  face_normals = 0x0010,
  single_precision = 0x1000,
  double_precision = 0x2000
};

constexpr std::uint16_t magic = 0x041c;
constexpr std::size_t header_bytes = 4;  // magic, version

template <class T>
T value_at(std::string_view bytes, std::uint64_t position) {
  if (position > bytes.size() || bytes.size() - position < sizeof(T)) {
    throw Error("truncated or corrupted: it ends within its header or its table of shapes");
  }
  T value;
  std::memcpy(&value, bytes.data() + position, sizeof value);
  return value;
}

/// The version of the shape that begins here, 3 or 4.
int version_at(std::string_view bytes, std::uint64_t position) {
  if (value_at<std::uint16_t>(bytes, position) != magic) {
    throw Error("not a .serialized file, or corrupted: wrong magic number");
  }
  const int version = value_at<std::uint16_t>(bytes, position + 2);
  if (version != 3 && version != 4) {
    throw Error(fmt::format("version {} of the format, expected 3 or 4", version));
  }
  return version;
}

/// Where shape number `index` begins.
std::uint64_t offset_of(std::string_view bytes, int index) {
  const int version = version_at(bytes, 0);
  const auto count = value_at<std::uint32_t>(bytes, bytes.size() - 4);
  if (index < 0 || static_cast<std::uint32_t>(index) >= count) {
    throw Error(fmt::format("shape {}, expected 0 to {}", index, std::int64_t{count} - 1));
  }
  const std::size_t entry_bytes = version == 4 ? 8 : 4;
  const std::uint64_t from_end = 4 + entry_bytes * (count - static_cast<std::uint64_t>(index));
  if (from_end > bytes.size()) throw Error("truncated or corrupted: no table of shapes");
  const std::uint64_t entry = bytes.size() - from_end;
  return version == 4 ? value_at<std::uint64_t>(bytes, entry)
                      : value_at<std::uint32_t>(bytes, entry);
}

/// `count` vectors, stored as Float.
template <class Vector, class Float>
std::vector<Vector> next_vectors(Inflater& stream, std::uint64_t count) {
  constexpr auto size = static_cast<std::uint64_t>(Vector::length());
  const std::vector<Float> values = stream.next_array<Float>(size * count);
  std::vector<Vector> vectors(count);
  for (std::uint64_t i = 0; i < size * count; ++i) {
    vectors[i / size][static_cast<int>(i % size)] = static_cast<float>(values[i]);
  }
  return vectors;
}

template <class Float>
void read_vertices(Inflater& stream, std::uint32_t flags, std::uint64_t count, Mesh& mesh) {
  mesh.positions = next_vectors<Vec3, Float>(stream, count);
  if (flags & has_normals) mesh.normals = next_vectors<Vec3, Float>(stream, count);
  if (flags & has_uvs) mesh.uvs = next_vectors<Vec2, Float>(stream, count);
  if (flags & has_colors) next_vectors<Vec3, Float>(stream, count);
}

Mesh read_shape(std::string_view bytes, std::uint64_t offset, std::vector<std::string>* warnings) {
  const int version = version_at(bytes, offset);
  Inflater stream(bytes.substr(offset + header_bytes));
  const auto flags = stream.next<std::uint32_t>();
  if (version == 4) {
    while (stream.next<char>() != '\0') continue;  // the shape's name
  }
  const auto vertices = stream.next<std::uint64_t>();
  const auto triangles = stream.next<std::uint64_t>();
  if (std::max(vertices, triangles) > 0xffffffffu) {
    throw Error(
        fmt::format("{} vertices and {} triangles, expected fewer than 2^32", vertices, triangles));
  }
  Mesh mesh;
  if (flags & double_precision) {
    read_vertices<double>(stream, flags, vertices, mesh);
  } else {
    read_vertices<float>(stream, flags, vertices, mesh);
    if (!(flags & single_precision) && warnings) {
      warnings->push_back(fmt::format("flags {:#x} say neither float nor double: float", flags));
    }
  }
  if (flags & face_normals) mesh.normals = {};
  mesh.triangles = stream.next_array<TriangleIndices>(triangles);
  return mesh;
}

Mesh decode_shape(std::string_view bytes, int shape_index, const MeshFileOptions& options) {
  Mesh mesh = read_shape(bytes, offset_of(bytes, shape_index), options.warnings);
  finish_mesh(mesh, options, options.warnings);
  return mesh;
}

std::string cannot_read(int shape_index, const std::string& name) {
  return fmt::format("cannot read shape {} of {}", shape_index, name);
}

}  // namespace

Mesh decode_serialized(std::string_view bytes, const std::string& name, int shape_index,
                       const MeshFileOptions& options) {
  return explaining(cannot_read(shape_index, name),
                    [&] { return decode_shape(bytes, shape_index, options); });
}

Mesh read_serialized(const std::filesystem::path& path, int shape_index,
                     const MeshFileOptions& options) {
  return explaining(cannot_read(shape_index, path.string()),
                    [&] { return decode_shape(WholeFile(path).bytes(), shape_index, options); });
}

}  // namespace pt
