// What the making of one scene shares.
#pragma once

#include <map>
#include <set>
#include <string>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/images/texture_store.h"
#include "common/scene/load/pbrt/description/description.h"
#include "common/scene/load/pbrt/description/texture_mapping.h"

namespace pt::pbrt {

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

  std::map<std::string, std::uint16_t> media;  ///< numbers of those that were made, by name

  /// The number of a material; one that is there already is not added.
  std::uint32_t add_material(const MaterialDescription& material);

  /// The file that a parameter names, beside the scene's own; one whose case differs is reported.
  /// Where there is none: the path for an error that names it.
  std::filesystem::path resolve(const Place& place, const std::string& name);

  /// By texture, while its value is being made: what refers to itself is an error.
  std::set<const Entity*> open_entities;

  /// Whether a picture has an alpha that is not 1 everywhere.
  bool has_alpha(const std::filesystem::path& path);

  std::vector<TextureMapping> mappings;  ///< of the textures read since this was cleared

  bool lit = false;  ///< a light of the file is in the scene

 private:
  std::map<std::string, std::uint32_t> materials_;  ///< by all that they say
  std::map<std::filesystem::path, bool> alphas_;
};

/// Marks an entity as open; throws Error where it is that already.
class OpenEntity {
 public:
  OpenEntity(Context& context, const Entity& entity) : context_(context), entity_(entity) {
    if (!context.open_entities.insert(&entity).second) {
      fail(entity.parameters.place(), entity.parameters.what() + " refers to itself");
    }
  }
  OpenEntity(const OpenEntity&) = delete;
  OpenEntity& operator=(const OpenEntity&) = delete;
  ~OpenEntity() { context_.open_entities.erase(&entity_); }

 private:
  Context& context_;
  const Entity& entity_;
};

}  // namespace pt::pbrt
