// The content of a file, compressed or not.
#pragma once

#include <filesystem>
#include <string>

namespace pt::pbrt {

/// All of a file; one that gzip has compressed, as its first bytes tell, is decompressed: to at
/// most 256 MiB or a hundred times its size. Throws Error with the file's name where that cannot
/// be.
std::string read_source(const std::filesystem::path& path);

}  // namespace pt::pbrt
