// What a user says to the loaders of scene files.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "common/error/error.h"
#include "common/geometry/mesh.h"
#include "common/options/options.h"
#include "common/scene/data/volume_data.h"

namespace pt {

struct TextureImage;

struct LoadOptions {
  std::map<std::string, std::string> definitions;  ///< -D name=value; for formats with variables
  bool strict = false;  ///< an Error instead of each warning: nothing is replaced or ignored
  std::function<void(const std::string&)> warn;  ///< called with one line; empty: silence
  /// Meshes in memory, by the names that shapes of the type "mesh" give as their data.
  std::map<std::string, Mesh> meshes{};
  DefaultLighting default_lighting = DefaultLighting::automatic;
  CameraOverrides camera{};  ///< through which default lighting is decided, besides the file's
  VolumeStorage volume = VolumeStorage::automatic;  ///< of sparse grids
  std::optional<float> time{};  ///< seconds at which animations are evaluated; none: they are not
  std::optional<float> shutter{};  ///< seconds from `time` on of which the image is the mean
  std::string animation{};         ///< name or number of one; empty: all that do not conflict
  /// Pictures of "bitmap" and "envmap" and grids of "gridvolume" in memory, named likewise.
  std::map<std::string, std::shared_ptr<const TextureImage>> images{};
  std::map<std::string, VolumeData> volumes{};

  /// For what a loader replaces or ignores. `message` names the file, the place, and what is used
  /// instead.
  void report(const std::string& message) const {
    if (strict) throw Error(message + " (--strict)");
    if (warn) warn(message);
  }
};

}  // namespace pt
