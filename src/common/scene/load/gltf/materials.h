// Materials: metallic-roughness and its extensions as the principled BSDF.
#pragma once

#include <cstdint>
#include <map>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/gltf/textures.h"

namespace pt::gltf {

/// Converts the materials that the scene uses, with their textures.
class Materials {
 public:
  /// Adds to `scene`, which outlives this.
  Materials(File& file, SceneData& scene) : file_(file), scene_(scene), textures_(file, scene) {}

  /// The scene's number of material `index` of the file, -1: the default material. `place` is that
  /// of the reference.
  std::uint32_t material_index(int index, const std::string& place);

  /// Whether material `index`, which has a number, is its base colour's light
  /// (KHR_materials_unlit).
  bool is_unlit(int index) const;

 private:
  MaterialDescription convert(const tinygltf::Material& source, const std::string& place);
  void set_base(const tinygltf::Material& source, const std::string& place,
                MaterialDescription& result);
  void set_metallic_roughness(const tinygltf::Material& source, const std::string& place,
                              MaterialDescription& result);
  void set_specular_glossiness(const tinygltf::Value& source, const std::string& place,
                               MaterialDescription& result);
  void set_transmission(const tinygltf::Material& source, const std::string& place,
                        MaterialDescription& result);
  void set_volume(const tinygltf::Material& source, const std::string& place,
                  MaterialDescription& result);
  void set_index(const tinygltf::Material& source, const std::string& place,
                 MaterialDescription& result);
  void set_sheen(const tinygltf::Material& source, const std::string& place,
                 MaterialDescription& result);
  void set_clearcoat(const tinygltf::Material& source, const std::string& place,
                     MaterialDescription& result);
  /// A number, times a texture's components with these weights where there is one.
  Parameter number_of(float factor, const TextureUse& use, const std::string& place,
                      const Color& weights);
  void set_emission(const tinygltf::Material& source, const std::string& place,
                    MaterialDescription& result);
  void set_opacity(const tinygltf::Material& source, const std::string& place,
                   MaterialDescription& result);
  /// Adds a material, under its normal map if it has one.
  std::uint32_t add(const tinygltf::Material& source, const std::string& place);

  File& file_;
  SceneData& scene_;
  Textures textures_;
  std::map<int, std::uint32_t> numbers_;
};

}  // namespace pt::gltf
