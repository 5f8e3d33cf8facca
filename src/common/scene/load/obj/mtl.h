// MTL files: what they say, the files that they name, and what their materials and pictures mean
// here.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/vec.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/images/texture_store.h"
#include "common/scene/load/files/text.h"

namespace pt::obj {

/// A picture with the options of its line.
struct MtlMap {
  std::string name;  ///< as in the file, without quotes; empty: there is no such map
  float offset[2] = {0, 0}, scale[2] = {1, 1};  ///< -o, -s
  float base = 0.0f, gain = 1.0f;               ///< -mm
  float bump = 1.0f;                            ///< -bm
  bool clamps = false;                          ///< -clamp
  bool blends[2] = {true, true};                ///< -blendu, -blendv
  char channel = '\0';                          ///< -imfchan: r, g, b, m or l; 0: not said

  explicit operator bool() const { return !name.empty(); }
};

/// Who wrote a file, where its comments say so and it matters.
enum class Exporter { unknown, blender, cinema4d, meshlab };

/// The members have the names of their statements. Colours and numbers are finite and in range.
struct MtlMaterial {
  std::string name;
  std::string place;  ///< file, line and name, for messages
  Exporter exporter = Exporter::unknown;
  std::optional<Color> Ka, Kd, Ks, Ke, Tf;
  std::optional<float> d, Tr, Ns, Ni, Pr, Pm, Ps, Pc, Pcr, aniso;
  std::optional<int> illum;
  MtlMap map_Kd, map_Ks, map_Ke, map_d, map_Tr, map_Pr, map_Pm, map_Ps, bump, norm;
};

/// `file` names the text in messages.
std::vector<MtlMaterial> parse_mtl(std::string_view text, const std::string& file,
                                   CountedWarnings& warnings);

// The lines of MTL files that name pictures.

/// Called with a kind of warning and its message.
using WarnOfKind = std::function<void(const std::string& kind, const std::string& message)>;

/// Reads what follows a statement such as map_Kd: options, the picture's name, which may be in
/// quotes and have spaces, and options again, as some exporters write them. The name ends before
/// the first word that is an option. `warn` is told of options that have no counterpart or that
/// are malformed; these change nothing.
MtlMap parse_mtl_map(std::string_view text, const WarnOfKind& warn);

// Files under the names that OBJ and MTL files give them.

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

// The pictures of MTL files as textures of the scene.

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

  /// Announces the pictures that have exactly the names in the material (read_ahead.h).
  void read_ahead(const MtlMaterial& material) const;

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

// What the materials of MTL files mean here: docs/scenes.md has the table.

/// Adds the material to the scene, as the nearest of ours, and returns its number.
std::uint32_t add_material(const MtlMaterial& source, MtlTextures& textures, SceneData& scene,
                           CountedWarnings& warnings);

}  // namespace pt::obj
