#include "common/scene/load/pbrt/colors/white_balance.h"

#include "common/scene/load/mitsuba/spectra/spectra.h"
#include "common/scene/load/pbrt/syntax/color_space.h"

namespace pt::pbrt {
namespace {

using DVec3 = glm::dvec3;
using DMat3 = glm::dmat3;

/// CIE 15:2004, 3.1: the D illuminants, XYZ with Y = 1.
DVec3 daylight(double kelvins) {
  const double t = kelvins * 1.4388 / 1.4380;  // c2 was another then
  if (t < 4000) {
    const DVec3 xyz = xyz_from_srgb() * DVec3(mitsuba::blackbody_to_rgb(t));
    return xyz / xyz.y;
  }
  const double x = t <= 7000
                       ? 0.244063 + 0.09911e3 / t + 2.9678e6 / (t * t) - 4.6070e9 / (t * t * t)
                       : 0.237040 + 0.24748e3 / t + 1.9018e6 / (t * t) - 2.0064e9 / (t * t * t);
  const double y = -3.0 * x * x + 2.87 * x - 0.275;
  return {x / y, 1.0, (1.0 - x - y) / y};
}

/// Lam 1985, by columns.
const DMat3 cones_of_xyz(0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367, 1.0296);

/// A grid of colours has them all: it is multiplied by grey.
template <class Balance>
void balance_medium(SceneData& scene, const Balance& balance, Medium& medium) {
  if (medium.emission_grid == no_grid || scene.grids[medium.emission_grid].channels == 1) {
    return balance(medium.emission);
  }
  const VolumeGrid& grid = scene.grids[medium.emission_grid];
  const std::size_t voxels = std::size_t{grid.size[0]} * grid.size[1] * grid.size[2];
  for (std::size_t i = 0; i < voxels; ++i) {
    float* const values = &scene.grid_values[grid.first + 3 * i];
    Color color(values[0], values[1], values[2]);
    balance(color);
    for (int c = 0; c < 3; ++c) values[c] = color[c];
  }
}

}  // namespace

glm::mat3 white_balance(double kelvins) {
  const DVec3 from = cones_of_xyz * daylight(kelvins);
  const DVec3 to = cones_of_xyz * (xyz_from_srgb() * DVec3(1.0));
  DMat3 scale(0.0);
  for (int i = 0; i < 3; ++i) scale[i][i] = to[i] / from[i];
  const DMat3 balance = glm::inverse(cones_of_xyz) * scale * cones_of_xyz;
  return glm::mat3(glm::inverse(xyz_from_srgb()) * balance * xyz_from_srgb());
}

void balance_lights(SceneData& scene, double kelvins) {
  const glm::mat3 map = white_balance(kelvins);
  const auto balance = [&](Color& color) { color = glm::max(map * color, Color(0.0f)); };
  for (DeltaLight& light : scene.delta_lights) balance(light.intensity);
  for (MaterialDescription& material : scene.materials) balance(material.emission.radiance);
  for (Color& pixel : scene.environment.pixels) balance(pixel);
  balance(scene.sky.nadir), balance(scene.sky.zenith);
  for (Medium& medium : scene.media) balance_medium(scene, balance, medium);
}

}  // namespace pt::pbrt
