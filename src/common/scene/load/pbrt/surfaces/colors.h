// Colours of all kinds to linear sRGB.
#pragma once

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
std::vector<Color> read_gas_light(const Parameters& parameters, const Place& place,
                                  const std::vector<float>& temperatures);

}  // namespace pt::pbrt
