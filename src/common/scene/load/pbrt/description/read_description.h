// Reading a pbrt file and those that it includes.
#pragma once

#include "common/scene/load/pbrt/description/description.h"

namespace pt::pbrt {

/// Throws Error for bad syntax, with file, line and column.
Description read_description(const std::filesystem::path& path, Reporter& reporter);

}  // namespace pt::pbrt
