#include "common/scene/load/files/find_file.h"

#include <fmt/format.h>

#include <set>
#include <utility>
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

/// Looks for a name below a folder, part by part. Links may lead to one folder in many ways: each
/// is searched once for the same rest of the name.
class Search {
 public:
  explicit Search(const fs::path& name) : parts_(name.begin(), name.end()) {}

  /// parts[at], parts[at + 1], ... below `folder`, or an empty path.
  fs::path below(const fs::path& folder, std::size_t at) {
    if (at == parts_.size()) return folder;
    std::error_code failure;
    const fs::path place = fs::canonical(folder.empty() ? fs::path(".") : folder, failure);
    if (failure || !tried_.emplace(place, at).second) return {};
    const fs::path same = folder / parts_[at];
    if (fs::exists(same, failure)) {
      if (const fs::path found = below(same, at + 1); !found.empty()) return found;
    }
    for (const fs::path& other : alike(folder, parts_[at])) {
      if (const fs::path found = below(folder / other, at + 1); !found.empty()) return found;
    }
    return {};
  }

 private:
  std::vector<fs::path> parts_;
  std::set<std::pair<fs::path, std::size_t>> tried_;
};

}  // namespace

fs::path find_file(const fs::path& folder, const fs::path& name, const WarnOfName& warn) {
  std::error_code ignored;
  if (fs::exists(folder / name, ignored)) return folder / name;
  const fs::path relative = name.relative_path().lexically_normal();
  const fs::path found = Search(relative).below(name.is_absolute() ? name.root_path() : folder, 0);
  if (!found.empty() && warn) {
    warn(fmt::format("'{}' does not exist: {}, whose case differs, is used", name.string(),
                     found.string()));
  }
  return found;
}

}  // namespace pt
