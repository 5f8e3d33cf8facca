#include "common/scene/load/files/scene_files.h"

#include <fmt/format.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstring>
#include <fstream>

#include "common/error/error.h"
#include "common/scene/load/files/whole_file.h"

namespace pt {
namespace {

namespace fs = std::filesystem;

thread_local SceneFiles* current = nullptr;

fs::path normal(const fs::path& path) { return fs::absolute(path).lexically_normal(); }

std::string hex(const XXH128_hash_t& hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

// Packed files: the number of files, then for each the length of its path, the path, the number of
// its bytes, the bytes.
void append_size(std::string& out, std::uint64_t size) {
  for (int i = 0; i < 8; ++i) out += static_cast<char>(size >> (8 * i) & 0xff);
}

class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : bytes_(bytes) {}

  std::uint64_t size() {
    std::uint64_t value = 0;
    const std::string_view eight = take(8);
    for (int i = 0; i < 8; ++i) {
      value |= std::uint64_t{static_cast<unsigned char>(eight[static_cast<std::size_t>(i)])}
               << (8 * i);
    }
    return value;
  }
  std::string_view take(std::uint64_t count) {
    if (count > bytes_.size()) throw Error("files of a scene: truncated");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  bool is_at_end() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
};

}  // namespace

SceneFiles::SceneFiles() : outer_(current) { current = this; }
SceneFiles::~SceneFiles() { current = outer_; }

void SceneFiles::note(const fs::path& path, std::string_view bytes) {
  if (current != nullptr) current->hashes_[normal(path)] = hash_of(bytes);
}

void SceneFiles::note(const Hashes& hashes) {
  if (current == nullptr) return;
  for (const auto& [path, hash] : hashes) current->hashes_[path] = hash;
}

std::string SceneFiles::hash(const fs::path& folder) const {
  const fs::path base = normal(folder.empty() ? fs::path(".") : folder / "");
  std::map<std::string, std::string> relative;
  for (const auto& [path, hash] : hashes_) {
    relative[path.lexically_relative(base).generic_string()] = hash;
  }
  std::string all;
  for (const auto& [path, hash] : relative) all += path + '\0' + hash;
  return hash_of(all);
}

std::vector<fs::path> SceneFiles::paths() const {
  std::vector<fs::path> paths;
  for (const auto& entry : hashes_) paths.push_back(entry.first);
  return paths;
}

std::string hash_of(std::string_view bytes) {
  return hex(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string pack_files(const std::vector<fs::path>& paths) {
  std::string packed;
  append_size(packed, paths.size());
  for (const fs::path& path : paths) {
    const std::string name = path.generic_string();
    append_size(packed, name.size());
    packed += name;
    try {
      const WholeFile file(path);
      append_size(packed, file.bytes().size());
      packed += file.bytes();
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}", name, error.what()));
    }
  }
  return packed;
}

void unpack_files(std::string_view packed, const fs::path& root) {
  Unpacker unpacker(packed);
  const std::uint64_t count = unpacker.size();
  for (std::uint64_t i = 0; i < count; ++i) {
    const fs::path name(unpacker.take(unpacker.size()));
    const std::string_view bytes = unpacker.take(unpacker.size());
    const fs::path path = root / name.relative_path().lexically_normal();
    const fs::path inside = path.lexically_relative(root);
    if (inside.empty() || *inside.begin() == "..") {
      throw Error(fmt::format("files of a scene: '{}' is no absolute path", name.string()));
    }
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    std::ofstream file(path, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) throw Error(fmt::format("{}: {}", path.string(), std::strerror(errno)));
  }
  if (!unpacker.is_at_end()) throw Error("files of a scene: expected no bytes after the last");
}

}  // namespace pt
