// The parameters of a scene in memory that can be changed, by name: "camera.to_world",
// "materials.red.albedo", "lights.lamp.radiance", "instances.3.to_world", "meshes.bust.vertices",
// "spheres.ball.radius".
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/scene/data/scene_data.h"

namespace pt {

/// The BSDF's fields, by their indices.
std::vector<BsdfParameter> bsdf_parameters(MaterialKind kind);

struct MaterialValue {
  std::string name;
  bool is_color = false;  ///< else a number, in all components
  std::function<Color(const MaterialDescription&)> get;
  std::function<void(MaterialDescription&, const Color&)> set;
};

/// The parameters of its BSDF, whose textures multiply the values; and "opacity" where that is one
/// number. Setting one updates the precomputed parameters; a plastic has "eta" in their place.
/// `material` is not a node.
std::vector<MaterialValue> material_values(const MaterialDescription& material);

/// A unique name for each material: that in its file; "PARENT.0" and "PARENT.1" for the children of
/// a named material; else "material_N".
std::vector<std::string> material_names(const SceneData& scene);

/// What a change of the parameter with this name makes stale.
SceneChanges changes_of(std::string_view parameter);

struct SceneParameter {
  std::string name;
  /// Shape of an array, row by row; empty: one number.
  std::vector<std::size_t> shape;
  SceneChanges changes;
  std::function<std::vector<float>(const SceneData&)> get;
  /// Takes as many numbers as get() returns. Throws Error for values that are not possible, having
  /// changed nothing.
  std::function<void(SceneData&, std::span<const float>)> set;
  // Of transforms, which are 4x4 matrices, and of places, whose keys are translations. Both may
  // move; set() stops that.
  /// None: it stands still.
  std::function<std::vector<TransformKey>(const SceneData&)> get_keys = {};
  /// Throws Error as set() does.
  std::function<void(SceneData&, const std::vector<TransformKey>&)> set_keys = {};
};

/// The map of a matrix of 16 numbers, row by row. Throws Error, which begins with `what`.
Affine affine_of(std::span<const float> matrix, const std::string& what);
std::vector<float> matrix_of(const Affine& map);

/// The same of a key of a parameter of this shape: a matrix, or a place. Throws Error, with `what`.
Affine affine_of_key(std::span<const std::size_t> shape, std::span<const float> key,
                     const std::string& what);
std::vector<float> numbers_of_key(std::span<const std::size_t> shape, const Affine& map);

/// The parameters of an unprepared scene: its camera, the parameters of its materials, the radiance
/// of its lights, its instances' places, its meshes' vertices and normals, its spheres. Meshes have
/// the names of their file; else, as spheres, that of their material, else "mesh_N", "sphere_N".
std::vector<SceneParameter> scene_parameters(const SceneData& scene);

}  // namespace pt
