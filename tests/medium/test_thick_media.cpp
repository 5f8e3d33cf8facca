// Many collisions, against the exact solutions of radiative transfer in plane layers that scatter
// isotropically.
//
// Chandrasekhar 1960, 'Radiative Transfer', chapters 3 to 5: the H-function, 1 / H(mu) =
// sqrt(1 - w) + w / 2 * integral from 0 to 1 of m H(m) / (mu + m), gives what a half-space of
// albedo w reflects: under a sky of ones 1 - sqrt(1 - w) H(mu); of a parallel beam of irradiance E
// (across itself) that arrives at the cosine mu0, the radiance E w / (4 pi) mu0 / (mu + mu0) H(mu)
// H(mu0). Van de Hulst 1980, 'Multiple Light Scattering', chapters 5 and 9: a deep layer of albedo
// 1 and depth b under a sky of ones on one side shines on the other with H(mu) / (sqrt(3) (b
// + 1.420892)).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "medium/medium_scenes.h"

namespace pt {
namespace {

/// Solved by iteration at the middles of intervals that are fine near 0.
class HFunction {
 public:
  explicit HFunction(double albedo) : albedo_(albedo) {
    for (int i = 0; i < nodes; ++i) {
      const double s = (i + 0.5) / nodes;
      mu_.push_back(s * s), width_.push_back(2 * s / nodes), values_.push_back(1);
    }
    for (int round = 0; round < 60; ++round) {
      std::vector<double> next;
      for (const double mu : mu_) next.push_back((*this)(mu));
      for (std::size_t i = 0; i < next.size(); ++i) values_[i] = 0.5 * (values_[i] + next[i]);
    }
  }

  double operator()(double mu) const {
    double sum = 0;
    for (std::size_t i = 0; i < mu_.size(); ++i) {
      sum += mu_[i] * values_[i] / (mu + mu_[i]) * width_[i];
    }
    return 1 / (std::sqrt(1 - albedo_) + 0.5 * albedo_ * sum);
  }

  double integral() const {
    double sum = 0;
    for (std::size_t i = 0; i < mu_.size(); ++i) sum += values_[i] * width_[i];
    return sum;
  }

 private:
  static constexpr int nodes = 300;
  double albedo_;
  std::vector<double> mu_, width_, values_;
};

TEST(HFunctionOfTheTests, HasItsKnownIntegralAndValues) {
  for (const double albedo : {0.3, 0.9, 1.0}) {
    const double expected = 2 / albedo * (1 - std::sqrt(1 - albedo));
    EXPECT_NEAR(HFunction(albedo).integral(), expected, 2e-4 * expected);
  }
  EXPECT_NEAR(HFunction(1.0)(1.0), 2.9078, 1e-3);  // Chandrasekhar, table XI
}

/// Everything below y = 0, seen under a cosine from above.
SceneData half_space(const Medium& medium, double mu) {
  SceneData scene;
  scene.name = "half-space";
  scene.media.push_back(medium);
  scene.add_quad({-200, 0, 200}, {400, 0, 0}, {0, 0, -400},
                 scene.add_material(make_boundary(no_medium, 0)));
  scene.sky = {Color(1.0f), Color(1.0f)};
  const auto height = static_cast<float>(40 * mu),
             away = static_cast<float>(40 * std::sqrt(1 - mu * mu));
  scene.camera = {{0, height, away}, {0, 0, 0}, {0, 0, -1}, 0.05f, 0.0f, 40.0f};
  return scene;
}

TEST(ThickMedia, HalfSpacesUnderTheSkyReflectWhatChandrasekharSays) {
  const glm::dvec3 albedo(0.5, 0.9, 0.99);
  for (const double mu : {0.95, 0.3}) {
    const SceneData scene = half_space(make_medium(Color(1.0f), Color(albedo)), mu);
    glm::dvec3 expected;
    for (int c = 0; c < 3; ++c) {
      expected[c] = 1 - std::sqrt(1 - albedo[c]) * HFunction(albedo[c])(mu);
    }
    expect_mean(render_medium(scene, {{"spp", "256"}, {"rr", "20"}}), expected, 0.01, 1e-3);
  }
}

// A density changes lengths alone, in a grid that few paths leave; with depth it grows here from
// nothing to twice the usual.
TEST(ThickMedia, HalfSpacesOfVaryingDensityReflectTheSame) {
  const double albedo = 0.9, mu = 0.6;
  SceneData scene = half_space(make_medium(Color(1.0f), Color(0.9f)), mu);
  scene.media[0].density_grid = add_grid(
      scene, make_volume({1, 32, 1}, 1, true, translate({-300, -80, -300}) * scale({600, 80, 600}),
                         [](const GridSize& v, std::uint32_t) {
                           return v[1] % 3 == 0 ? 0.1 : 0.06 * (33.0 - v[1]);
                         }));
  const double expected = 1 - std::sqrt(1 - albedo) * HFunction(albedo)(mu);
  expect_mean(render_medium(scene, {{"spp", "64"}, {"rr", "20"}}), glm::dvec3(expected), 0.01,
              1e-3);
}

TEST(ThickMedia, HalfSpacesReflectTheSunAsChandrasekharSays) {
  const glm::dvec3 albedo(0.5, 0.9, 0.97);
  const double mu = 0.7, mu0 = 0.6;
  SceneData scene = half_space(make_medium(Color(2.0f), Color(albedo)), mu);
  darken_sky(scene);
  DeltaLight sun;
  sun.kind = LightKind::directional;
  sun.direction = {0.8f, -0.6f, 0};
  sun.intensity = Color(4.0f);
  scene.delta_lights.push_back(sun);
  glm::dvec3 expected;
  for (int c = 0; c < 3; ++c) {
    const HFunction h(albedo[c]);
    expected[c] = 4 * albedo[c] / (4 * pi_double) * mu0 / (mu + mu0) * h(mu) * h(mu0);
  }
  expect_mean(render_medium(scene, {{"spp", "128"}, {"rr", "20"}}), expected, 0.01, 1e-3);
}

// Diffusion: a lamp as wide as the layer shines on the back of it.
TEST(ThickMedia, DeepLayersLetThroughWhatDiffusionSays) {
  const HFunction h(1);
  for (const auto& [depth, mu] : {std::pair{5.0, 1.0}, {8.0, 0.4}}) {
    SceneData scene = half_space(make_medium(Color(1.0f), Color(1.0f)), mu);
    darken_sky(scene);
    const auto y = static_cast<float>(-depth);
    scene.add_quad({-200, y, 200}, {400, 0, 0}, {0, 0, -400},
                   scene.add_material(make_boundary(0, no_medium)));
    scene.add_quad({-200, y - 0.01f, 200}, {400, 0, 0}, {0, 0, -400},
                   scene.add_material(make_diffuse(Color(0.0f), Color(1.0f))));
    const double expected = h(mu) / (std::sqrt(3.0) * (depth + 1.420892));
    expect_mean(render_medium(scene, {{"spp", "512"}, {"nee", "off"}}), glm::dvec3(expected), 0.01,
                2e-3);
  }
}

}  // namespace
}  // namespace pt
