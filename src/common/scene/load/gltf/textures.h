// Textures: images, samplers and KHR_texture_transform.
#pragma once

#include <compare>
#include <map>
#include <optional>
#include <string>

#include "common/math/vec.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/images/texture_store.h"
#include "common/scene/load/gltf/document/file.h"

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

  /// Of the mesh whose textures are added from now on.
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

}  // namespace pt::gltf
