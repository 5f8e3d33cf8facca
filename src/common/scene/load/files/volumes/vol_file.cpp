// The layout (documentation of Mitsuba 3's gridvolume), all little-endian: "VOL", the version as a
// byte, then as 32-bit integers the encoding, the voxels along x, y and z and the channels, then
// the box as six floats, its lower corner first. The values follow: channels side by side, x varies
// fastest, then y.
#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "common/error/error.h"
#include "common/scene/load/files/volumes/volume_files.h"
#include "common/scene/load/files/whole_file.h"

namespace pt {
namespace {

struct VolHeader {
  char magic[3];
  std::uint8_t version;
  std::int32_t encoding;
  std::int32_t size[3];
  std::int32_t channels;
  float low[3], high[3];
};
static_assert(sizeof(VolHeader) == 48);

constexpr std::uint8_t vol_version = 3;
constexpr std::int32_t float_encoding = 1;

VolHeader header_of(std::string_view bytes) {
  VolHeader header{};
  const bool is_vol = bytes.substr(0, sizeof header.magic) == "VOL";
  if (!is_vol) throw Error("not a .vol file: expected 'VOL' at its beginning");
  if (bytes.size() < sizeof header) {
    throw Error(fmt::format("truncated: {} bytes, expected at least the {} of a header",
                            bytes.size(), sizeof header));
  }
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.version != vol_version) {
    throw Error(fmt::format("version {} of the format, expected {}", header.version, vol_version));
  }
  if (header.encoding != float_encoding) {
    throw Error(
        fmt::format("encoding {}, expected {}: 32-bit floats", header.encoding, float_encoding));
  }
  for (const std::int32_t size : header.size) {
    if (size < 1) {
      throw Error(fmt::format("{} x {} x {} voxels, expected at least one along each axis",
                              header.size[0], header.size[1], header.size[2]));
    }
  }
  if (header.channels != 1 && header.channels != 3) {
    throw Error(fmt::format("{} channels, expected 1 or 3", header.channels));
  }
  return header;
}

/// How many values the header announces, all of which `available` bytes hold: nothing is allocated
/// for a size that is a lie.
std::size_t value_count(const VolHeader& header, std::size_t available) {
  auto count = static_cast<std::uint64_t>(header.channels);
  const std::uint64_t held = available / sizeof(float);
  for (const std::int32_t size : header.size) {
    if (static_cast<std::uint64_t>(size) > held / count) {  // no product that could overflow
      throw Error(
          fmt::format("truncated: {} bytes of values, expected those of {} x {} x {} "
                      "voxels of {} floats",
                      available, header.size[0], header.size[1], header.size[2], header.channels));
    }
    count *= static_cast<std::uint64_t>(size);
  }
  return count;
}

void expect_densities(const VolumeData& grid) {
  for (std::size_t i = 0; i < grid.values.size(); ++i) {
    const float value = grid.values[i];
    if (value >= 0 && std::isfinite(value)) continue;
    const std::size_t voxel = i / grid.channels, row = voxel / grid.size[0];
    throw Error(fmt::format("the value {} in voxel ({}, {}, {}), expected finite ones, at least 0",
                            value, voxel % grid.size[0], row % grid.size[1], row / grid.size[1]));
  }
}

VolFile decode(std::string_view bytes) {
  const VolHeader header = header_of(bytes);
  const std::string_view values = bytes.substr(sizeof header);
  VolFile file;
  file.grid.values.resize(value_count(header, values.size()));
  std::memcpy(file.grid.values.data(), values.data(), file.grid.values.size() * sizeof(float));
  for (int axis = 0; axis < 3; ++axis) {
    file.grid.size[axis] = static_cast<std::uint32_t>(header.size[axis]);
    file.low[axis] = header.low[axis], file.high[axis] = header.high[axis];
  }
  file.grid.channels = static_cast<std::uint32_t>(header.channels);
  expect_densities(file.grid);
  return file;
}

}  // namespace

VolFile decode_vol(std::string_view bytes, const std::string& name) {
  return explaining("cannot read " + name, [&] { return decode(bytes); });
}

VolFile read_vol(const std::filesystem::path& path) {
  return explaining("cannot read " + path.string(),
                    [&] { return decode(WholeFile(path).bytes()); });
}

}  // namespace pt
