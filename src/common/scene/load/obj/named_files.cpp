#include "common/scene/load/obj/named_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/error/quoted.h"
#include "common/scene/load/files/find_file.h"

namespace pt::obj {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t name_bytes_max = 4096;  // PATH_MAX of Linux
constexpr std::size_t last_parts_max = 8;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return !path.empty() && fs::exists(path, ignored) && !fs::is_directory(path, ignored);
}

bool has_drive(std::string_view name) {
  const char letter = name.empty() ? '\0' : static_cast<char>(name[0] | 0x20);
  return name.size() > 1 && 'a' <= letter && letter <= 'z' && name[1] == ':';
}

/// The parts of a path of any system, without its root.
std::vector<std::string> parts_of(std::string_view name) {
  std::vector<std::string> parts;
  if (has_drive(name)) name.remove_prefix(2);
  while (!name.empty()) {
    const std::size_t end = std::min(name.find_first_of("/\\"), name.size());
    const std::string_view part = name.substr(0, end);
    if (!part.empty() && part != ".") parts.emplace_back(part);
    name.remove_prefix(std::min(end + 1, name.size()));
  }
  return parts;
}

/// The last `count` parts.
fs::path tail_of(const std::vector<std::string>& parts, std::size_t count) {
  fs::path path;
  for (std::size_t i = parts.size() - count; i < parts.size(); ++i) path /= parts[i];
  return path;
}

}  // namespace

fs::path NamedFiles::find(const std::vector<fs::path>& folders, std::string_view name) {
  if (name.empty() || name.size() > name_bytes_max) return {};
  const std::string key = folders.front().string() + '\n' + std::string(name);
  const auto known = found_.find(key);
  if (known != found_.end()) return known->second;
  return found_.emplace(key, search(folders, name)).first->second;
}

fs::path NamedFiles::search(const std::vector<fs::path>& folders, std::string_view name) {
  const auto warn = [&](const std::string& line) { warnings_.add("case", line, name); };
  const std::vector<std::string> parts = parts_of(name);
  const bool is_absolute = name[0] == '/' || name[0] == '\\' || has_drive(name);
  for (const fs::path& folder : folders) {  // a name on Linux may have \ or : in it
    if (is_file(folder / name)) return folder / name;
    if (is_absolute) continue;
    const fs::path path = find_file(folder, tail_of(parts, parts.size()), warn);
    if (is_file(path)) return path;
  }
  if (name[0] == '/') {
    const fs::path path = find_file({}, name, warn);
    if (is_file(path)) return path;
  }
  const std::size_t most = is_absolute ? parts.size() : parts.size() - std::min(parts.size(), 1ul);
  for (std::size_t count = std::min(most, last_parts_max); count > 0; --count) {
    const auto first = parts.end() - static_cast<std::ptrdiff_t>(count);
    if (std::find(first, parts.end(), "..") != parts.end()) continue;  // may lead above the folder
    for (const fs::path& folder : folders) {
      const fs::path path = find_file(folder, tail_of(parts, count), {});
      if (!is_file(path)) continue;
      warnings_.add("last parts",
                    fmt::format("{} does not exist: {} is used", in_quotes(name), path.string()),
                    name);
      return path;
    }
  }
  return {};
}

}  // namespace pt::obj
