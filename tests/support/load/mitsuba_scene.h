// For tests of the loader of Mitsuba's XML: scenes as strings, warnings as a list.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "common/scene/load/load_scene.h"
#include "temp_folder.h"

namespace pt {

struct LoadedScene {
  SceneData scene;
  std::vector<std::string> warnings;

  /// How many warnings contain `part`.
  int count(const std::string& part) const {
    int n = 0;
    for (const std::string& warning : warnings) n += warning.find(part) != std::string::npos;
    return n;
  }
};

inline LoadedScene load_with_warnings(const std::string& path, LoadOptions options = {}) {
  LoadedScene loaded;
  options.warn = [&](const std::string& message) { loaded.warnings.push_back(message); };
  loaded.scene = load_mitsuba_xml(path, options);
  return loaded;
}

/// The scene with this XML inside of <scene version="...">.
inline LoadedScene load_xml(const std::string& inside, const std::string& version = "3.0.0",
                            const LoadOptions& options = {}) {
  const TempFolder folder;
  const std::string path = folder.file("scene.xml");
  write_text(path, "<scene version=\"" + version + "\">\n" + inside + "\n</scene>\n");
  return load_with_warnings(path, options);
}

/// <float name="..." value="..."/>
inline std::string number(const char* name, double value) {
  return fmt::format("<float name='{}' value='{}'/>", name, value);
}

}  // namespace pt
