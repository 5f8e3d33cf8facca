// For tests of the loader of pbrt's files: scenes as strings, warnings as a list.
#pragma once

#include <string>

#include "common/scene/load/load_scene.h"
#include "load/mitsuba_scene.h"
#include "temp_folder.h"

namespace pt {

/// A sky of ones.
inline const std::string lit = "LightSource \"infinite\"\n";
/// A wall that fills pbrt_world's image, at a distance of 1, facing the camera at the origin.
inline const std::string facing_wall =
    "Shape \"bilinearmesh\" \"point3 P\" [ -3 -3 1  -3 3 1  3 -3 1  3 3 1 ]\n";

inline LoadedScene load_pbrt_file(const std::string& path, LoadOptions options = {}) {
  LoadedScene loaded;
  options.warn = [&](const std::string& message) { loaded.warnings.push_back(message); };
  loaded.scene = load_pbrt(path, options);
  return loaded;
}

/// The scene of this text, in a folder that may hold files that it names.
inline LoadedScene load_pbrt_text(const std::string& text, const LoadOptions& options = {}) {
  const TempFolder folder;
  write_text(folder.file("scene.pbrt"), text);
  return load_pbrt_file(folder.file("scene.pbrt"), options);
}

/// A small camera and, after WorldBegin, these directives.
inline std::string pbrt_world(const std::string& world, const std::string& before = {}) {
  return "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\n"
         "PixelFilter \"box\"\n" +
         before + "\nCamera \"perspective\" \"float fov\" 90\nWorldBegin\n" + world + "\n";
}

/// Its scene, of which nothing is reported.
inline SceneData load_pbrt_silently(const std::string& text) {
  const LoadedScene loaded = load_pbrt_text(text);
  EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
  return loaded.scene;
}

/// The message of the Error, without the folder; empty where there is none.
inline std::string pbrt_error(const std::string& text, const LoadOptions& options = {}) {
  try {
    load_pbrt_text(text, options);
  } catch (const Error& error) {
    const std::string message = error.what();
    const std::size_t name = message.find("scene.pbrt");
    return name == message.npos ? message : message.substr(name);
  }
  return {};
}

/// What is said of a scene that has something wrong: the Error, or else the first warning, without
/// the folder.
inline std::string pbrt_complaint(const std::string& text) {
  std::string message;
  try {
    const LoadedScene loaded = load_pbrt_text(text);
    if (!loaded.warnings.empty()) message = loaded.warnings.front();
  } catch (const Error& error) {
    message = error.what();
  }
  const std::size_t name = message.find("scene.pbrt");
  return name == message.npos ? message : message.substr(name);
}

}  // namespace pt
