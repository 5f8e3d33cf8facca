// The header of a PLY file (Turk 1994, 'The PLY Polygon File Format').
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

}  // namespace pt
