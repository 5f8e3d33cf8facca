// A whole file as memory.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

namespace pt {

/// The bytes of a regular file, read once: a file that is mapped and then becomes shorter, or whose
/// disk fails, ends the program (SIGBUS). Throws Error with the system's reason (without the file's
/// name) where it cannot be read, and where it needs more memory than there is.
class WholeFile {
 public:
  explicit WholeFile(const std::filesystem::path& path);

  std::string_view bytes() const { return bytes_; }

 private:
  std::unique_ptr<char[]> memory_;
  std::string_view bytes_;
};

}  // namespace pt
