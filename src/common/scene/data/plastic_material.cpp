#include "common/scene/data/plastic_material.h"

#include <cmath>

namespace pt {
namespace {

Color packed(PlasticCoat coat, float internal_reflectance) {
  return {coat.eta, coat.nonlinear ? 0.0f : internal_reflectance,
          coat.nonlinear ? internal_reflectance : 0.0f};
}

}  // namespace

double diffuse_reflectance(double eta) {
  constexpr int steps = 4096;  // of the cosine's square, in which diffuse light is uniform
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double cosine = std::sqrt((i + 0.5) / steps);
    sum += static_cast<double>(
        fresnel_dielectric(static_cast<float>(cosine), static_cast<float>(eta)));
  }
  return sum / steps;
}

MaterialDescription make_plastic(const Color& diffuse, const Color& specular, PlasticCoat coat) {
  MaterialDescription m = make_material<Plastic>(diffuse);
  m[&Plastic::specular].value = specular;
  const double inside = diffuse_reflectance(1.0 / static_cast<double>(coat.eta));
  m[&Plastic::coat].value = packed(coat, static_cast<float>(inside));
  return m;
}

MaterialDescription make_rough_plastic(const Color& diffuse, const Color& specular,
                                       PlasticCoat coat, float alpha, bool is_beckmann) {
  const RoughBoundary boundary = measure_rough_boundary(coat.eta, alpha, is_beckmann);
  const auto& t = boundary.transmittance;
  MaterialDescription m = make_material<RoughPlastic>(diffuse);
  m[&RoughPlastic::specular].value = specular;
  m[&RoughPlastic::alpha].value = Color(alpha);
  m[&RoughPlastic::coat].value = packed(coat, boundary.internal_reflectance);
  m[&RoughPlastic::transmittance_0].value = {t[0], t[1], t[2]};
  m[&RoughPlastic::transmittance_1].value = {t[3], t[4], t[5]};
  m[&RoughPlastic::transmittance_2].value = {t[6], t[7], t[8]};
  m[&RoughPlastic::is_beckmann].value = Color(is_beckmann ? 1.0f : 0.0f);
  return m;
}

}  // namespace pt
