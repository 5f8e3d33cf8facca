// Mitsuba's .vol: a grid of voxels.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/scene/data/volume_data.h"

namespace pt {

struct VolFile {
  VolumeData grid;  ///< trilinear, in the cube [0, 1]^3
  Vec3 low, high;   ///< the corners of the box in which the file puts it; any numbers
};

/// Reads a file of version 3 with 32-bit floats. Throws Error with the file's name where it is of
/// another kind, ends too early, or has other values than a grid may have (VolumeData).
VolFile read_vol(const std::filesystem::path& path);

/// The same from memory; `name` is for errors.
VolFile decode_vol(std::string_view bytes, const std::string& name);

}  // namespace pt
