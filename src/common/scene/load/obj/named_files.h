// Files under the names that OBJ and MTL files give them.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/scene/load/files/counted_warnings.h"

namespace pt::obj {

class NamedFiles {
 public:
  explicit NamedFiles(CountedWarnings& warnings) : warnings_(warnings) {}

  /// A file's path, in the first of `folders` that has it; else an empty path. Separators may be
  /// those of Windows. What is not where the name says is looked for by the name's last parts, as
  /// names are often absolute paths on another machine; that, and another case, is warned of.
  std::filesystem::path find(const std::vector<std::filesystem::path>& folders,
                             std::string_view name);

 private:
  std::filesystem::path search(const std::vector<std::filesystem::path>& folders,
                               std::string_view name);

  CountedWarnings& warnings_;
  std::map<std::string, std::filesystem::path, std::less<>> found_;  ///< by folder and name
};

}  // namespace pt::obj
