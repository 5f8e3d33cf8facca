// What the loading of one scene shares.
#pragma once

#include <compare>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "common/scene/data/scene_data.h"
#include "common/scene/data/volume_data.h"
#include "common/scene/load/files/images/texture_store.h"
#include "common/scene/load/files/load_options.h"
#include "common/scene/load/files/meshes/vertex_colors.h"
#include "common/scene/load/mitsuba/xml/object.h"

namespace pt::mitsuba {

class Context {
 public:
  /// All arguments must outlive the context.
  Context(SceneData& scene_data, const LoadOptions& load_options, const ObjectGraph& graph);

  SceneData& scene;
  TextureStore textures;
  VertexColors colors;
  /// Mitsuba 2 and 3; else 0.x, with other defaults here and there.
  const bool modern;

  /// Reports what is replaced or ignored, once for each `kind`.
  void warn_once(const std::string& kind, const Element& at, const std::string& message);

  /// Says what was chosen where the file leaves it open.
  void note(const Element& at, const std::string& message) const;

  /// The existing file that a property names: beside the XML file that names it, beside the scene,
  /// or on a <path>; failing that, one whose case differs, which is reported. Where there is none:
  /// the first of these, for an error that names it.
  std::filesystem::path resolve(const Element& at, const std::string& name);

  /// Of the scene's description in memory; nullptr: there is none of that name.
  const Mesh* memory_mesh(const std::string& name) const;

  /// An emitter becomes a light, or it is left out; add_studio_if_dark() needs to know.
  void add_lit() { lit_ = true; }
  void add_left_out(const Object& emitter) { left_out_.push_back(&emitter); }

  /// Lights a scene in which no emitter is left.
  void add_studio_if_dark();

  /// Reports what is inside of objects in use and nothing asked for.
  void report_unused();

  /// What a shape's material is made of.
  struct MaterialParts {
    const Object *bsdf, *emitter;
    std::uint16_t outside, inside;  ///< media

    auto operator<=>(const MaterialParts&) const = default;
  };

  /// Numbers of materials, of media that are supported, and of groups by shapegroup.
  std::map<MaterialParts, std::uint32_t> materials;
  std::map<const Object*, std::optional<std::uint16_t>> media;
  std::map<const Object*, std::uint32_t> groups;

  /// The grids of a medium, by what names them in `volumes`; nullptr: it has none.
  struct MediumGrids {
    const Object* medium = nullptr;
    const Object *density = nullptr, *albedo = nullptr;
  };

  /// Grids that files bring, and the media that have them: add_grids() makes them the scene's.
  std::map<const Object*, VolumeData> volumes;
  std::map<std::uint16_t, MediumGrids> medium_grids;

  /// Emitters that shapes have, in them or by reference.
  std::set<const Object*> on_shapes;

 private:
  void report_unused(const Object& object);

  const LoadOptions& options_;
  const ObjectGraph& graph_;
  std::set<std::string> warned_;
  bool lit_ = false;
  std::vector<const Object*> left_out_;
};

}  // namespace pt::mitsuba
