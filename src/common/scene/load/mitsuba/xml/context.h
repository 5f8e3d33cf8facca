// What the loading of one scene shares.
#pragma once

#include <compare>
#include <filesystem>
#include <map>
#include <memory>
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

struct Surface;

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
  template <class First, class... Rest>
  void warn_once(const std::string& kind, const Element& at,
                 fmt::format_string<First, Rest...> text, First&& first, Rest&&... rest) {
    warn_once(kind, at, fmt::format(text, std::forward<First>(first), std::forward<Rest>(rest)...));
  }

  /// Says what was chosen where the file leaves it open.
  void note(const Element& at, const std::string& message) const;

  /// The existing file that a property names, as Mitsuba resolves it: on a <path>, the last one
  /// first, then beside the scene; then beside the XML file that names it, which for a <spectrum>
  /// comes first. Else as find_in() has it, with a warning. Where there is none: beside the XML
  /// file, for a message that names it.
  std::filesystem::path resolve(const Element& at, const std::string& name);
  /// The same, telling `warn`.
  std::filesystem::path find(const Element& at, const std::string& name,
                             const WarnOfName& warn = {}) const;

  /// Warns that a file cannot be read, and what is used instead.
  void warn_unreadable(const Element& at, const std::string& why, const std::string& instead);

  /// Leaves out a shape that is of no use, with a warning.
  void leave_out(const Object& shape, const Element& at, const std::string& why);

  /// Throws Error where shapes were left out and none is there.
  void expect_some_shape() const;

  // What LoadOptions has in memory by the name that an object gives as its `data`; nullptr:
  // nothing.
  const Mesh* memory_mesh(const Object& object) const;
  const TextureImage* memory_image(const Object& object) const;
  const VolumeData* memory_volume(const Object& object) const;

  VolumeStorage volume_storage() const { return options_.volume; }

  /// An emitter becomes a light, or it is left out; add_default_lighting_if_dark() needs to know.
  void add_lit() { lit_ = true; }
  void add_left_out(const Object& emitter) { left_out_.push_back(&emitter); }

  /// Lights a scene in which no emitter is left.
  void add_default_lighting_if_dark();

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
  std::map<const Object*, std::uint32_t> groups;  ///< 0: a group of nothing

  /// What has been read, so that what is named often is read once.
  std::map<const Object*, std::shared_ptr<const Surface>> surfaces;
  std::map<std::pair<const Object*, bool>, std::uint32_t> checkerboards;  ///< true: of numbers

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
  void report(const Element& at, const std::string& message) const;

  const LoadOptions& options_;
  const ObjectGraph& graph_;
  std::set<std::string> warned_;
  bool lit_ = false;
  std::vector<const Object*> left_out_;
  std::string why_no_shape_;  ///< of the first one that was left out
};

}  // namespace pt::mitsuba
