// The pictures of MTL files as textures of the scene.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/images/texture_store.h"
#include "common/scene/load/obj/mtl_file.h"
#include "common/scene/load/obj/named_files.h"

namespace pt::obj {

/// A map of a material, for messages.
struct MapUse {
  const MtlMap& map;
  const std::string& place;  ///< of the material
  const char* key;           ///< the statement
  const char* instead;       ///< what is used where the picture cannot be read
};

class MtlTextures {
 public:
  /// All outlive this. Pictures lie in the first of `folders` that has them.
  MtlTextures(std::vector<std::filesystem::path> folders, NamedFiles& files, SceneData& scene,
              CountedWarnings& warnings)
      : folders_(std::move(folders)),
        files_(files),
        warnings_(warnings),
        store_(scene.textures, scene.texels) {}

  // Each is no_texture, with a warning, where the picture cannot be read.

  /// Colours, of which base + gain * colour is used, within [0, most].
  std::uint32_t add_color(const MapUse& use, float most);
  /// Numbers, likewise within [0, 1]: one channel, else the luminance, in all components.
  std::uint32_t add_number(const MapUse& use);
  /// The picture as it is, linear, without base and gain: one channel where the map says so.
  std::uint32_t add_plain(const MapUse& use);
  /// As add_plain; but the picture's alpha where it has one and the map does not name another
  /// channel. `is_opaque`: alpha is asked for and 1 everywhere.
  std::uint32_t add_opacity(const MapUse& use, bool& is_opaque);

  bool is_normal_map(std::uint32_t texture_index) const {
    return store_.is_normal_map(texture_index);
  }
  /// Empty: there is no such file.
  std::filesystem::path path_of(const MtlMap& map) { return files_.find(folders_, map.name); }

 private:
  using Weights = std::optional<Color>;

  std::uint32_t add(const MapUse& use, TextureFormat format, const Weights& weights);
  /// Values between 0 and `most` of base + gain * the picture's, as texels.
  std::uint32_t add_scaled(const MapUse& use, TextureFormat format, const Weights& weights,
                           float most);
  std::uint32_t add_scaled_file(const MapUse& use, const std::filesystem::path& path,
                                const Texture& look, const Weights& weights, float most);
  Texture look_of(const MapUse& use, TextureFormat format);
  /// What `read` returns for the picture's path, or no_texture.
  template <class Read>
  std::uint32_t read_or_warn(const MapUse& use, const Read& read);

  std::vector<std::filesystem::path> folders_;
  NamedFiles& files_;
  CountedWarnings& warnings_;
  TextureStore store_;
  std::map<std::string, std::uint32_t> scaled_;              ///< by path, values and look
  std::map<std::filesystem::path, std::string> unreadable_;  ///< and why
};

}  // namespace pt::obj
