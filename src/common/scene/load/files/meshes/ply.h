// The parts of a PLY file: header, values, vertices and faces.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "common/error/error.h"
#include "common/geometry/mesh.h"
#include "common/scene/load/files/meshes/polygons.h"

namespace pt {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

inline bool is_integer(PlyType type) { return type < PlyType::float32; }

/// Bytes of a value in a binary file.
std::size_t size_bytes(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count_type;  ///< of a list, an integer; none: a single value
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// The fewest bytes that one of these can take in a file.
  std::size_t least_bytes(bool ascii) const;
  /// The number of the property of one of these names, or none.
  std::optional<std::size_t> find(std::initializer_list<std::string_view> names) const;
  bool has_lists() const;
};

enum class PlyEncoding : std::uint8_t { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;  ///< in the order in which they follow
  std::size_t bytes = 0;             ///< of the header
  std::size_t lines = 0;             ///< of the header
  bool names_texture = false;        ///< a comment does

  const PlyElement* find(std::string_view name) const;
};

/// Reads the header at the beginning of a file. Throws Error naming the line.
PlyHeader read_ply_header(std::string_view file);

// The values in the body of a PLY file, one after the other.

/// The bytes of one value in the other order.
template <class T>
T swap_bytes(T value) {
  unsigned char bytes[sizeof(T)], swapped[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T); ++i) swapped[i] = bytes[sizeof(T) - 1 - i];
  std::memcpy(&value, swapped, sizeof(T));
  return value;
}

/// The value at `from`, which need not be aligned; `big_endian` says how it is stored there, on
/// a little-endian machine.
template <class T>
T load_value(const char* from, bool big_endian) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return big_endian ? swap_bytes(value) : value;
}

/// Calls function(T{}) with the C++ type of `type`.
template <class Function>
decltype(auto) visit_type(PlyType type, Function&& function) {
  switch (type) {
    case PlyType::int8:
      return function(std::int8_t{});
    case PlyType::uint8:
      return function(std::uint8_t{});
    case PlyType::int16:
      return function(std::int16_t{});
    case PlyType::uint16:
      return function(std::uint16_t{});
    case PlyType::int32:
      return function(std::int32_t{});
    case PlyType::uint32:
      return function(std::uint32_t{});
    case PlyType::float32:
      return function(float{});
    default:
      return function(double{});
  }
}

/// Binary values. Doubles hold every type exactly.
class PlyBinaryValues {
 public:
  PlyBinaryValues(std::string_view body, bool big_endian) : rest_(body), big_endian_(big_endian) {}

  /// Throws Error at the end of the file.
  double next(PlyType type) {
    const char* from = take(size_bytes(type));
    return visit_type(type, [&](auto kind) {
      return static_cast<double>(load_value<decltype(kind)>(from, big_endian_));
    });
  }

  /// Passes over so many bytes and returns where they begin.
  const char* take(std::size_t bytes) {
    if (rest_.size() < bytes) throw Error("the file ends here");
    const char* begin = rest_.data();
    rest_.remove_prefix(bytes);
    return begin;
  }

  std::string_view rest() const { return rest_; }
  bool big_endian() const { return big_endian_; }

 private:
  std::string_view rest_;
  bool big_endian_;
};

/// Numbers in text, apart by white space.
class PlyTextValues {
 public:
  explicit PlyTextValues(std::string_view body) : rest_(body) {}

  /// Throws Error at the end of the file and for what is no number.
  double next(PlyType type);

  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

// The vertices and faces of a PLY file.

/// What a file has given so far.
struct PlyMesh {
  Mesh mesh;
  PolygonFans fans;
  std::uint64_t lost = 0;       ///< faces that are left out
  std::string first_lost = {};  ///< the first of them and what is wrong with it
  std::vector<std::string> warnings = {};
};

/// All read the elements that follow in `values`; normals and uvs stay empty where the file has
/// none. Throw Error naming the vertex or face.
void read_ply_vertices(PlyBinaryValues& values, const PlyElement& element, PlyMesh& out);
void read_ply_vertices(PlyTextValues& values, const PlyElement& element, PlyMesh& out);

/// `vertex_count` is the number of vertices, read or still to come.
void read_ply_faces(PlyBinaryValues& values, const PlyElement& element, std::uint64_t vertex_count,
                    PlyMesh& out);
void read_ply_faces(PlyTextValues& values, const PlyElement& element, std::uint64_t vertex_count,
                    PlyMesh& out);

/// Strips of triangles, as scanners' programs write them: every second one is turned over, -1
/// begins another strip.
void read_ply_strips(PlyBinaryValues& values, const PlyElement& element, std::uint64_t vertex_count,
                     PlyMesh& out);
void read_ply_strips(PlyTextValues& values, const PlyElement& element, std::uint64_t vertex_count,
                     PlyMesh& out);

/// Throws Error where `element` announces more than the rest of a file can hold.
void check_ply_count(const PlyElement& element, std::size_t rest_bytes, bool ascii);

/// Reads one list's count. Throws Error for one that is negative.
template <class Values>
std::uint64_t next_ply_count(Values& values, PlyType type) {
  const double count = values.next(type);
  if (!(count >= 0 && count < 0x1p32)) throw Error("a list with a negative or huge count");
  return static_cast<std::uint64_t>(count);
}

/// Makes linear colours of the numbers of a file. Floats are linear. Integers are in the sRGB
/// curve; 1 is the largest number of 8 bits where none is larger, else that of 16 bits, else that
/// of the type. What is negative or not finite becomes 0.
void decode_ply_colors(std::vector<Color>& colors, PlyType type);

/// Passes over a property.
template <class Values>
void skip_ply_property(Values& values, const PlyProperty& property) {
  std::uint64_t count = property.count_type ? next_ply_count(values, *property.count_type) : 1;
  for (; count > 0; --count) values.next(property.type);
}

}  // namespace pt
