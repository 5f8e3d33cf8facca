// What the making of one scene shares, and how pictures lie on surfaces: by a surface's own
// coordinates or by its points.
#pragma once

#include <fmt/format.h>

#include <map>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "common/math/transform.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/images/texture_store.h"
#include "common/scene/load/files/whole_file.h"
#include "common/scene/load/pbrt/syntax/description.h"
#include "common/scene/load/pbrt/syntax/parameters.h"

namespace pt::pbrt {

enum class MappingKind { uv, planar, spherical, cylindrical };

struct TextureMapping {
  MappingKind kind = MappingKind::uv;
  Affine to_texture;                      ///< of points of the world; not of uv
  Vec3 u_axis{1, 0, 0}, v_axis{0, 1, 0};  ///< planar
  Vec2 shift{0.0f};                       ///< planar

  bool is_uv() const { return kind == MappingKind::uv; }
  bool operator==(const TextureMapping& other) const;

  /// (u, v) of a point of the world, as in pbrt.
  Vec2 at(const Vec3& point) const;
};

/// The mapping that all have, or uv with a warning; uv of none. Textures are looked up by the
/// coordinates of their surface, of which there are only one.
TextureMapping common_mapping(const std::vector<TextureMapping>& mappings,
                              const FileLocation& place, Reporter& reporter);

// What the making of one scene shares.

struct Surface;
struct ReadTexture;

/// A texture, and what it is read for: as a number or not, which quantity, and what stands in for
/// a picture that cannot be read.
using TextureKey = std::tuple<const Entity*, bool, int, float, float, float>;

class Context {
 public:
  /// All arguments outlive it.
  Context(SceneData& scene_data, const Description& scene_description, Reporter& scene_reporter)
      : scene(scene_data),
        description(scene_description),
        reporter(scene_reporter),
        textures(scene_data.textures, scene_data.texels) {}

  SceneData& scene;
  const Description& description;
  Reporter& reporter;
  TextureStore textures;
  float imaging_ratio = 1.0f;  ///< of the film: multiplies all light
  float white_kelvins = 0.0f;  ///< what the film takes for white; 0: takes all as it is

  VolumeStorage volume_storage = VolumeStorage::automatic;
  std::map<std::string, std::uint16_t> media;  ///< numbers of those that were made, by name

  /// The number of a material; one that is there already is not added.
  std::uint32_t add_material(const MaterialDescription& material);

  /// The file that a parameter names, beside the scene's own; one whose case differs is reported.
  /// Where there is none: the path for an error that names it.
  std::filesystem::path resolve(const FileLocation& place, const std::string& name);
  /// The same, telling `warn`.
  std::filesystem::path find(const std::string& name, const WarnOfName& warn = {}) const;

  /// By texture, while its value is being made: what refers to itself is an error.
  std::set<const Entity*> open_entities;

  /// What was read of materials and textures: each is read once, however many name it.
  std::map<const Entity*, std::shared_ptr<const Surface>> surfaces;
  std::map<TextureKey, std::shared_ptr<const ReadTexture>> read_textures;
  std::uint64_t baked_bytes = 0;  ///< of textures computed from others

  /// Whether a picture has an alpha that is not 1 everywhere.
  bool has_alpha(const std::filesystem::path& path);

  /// Mappings of the textures read since this was cleared; two different ones tell as much as all.
  std::vector<TextureMapping> mappings;
  void add_mapping(const TextureMapping& mapping);

  bool lit = false;  ///< a light of the file is in the scene

 private:
  std::map<std::string, std::uint32_t> materials_;  ///< by all that they say
  std::map<std::filesystem::path, bool> alphas_;
};

/// Reads what a file holds that a parameter names. Where that fails, `instead` is used, which a
/// warning says.
template <class Action>
bool attempt_file(Context& context, const Parameter& filename, const std::string& instead,
                  const Action& action) {
  return context.reporter.attempt(instead, "is used", [&] {
    try {
      action();
    } catch (const Error& error) {
      fail(filename.place, error.what());
    }
  });
}

/// Marks an entity as open; throws Error where it is that already.
class OpenEntity {
 public:
  OpenEntity(Context& context, const Entity& entity) : context_(context), entity_(entity) {
    const Parameters& parameters = entity.parameters;
    if (context.open_entities.size() == most_open) {
      fail(parameters.place(), "{} is nested too deeply; expected at most {} in each other",
           parameters.what(), most_open);
    }
    if (!context.open_entities.insert(&entity).second) {
      fail(parameters.place(), parameters.what() + " refers to itself");
    }
  }
  OpenEntity(const OpenEntity&) = delete;
  OpenEntity& operator=(const OpenEntity&) = delete;
  ~OpenEntity() { context_.open_entities.erase(&entity_); }

 private:
  static constexpr std::size_t most_open = 256;

  Context& context_;
  const Entity& entity_;
};

}  // namespace pt::pbrt
