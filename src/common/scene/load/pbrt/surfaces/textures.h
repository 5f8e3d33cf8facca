// Colours, and values that may vary over a surface: the kinds of textures.
#pragma once

#include <functional>
#include <vector>

#include "common/scene/load/files/importer.h"
#include "common/scene/load/pbrt/syntax/context.h"

namespace pt::pbrt {

/// What a colour is for: pbrt's SpectrumType.
enum class Quantity { albedo, unbounded, illuminant };

/// rgb, spectrum, blackbody or float. An illuminant that is not rgb has luminance 1, whatever its
/// magnitude: pbrt divides each light by that of its spectrum (that of an rgb is of the colour
/// space's white), and its film multiplies by nothing, so that an rgb of 1 is a radiance of 1.
/// An albedo above 1 becomes 1 with a warning; negative numbers are an Error.
Color read_color(Context& context, const Parameter& parameter, Quantity quantity);

/// The same of the parameter `name`, or `fallback` where there is none.
Color read_color(Context& context, const Parameters& parameters, std::string_view name,
                 const Color& fallback, Quantity quantity);

/// An index of refraction that is one number: a float, or a glass by name; of another spectrum the
/// mean.
float read_index(Context& context, const Parameters& parameters, std::string_view name,
                 float fallback);

// What gas of a temperature emits, as pbrt has it.

/// A blackbody's spectrum over its largest value, in linear sRGB; its luminance is the integral
/// with y-bar, as pbrt's film has it of what was not divided by that of a light.
Color radiance_of_gas(double kelvins);

/// The same by a table: spectra are slow, and grids have millions of voxels.
class GlowingGas {
 public:
  explicit GlowingGas(float hottest_kelvins);

  static constexpr double y_integral = 106.856895;  ///< of y-bar over nm: CIE 1931

  /// Black up to 100 K; `kelvins` at most the hottest.
  Color radiance(float kelvins) const;

 private:
  float step_ = 1.0f;  ///< of the temperature's logarithm, between entries
  std::vector<Color> table_;
};

/// The light of gas of these temperatures, of which `parameters` have the offset and the scale;
/// `place` is theirs. Throws Error for temperatures that are not finite.
std::vector<Color> read_gas_light(const Parameters& parameters, const FileLocation& place,
                                  const std::vector<float>& temperatures);

// Values that may vary over a surface, and the kinds of textures.

inline ColorTexture scaled(ColorTexture value, const Color& by) {
  value.color *= by;
  return value;
}
inline ColorTexture scaled(const ColorTexture& value, float by) { return scaled(value, Color(by)); }

/// A texture and the mappings of what it is made of.
struct ReadTexture {
  ColorTexture value;
  std::vector<TextureMapping> mappings;
};

/// The parameter `name`, a colour or a texture by name, or `fallback` where there is none.
ColorTexture read_color_texture(Context& context, const Parameters& parameters,
                                std::string_view name, const Color& fallback,
                                Quantity quantity = Quantity::albedo);

/// The same of a number: all components are equal.
ColorTexture read_number_texture(Context& context, const Parameters& parameters,
                                 std::string_view name, float fallback);

/// A number that we cannot have as a texture: that becomes its factor with a warning.
float read_plain_number(Context& context, const Parameters& parameters, std::string_view name,
                        float fallback);

// The kinds of textures: each reads one.

/// What a texture is read for.
struct TextureUse {
  bool is_number;                ///< a float texture
  Quantity quantity;             ///< of a spectrum texture
  Color stand_in = Color(0.5f);  ///< of a picture that cannot be read
};

/// What the integers of an imagemap's picture mean. Throws Error.
TextureFormat encoding_of(const Parameters& imagemap, const std::filesystem::path& path);

ColorTexture read_image_map(Context& context, const Entity& entity, const TextureUse& use);
ColorTexture read_constant(Context& context, const Entity& entity, const TextureUse& use);
ColorTexture read_scale(Context& context, const Entity& entity, const TextureUse& use);
ColorTexture read_mix(Context& context, const Entity& entity, const TextureUse& use);
ColorTexture read_checkerboard(Context& context, const Entity& entity, const TextureUse& use);

/// A part of a texture, itself a texture or a value.
ColorTexture read_part(Context& context, const Parameters& parameters, std::string_view name,
                       float fallback, const TextureUse& use);

/// How the texture lies on surfaces: uscale and the like into its map, and all into
/// Context::mappings.
void read_mapping(Context& context, const Entity& entity, Texture& texture);

// Textures computed from others, texel by texel.

/// function(values of `parts`) as an image. Parts that are images with the same map of coordinates
/// give it theirs, and their size, so that texels meet texels; others are looked at over the unit
/// square of (u, v), which repeats.
ColorTexture bake(Context& context, const std::vector<ColorTexture>& parts,
                  const std::function<Color(const std::vector<Color>&)>& function);

}  // namespace pt::pbrt
