// Accessors: typed, strided, perhaps sparse arrays in buffers (specification, section 3.6.2).
#pragma once

#include <cstdint>
#include <vector>

#include "common/scene/load/gltf/document/file.h"

namespace pt::gltf {

/// The accessor's elements, `components` (1 to 4, or 16) numbers each. Integers are converted:
/// normalised ones to [0, 1] or [-1, 1], others by value. Throws Error at `place` where the
/// accessor has another shape or exceeds its buffer.
std::vector<float> read_floats(const File& file, int accessor, int components,
                               const std::string& place);

/// Indices of 8, 16 or 32 bits; errors as above.
std::vector<std::uint32_t> read_indices(const File& file, int accessor, const std::string& place);

}  // namespace pt::gltf
