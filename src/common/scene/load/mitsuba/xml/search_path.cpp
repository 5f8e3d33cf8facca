#include "common/scene/load/mitsuba/xml/search_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <system_error>

namespace pt::mitsuba {
namespace {

namespace fs = std::filesystem;

fs::path find_exactly(const Folders& folders, const std::string& name) {
  std::error_code ignored;
  for (const fs::path& folder : folders) {
    if (fs::exists(folder / name, ignored)) return folder / name;
  }
  return fs::exists(name, ignored) ? fs::path(name) : fs::path();
}

fs::path find_in_any_case(const Folders& folders, const std::string& name, const WarnOfName& warn) {
  for (const fs::path& folder : folders) {
    if (const fs::path found = find_file(folder, name, warn); !found.empty()) return found;
  }
  return {};
}

bool has_drive(const std::string& name) {
  return name.size() > 2 && std::isalpha(static_cast<unsigned char>(name[0])) && name[1] == ':';
}

/// Of an absolute name on another machine: as many of its last parts as are here.
fs::path find_last_parts(const Folders& folders, const fs::path& name, const WarnOfName& warn) {
  constexpr std::ptrdiff_t most_parts = 8;
  const std::vector<fs::path> parts(name.begin(), name.end());
  const auto first = std::max<std::ptrdiff_t>(1, std::ssize(parts) - most_parts);
  for (auto part = parts.begin() + first; part < parts.end(); ++part) {
    fs::path tail;
    for (auto next = part; next != parts.end(); ++next) tail /= *next;
    if (tail.is_absolute()) continue;
    fs::path found = find_exactly(folders, tail.string());
    if (found.empty()) found = find_in_any_case(folders, tail.string(), {});
    if (found.empty()) continue;
    if (warn) {
      warn(fmt::format("'{}' does not exist: {} is used", name.string(), found.string()));
    }
    return found;
  }
  return {};
}

}  // namespace

bool SearchPath::add(const Element& path) {
  const std::string& name = path.required("value");
  std::error_code ignored;
  for (const fs::path& folder : {path.file->parent_path(), scene_, fs::path()}) {
    if (!fs::is_directory(folder / name, ignored)) continue;
    folders_.insert(folders_.begin(), folder / name);
    return true;
  }
  return false;
}

fs::path find_in(const Folders& folders, const std::string& name, const WarnOfName& warn) {
  if (name.empty()) return {};
  if (const fs::path found = find_exactly(folders, name); !found.empty()) return found;
  if (const fs::path found = find_in_any_case(folders, name, warn); !found.empty()) return found;
  std::string slashed = name;
  std::ranges::replace(slashed, '\\', '/');
  if (has_drive(name) || fs::path(slashed).is_absolute()) {
    return find_last_parts(folders, slashed, warn);
  }
  return slashed == name ? fs::path() : find_in(folders, slashed, warn);
}

}  // namespace pt::mitsuba
