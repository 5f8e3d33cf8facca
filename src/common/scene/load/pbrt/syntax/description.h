// What a pbrt file says, before it is made a scene: things may be named before they are defined.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "common/math/transform.h"
#include "common/scene/load/files/importer.h"
#include "common/scene/load/pbrt/syntax/parameters.h"

namespace pt::pbrt {

/// A directive with a type and parameters: a material, a texture, a light, ...
struct Entity {
  std::string type;
  Parameters parameters;
  Affine to_world;                      ///< the current transformation
  ColorSpace space = ColorSpace::srgb;  ///< the current one
  std::optional<Affine> end_to_world;   ///< where it ends, if it moves
};
using EntityPointer = std::shared_ptr<const Entity>;

/// Ends a name that was defined again; what follows it tells which definition is meant.
inline constexpr char newest_mark = '\x1f';

/// One of its own, or by name; a null pointer is pbrt's default, diffuse.
using MaterialReference = std::variant<EntityPointer, std::string>;

/// By name; an empty one is a vacuum.
struct MediumNames {
  std::string inside, outside;
};

struct ShapeEntity {
  Entity shape;
  MaterialReference material;
  EntityPointer area_light;  ///< null: it is dark
  bool reverse = false;      ///< ReverseOrientation
  MediumNames media;
  std::uint32_t group = 0;  ///< 0: the world; else of an object
};

struct InstanceEntity {
  std::string name;
  FileLocation place;
  Affine to_world;
  std::uint32_t group = 0;  ///< 0: it may be defined later
  std::optional<Affine> end_to_world;
};

struct Description {
  std::filesystem::path folder;  ///< of the scene's own file
  FileLocation place;            ///< its beginning
  bool is_earlier = false;       ///< of pbrt-v3 or before, as what it uses shows
  // Null: the file has none.
  EntityPointer camera, film, sampler, integrator, filter;
  std::optional<LookAt> camera_look_at;  ///< the last LookAt before it
  std::string camera_medium;             ///< by name; empty: a vacuum
  float begin_s = 0.0f, end_s = 1.0f;    ///< of all motions: TransformTimes
  std::vector<EntityPointer> lights;
  // By name:
  std::map<std::string, EntityPointer> materials, media, float_textures, spectrum_textures;
  std::vector<ShapeEntity> shapes;
  std::map<std::string, std::uint32_t> groups;  ///< of objects, from 1
  std::vector<InstanceEntity> instances;
};

// Reading a pbrt file and those that it includes.

/// Throws Error for bad syntax, with file, line and column.
Description read_description(const std::filesystem::path& path, Reporter& reporter);

}  // namespace pt::pbrt
