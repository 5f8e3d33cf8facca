// Materials: metallic-roughness and its extensions as the principled BSDF, with their textures.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "common/math/vec.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/images/texture_store.h"
#include "common/scene/load/gltf/document.h"

namespace pt::gltf {

/// A textureInfo object: which texture, and how it lies on the surface.
struct TextureUse {
  int texture = -1;  ///< number in the file, -1: none
  int tex_coord = 0;
  tinygltf::Value transform;  ///< KHR_texture_transform, or null

  explicit operator bool() const { return texture >= 0; }
};

/// `info`: of a material; texture_use(Value): within an extension; null: none.
template <class Info>
TextureUse texture_use(const Info& info);
template <>
TextureUse texture_use(const tinygltf::Value& info);

/// From a mesh's texture coordinates to those of another set of the file, both with v up.
struct UvMap {
  float u_row[3] = {1, 0, 0};
  float v_row[3] = {0, 1, 0};

  auto operator<=>(const UvMap&) const = default;
};
/// By the number of the set; those that are not in it are the mesh's own.
using UvMaps = std::map<int, UvMap>;

class Textures {
 public:
  /// Adds to `scene`, which outlives this.
  Textures(File& file, SceneData& scene) : file_(file), store_(scene.textures, scene.texels) {}

  // Each gives the number in the scene; `place` is that of the textureInfo. An image that cannot be
  // decoded is no_texture, with a warning.

  /// Sets the maps of the mesh whose textures are added from now on.
  void set_uv_maps(const UvMaps& maps) { uv_maps_ = maps; }

  /// A colour texture (sRGB).
  std::uint32_t add_color(const TextureUse& use, const std::string& place) {
    return add(use, place, TextureFormat::srgb8);
  }
  /// A normal map.
  std::uint32_t add_normals(const TextureUse& use, const std::string& place) {
    return add(use, place, TextureFormat::linear8, {}, "there is no map");
  }
  /// One of numbers: the weighted sum of its components, in all of them.
  std::uint32_t add_number(const TextureUse& use, const std::string& place, const Color& weights) {
    return add(use, place, TextureFormat::linear8, weights);
  }
  /// The alpha of a colour texture; no_texture, too, where it is 1 everywhere.
  std::uint32_t add_alpha(const TextureUse& use, const std::string& place) {
    const std::uint32_t color = add_color(use, place);
    return color == no_texture ? no_texture : store_.add_alpha_of(color);
  }

  /// For one of two surfaces, one behind the other, that are to look like one with the opacity
  /// a = `factor` times the picture's alpha: their opacity, 1 - sqrt(1 - a), and what their
  /// emission is to be multiplied by, 1 + sqrt(1 - a), `coloured`: times the picture's colour.
  struct Veil {
    std::uint32_t opacity, emission;
  };
  std::optional<Veil> add_veil(const TextureUse& use, const std::string& place, float factor,
                               bool coloured);

  /// Announces that add...() will be called (read_ahead.h).
  void read_ahead(const TextureUse& use, TextureFormat format) const;

  /// Mean of the image's linear R, G, B over all texels, in [0, 1]. White, and a warning, where the
  /// image cannot be decoded: a factor is then used alone.
  Color mean(const TextureUse& use, const std::string& place);

 private:
  struct Encoded {
    std::string_view bytes;
    std::string name;
  };

  std::uint32_t add(const TextureUse& use, const std::string& place, TextureFormat format,
                    const std::optional<Color>& weights = {},
                    const char* instead = "the factor alone is used");
  Texture look_of(const TextureUse& use, TextureFormat format);
  std::uint32_t decode(const TextureUse& use, const std::string& place, TextureFormat format,
                       const std::optional<Color>& weights);
  const tinygltf::Texture& texture(const TextureUse& use, const std::string& place) const;
  const tinygltf::Image& image_at(int source, const TextureUse& use) const;
  Encoded encoded_image(const TextureUse& use, const std::string& place) const;
  TextureImage integers(const TextureUse& use, const std::string& place) const;

  File& file_;
  TextureStore store_;
  UvMaps uv_maps_;
};

// Materials: metallic-roughness and its extensions as the principled BSDF.

/// Converts the materials that the scene uses, with their textures.
class Materials {
 public:
  /// Adds to `scene`, which outlives this.
  Materials(File& file, SceneData& scene) : file_(file), scene_(scene), textures_(file, scene) {}

  /// The scene's number of material `index` of the file, which exists, -1: the default material, on
  /// meshes with these texture coordinates.
  std::uint32_t material_index(int index, const UvMaps& maps);

  /// Announces the pictures of all materials, but for those of extensions (read_ahead.h).
  void read_ahead() const;

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
