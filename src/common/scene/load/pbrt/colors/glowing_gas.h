// What gas of a temperature emits, as pbrt has it.
#pragma once

#include <vector>

#include "common/math/vec.h"
#include "common/scene/load/pbrt/syntax/parameters.h"

namespace pt::pbrt {

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
