// Grids of voxels in files: NanoVDB (.nvdb), which a build may lack, and Mitsuba's .vol.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/scene/data/volume_data.h"

namespace pt {

/// Whether this program can read them.
bool reads_nanovdb();

/// Reads a grid of floats, quantized or not, with the voxels around its active ones, which is zero
/// wherever it ends: in the file's world, trilinear; dense or sparse. An empty name is "density" or
/// else the only grid there is. Throws Error with the file's name where it is of another kind, is
/// damaged or ends too early, has no such grid, or one of other values than a grid may have
/// (VolumeData).
VolumeData read_nanovdb(const std::filesystem::path& path, const std::string& grid = {},
                        VolumeStorage storage = VolumeStorage::automatic);

/// Whether the file has a grid of this name.
bool has_nanovdb_grid(const std::filesystem::path& path, const std::string& grid);

/// As read_nanovdb, from memory; `name` is for errors.
VolumeData decode_nanovdb(std::string_view bytes, const std::string& grid, const std::string& name,
                          VolumeStorage storage = VolumeStorage::automatic);

// Mitsuba's .vol: a grid of voxels.

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
