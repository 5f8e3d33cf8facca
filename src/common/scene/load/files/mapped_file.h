// A whole file as memory.
#pragma once

#include <filesystem>
#include <string_view>

namespace pt {

/// Maps a regular file for reading, for as long as it lives. Throws Error with the system's reason
/// (without the file's name) where it cannot.
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& path);
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  std::string_view bytes() const { return bytes_; }

 private:
  std::string_view bytes_;
};

}  // namespace pt
