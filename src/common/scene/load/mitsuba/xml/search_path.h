// Where the files lie that a scene names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/scene/load/files/find_file.h"
#include "common/scene/load/mitsuba/xml/element.h"

namespace pt::mitsuba {

using Folders = std::vector<std::filesystem::path>;

/// The folders of <path>s, the last one first, as Mitsuba has them.
class SearchPath {
 public:
  /// `scene` is the folder of the first file.
  explicit SearchPath(std::filesystem::path scene) : scene_(std::move(scene)) {}

  /// The folder of a <path>: in the file's folder, or else in the scene's. False: there is none.
  bool add(const Element& path);

  const std::filesystem::path& scene() const { return scene_; }
  const Folders& folders() const { return folders_; }

 private:
  std::filesystem::path scene_;
  Folders folders_;
};

/// The first of these that exists: `name` in one of the folders; then in the current one; then what
/// differs in case alone, of which `warn` is told; then the same of a name from Windows, with
/// backslashes; then as many last parts of an absolute name as there are, of which `warn` is told
/// as well. Else an empty path.
std::filesystem::path find_in(const Folders& folders, const std::string& name,
                              const WarnOfName& warn);

}  // namespace pt::mitsuba
