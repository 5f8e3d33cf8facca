// Which files a scene was read from: so that a film can name its scene by their bytes, and other
// processes can be given them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace pt {

/// Notes every file that loaders read in its thread while it exists, so that several threads may
/// load a scene each.
class SceneFiles {
 public:
  using Hashes = std::map<std::filesystem::path, std::string>;  ///< by absolute path

  SceneFiles();
  ~SceneFiles();
  SceneFiles(const SceneFiles&) = delete;
  SceneFiles& operator=(const SceneFiles&) = delete;

  /// To be called by whoever reads a file of a scene. Does nothing where nobody asks.
  static void note(const std::filesystem::path& path, std::string_view bytes);
  /// The same of what another thread has read for this one.
  static void note(const Hashes& hashes);
  const Hashes& hashes() const { return hashes_; }

  /// 32 hexadecimal digits (XXH3, 128 bits), of the bytes of all files and of their paths relative
  /// to `folder`: the same for a copy of all files elsewhere.
  std::string hash(const std::filesystem::path& folder) const;
  /// Absolute, without `.` and `..`, in alphabetical order.
  std::vector<std::filesystem::path> paths() const;

 private:
  SceneFiles* const outer_;  ///< of this thread, before
  Hashes hashes_;
};

/// The hash of a text, of the same form.
std::string hash_of(std::string_view bytes);

/// All bytes of these files with their paths, for other processes. Throws Error.
std::string pack_files(const std::vector<std::filesystem::path>& paths);
/// Writes them below `root`, each at root / its absolute path. Throws Error for bytes that
/// pack_files did not make, and where a file cannot be written.
void unpack_files(std::string_view packed, const std::filesystem::path& root);

}  // namespace pt
