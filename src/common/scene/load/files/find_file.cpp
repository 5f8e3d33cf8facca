#include "common/scene/load/files/find_file.h"

#include <fmt/format.h>

#include <set>
#include <vector>

namespace pt {
namespace {

namespace fs = std::filesystem;

std::string lower(std::string text) {
  for (char& c : text) c = 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

/// What is called `name` in `folder`, itself first.
std::set<fs::path> alike(const fs::path& folder, const fs::path& name) {
  const std::string wanted = lower(name.string());
  std::set<fs::path> found;
  std::error_code error;
  const fs::path place = folder.empty() ? fs::path(".") : folder;
  for (fs::directory_iterator entry(place, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path candidate = entry->path().filename();
    if (candidate != name && lower(candidate.string()) == wanted) found.insert(candidate);
  }
  return found;
}

using Parts = std::vector<fs::path>;

/// parts[at], parts[at + 1], ... below `folder`, or an empty path.
fs::path search(const fs::path& folder, const Parts& parts, std::size_t at) {
  if (at == parts.size()) return folder;
  std::error_code ignored;
  const fs::path same = folder / parts[at];
  if (fs::exists(same, ignored)) {
    if (const fs::path found = search(same, parts, at + 1); !found.empty()) return found;
  }
  for (const fs::path& other : alike(folder, parts[at])) {
    if (const fs::path found = search(folder / other, parts, at + 1); !found.empty()) return found;
  }
  return {};
}

}  // namespace

fs::path find_file(const fs::path& folder, const fs::path& name, const WarnOfName& warn) {
  std::error_code ignored;
  if (fs::exists(folder / name, ignored)) return folder / name;
  const fs::path relative = name.relative_path().lexically_normal();
  const fs::path found =
      search(name.is_absolute() ? name.root_path() : folder, {relative.begin(), relative.end()}, 0);
  if (!found.empty() && warn) {
    warn(fmt::format("'{}' does not exist: {}, whose case differs, is used", name.string(),
                     found.string()));
  }
  return found;
}

}  // namespace pt
