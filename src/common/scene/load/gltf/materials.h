// Materials: metallic-roughness and its extensions as the principled BSDF.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/gltf/textures.h"

namespace pt::gltf {

/// Converts the materials that the scene uses, with their textures.
class Materials {
 public:
  /// Adds to `scene`, which outlives this.
  Materials(File& file, SceneData& scene) : file_(file), scene_(scene), textures_(file, scene) {}

  /// The scene's number of material `index` of the file, which exists, -1: the default material, on
  /// meshes with these texture coordinates.
  std::uint32_t material_index(int index, const UvMaps& maps);

  /// Whether a material of the scene shines on both sides: its meshes need back_of().
  bool shines_on_both_sides(std::uint32_t number) const { return two_sided_.contains(number); }

  /// Whether material `index`, which has a number, is its base colour's light
  /// (KHR_materials_unlit).
  bool is_unlit(int index) const;

 private:
  /// `both_sides`: set where it shines on both.
  MaterialDescription convert(const tinygltf::Material& source, const std::string& place,
                              bool& both_sides);
  void set_base(const tinygltf::Material& source, const std::string& place,
                MaterialDescription& result);
  /// Whether light passes.
  bool set_metallic_roughness(const tinygltf::Material& source, const std::string& place,
                              MaterialDescription& result);
  void set_specular_glossiness(const tinygltf::Value& source, const std::string& place,
                               MaterialDescription& result);
  /// KHR_materials_transmission: how much of a dielectric base is clear; 0 without.
  Parameter transmission(const tinygltf::Material& source, const std::string& place);
  /// Adds a material that is part of another.
  std::uint32_t add_part(MaterialDescription part, float metallic);
  /// Blends the dielectric base with the clear wall, and both with the metal.
  void make_thin(const Parameter& transmission, MaterialDescription& result);
  /// The same with a mirror in place of the wall.
  void make_mirror(const Color& reflectance, MaterialDescription& result);
  /// Metalness as the weight of a metal over what the dielectric base is made of.
  MaterialDescription with_metal(const MaterialDescription& principled,
                                 const MaterialDescription& base);
  bool shine_on_both_sides(const tinygltf::Material& source, const std::string& place, bool passes,
                           MaterialDescription& result);
  void set_volume(const tinygltf::Material& source, const std::string& place,
                  MaterialDescription& result);
  /// The index of refraction of a dielectric base, and, where that is so large that it says how a
  /// mirror reflects, the mirror's reflectance (else black).
  struct Base {
    float eta = 1.5f;
    Color mirror = Color(0.0f);
  };
  Base base_of(const tinygltf::Material& source, const std::string& place, bool bends);
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
  std::uint32_t add(const tinygltf::Material& source, const std::string& place, bool& both_sides);

  File& file_;
  SceneData& scene_;
  Textures textures_;
  std::map<std::pair<int, UvMaps>, std::uint32_t> numbers_;
  std::set<std::uint32_t> two_sided_;
};

}  // namespace pt::gltf
