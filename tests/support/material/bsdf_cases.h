// Every BSDF of the list with parameters for tests: the ends of each one's range and between. A new
// BSDF needs a specialization here, and tests do not compile without it.
#pragma once

#include <string>
#include <vector>

#include "common/scene/data/plastic_material.h"

namespace pt {

struct BsdfCase {
  const char* name;
  MaterialDescription material;
  bool is_reciprocal = true;
  bool is_lossless = false;  ///< all light leaves again
  bool is_complete = false;  ///< no sample is absorbed: the densities' integral is 1
  bool is_sharp = false;     ///< too sharp for quadrature: only finite values are expected
  double albedo_max = 1;     ///< energy that leaves, at most
};

/// White ones and coloured ones.
template <class Bsdf>
std::vector<BsdfCase> bsdf_cases() = delete;

inline const Color white_case(1.0f), coloured_case(0.25f, 0.5f, 0.75f);

template <>
inline std::vector<BsdfCase> bsdf_cases<Diffuse>() {
  return {{"diffuse, white", make_diffuse(white_case), true, true, true},
          {"diffuse", make_diffuse(coloured_case), true, false, true},
          {"diffuse, black", make_diffuse(Color(0.0f))}};
}

/// Not reciprocal when fuzzy: its lobe is absorbed below the surface.
template <>
inline std::vector<BsdfCase> bsdf_cases<Metal>() {
  return {{"mirror, white", make_metal(white_case, 0), true, true, true},
          {"mirror", make_metal(coloured_case, 0)},
          {"metal, fuzz 0.05", make_metal(white_case, 0.05f), false},
          {"metal, fuzz 0.3", make_metal(coloured_case, 0.3f), false},
          {"metal, fuzz 1", make_metal(white_case, 1), false},
          {"metal, fuzz 1e-6", make_metal(white_case, 1e-6f), false, false, false, true}};
}

template <>
inline std::vector<BsdfCase> bsdf_cases<Dielectric>() {
  return {{"glass", make_dielectric(white_case, 1.5f), true, true, true},
          {"tinted diamond", make_dielectric(coloured_case, 2.4f)},
          {"air in glass", make_dielectric(white_case, 1 / 1.5f), true, true, true},
          {"nothing", make_dielectric(white_case, 1), true, true, true}};
}

template <>
inline std::vector<BsdfCase> bsdf_cases<OrenNayar>() {
  const auto rough = [](const Color& albedo, float sigma) {
    return make_material<OrenNayar>(albedo, sigma);
  };
  return {{"oren-nayar, sigma 0", rough(white_case, 0), true, true, true},
          {"oren-nayar, sigma 0.2, white", rough(white_case, 0.2f), true, false, true},
          {"oren-nayar, sigma 0.5", rough(coloured_case, 0.5f), true, false, true},
          {"oren-nayar, sigma 1, white", rough(white_case, 1), true, false, true}};
}

template <>
inline std::vector<BsdfCase> bsdf_cases<Plastic>() {
  const Color white = white_case, black(0.0f);
  return {
      {"plastic, white", make_plastic(white, white, {1.5f}), true, true, true},
      {"plastic, nonlinear, white", make_plastic(white, white, {1.9f, true}), true, true, true},
      {"plastic", make_plastic(coloured_case, {0.9f, 0.5f, 0.7f}, {1.4f}), true, false, true},
      {"plastic, nonlinear", make_plastic(coloured_case, white, {1.33f, true}), true, false, true},
      {"plastic without coat", make_plastic(white, white, {1.0f}), true, true, true},
      {"plastic, no highlight", make_plastic(coloured_case, black, {1.5f}), true, false, true},
      {"plastic, black", make_plastic(black, white, {1.5f}), true, false, true},
      {"plastic, all black", make_plastic(black, black, {1.5f})}};
}

template <>
inline std::vector<BsdfCase> bsdf_cases<RoughPlastic>() {
  const Color white = white_case, black(0.0f);
  const auto rough = [](const Color& diffuse, const Color& specular, PlasticCoat coat, float alpha,
                        bool is_beckmann) {
    return make_rough_plastic(diffuse, specular, coat, alpha, is_beckmann);
  };
  return {{"rough plastic, white, 0.05", rough(white, white, {1.5f}, 0.05f, false)},
          {"rough plastic, white, 0.5", rough(white, white, {1.5f, true}, 0.5f, false)},
          {"rough plastic, 1", rough(coloured_case, white, {1.9f, true}, 1, false)},
          {"rough plastic, Beckmann, white, 0.1", rough(white, white, {1.3f}, 0.1f, true)},
          {"rough plastic, Beckmann, 0.4",
           rough(coloured_case, {0.9f, 0.5f, 0.7f}, {1.5f}, 0.4f, true)},
          {"rough plastic, no highlight", rough(coloured_case, black, {1.5f}, 0.3f, false)},
          {"rough plastic, all black", rough(black, black, {1.5f}, 0.3f, true)},
          {"rough plastic, 0", rough(white, white, {1.5f}, 0, false), true, false, false, true},
          {"rough plastic, Beckmann, 0", rough(white, white, {1.5f}, 0, true), true, false, false,
           true}};
}

template <>
inline std::vector<BsdfCase> bsdf_cases<Phong>() {
  const auto phong = [](const Color& diffuse, const Color& specular, float exponent) {
    return make_material<Phong>(diffuse, specular, exponent);
  };
  const Color white = white_case, black(0.0f);
  return {{"phong, diffuse", phong(white, black, 10), true, true, true},
          {"phong, 0", phong(black, white, 0)},
          {"phong, 5", phong(coloured_case, {0.7f, 0.4f, 0.1f}, 5)},
          {"phong, 30, above 1", phong(white, white, 30)},
          {"phong, 2000", phong(black, coloured_case, 2000)},
          {"phong, 1e7", phong(coloured_case, white, 1e7f), true, false, false, true}};
}

template <>
inline std::vector<BsdfCase> bsdf_cases<Ward>() {
  const auto ward = [](const Color& diffuse, const Color& specular, float x, float y) {
    return make_material<Ward>(diffuse, specular, x, y);
  };
  const Color white = white_case, black(0.0f);
  return {{"ward, diffuse", ward(white, black, 0.1f, 0.1f), true, true, true},
          {"ward, 0.05", ward(black, white, 0.05f, 0.05f)},
          {"ward, 0.1 0.4", ward(coloured_case, {0.7f, 0.4f, 0.1f}, 0.1f, 0.4f)},
          {"ward, 1, above 1", ward(white, white, 1, 1)},
          {"ward, 0", ward(coloured_case, white, 0, 0), true, false, false, true}};
}

/// Copper, and a mirror of all colours as Mitsuba's "none".
template <>
inline std::vector<BsdfCase> bsdf_cases<Conductor>() {
  const Color eta(0.2f, 0.92f, 1.1f), k(3.9f, 2.45f, 2.14f), none(0.0f);
  const auto conductor = [](const Color& tint, const Color& e, const Color& kappa, float ax,
                            float ay, int is_beckmann) {
    return make_material<Conductor>(tint, e, kappa, ax, ay, is_beckmann);
  };
  return {{"smooth copper", conductor(coloured_case, eta, k, 0, 0, 0)},
          {"GGX 0.02, white", conductor(white_case, none, white_case, 0.02f, 0.02f, 0)},
          {"GGX copper 0.3", conductor(white_case, eta, k, 0.3f, 0.3f, 0)},
          {"GGX copper 0.05, 0.6", conductor(coloured_case, eta, k, 0.05f, 0.6f, 0)},
          {"GGX 1, white", conductor(white_case, none, white_case, 1, 1, 0)},
          {"Beckmann 0.02, white", conductor(white_case, none, white_case, 0.02f, 0.02f, 1)},
          {"Beckmann copper 0.5, 0.1", conductor(white_case, eta, k, 0.5f, 0.1f, 1)},
          {"Beckmann 1, white", conductor(white_case, none, white_case, 1, 1, 1)}};
}

/// White ones lose nothing; the fit for Beckmann is not quite as good as the tests of that ask.
template <>
inline std::vector<BsdfCase> bsdf_cases<CompensatedConductor>() {
  std::vector<BsdfCase> cases = bsdf_cases<Conductor>();
  for (BsdfCase& one : cases) {
    one.material.kind = kind_of<CompensatedConductor>;
    const std::string name = one.name;
    one.is_lossless = name.starts_with("GGX") && name.ends_with("white");
  }
  return cases;
}

template <>
inline std::vector<BsdfCase> bsdf_cases<RoughDielectric>() {
  const auto glass = [](float eta, float ax, float ay, int is_beckmann) {
    return make_material<RoughDielectric>(white_case, white_case, eta, ax, ay, is_beckmann);
  };
  return {
      {"smooth glass of two tints",
       make_material<RoughDielectric>(coloured_case, white_case, 1.5f, 0, 0, 0), false},
      {"GGX glass 0.1", glass(1.5f, 0.1f, 0.1f, 0), false},
      {"GGX glass 0.5, 0.2", glass(1.33f, 0.5f, 0.2f, 0), false},
      {"GGX diamond 1", glass(2.4f, 1, 1, 0), false},
      {"GGX air in glass 0.3", glass(1 / 1.5f, 0.3f, 0.3f, 0), false},
      {"Beckmann glass 0.15", glass(1.5f, 0.15f, 0.15f, 1), false},
      {"Beckmann glass of two tints 0.4, 0.7",
       make_material<RoughDielectric>(coloured_case, Color(0.9f, 0.3f, 0.6f), 1.5f, 0.4f, 0.7f, 1),
       false}};
}

template <>
inline std::vector<BsdfCase> bsdf_cases<ThinDielectric>() {
  return {{"pane", make_material<ThinDielectric>(white_case, white_case, 1.5f)},
          {"stained pane", make_material<ThinDielectric>(white_case, coloured_case, 1.5f)},
          {"pane of nothing", make_material<ThinDielectric>(white_case, white_case, 1)}};
}

/// Base colour, roughness, metallic, transmission, eta, anisotropic, specular tint, sheen and its
/// tint, flatness, coat and its gloss. It does not quite conserve energy (Burley 2012).
template <>
inline std::vector<BsdfCase> bsdf_cases<Principled>() {
  const auto all = [](const auto&... parameters) {
    return make_material<Principled>(parameters...);
  };
  const Color c = coloured_case;
  return {
      {"principled, all 0", all(c, 0, 0, 0, 1.5f), true, false, false, true},
      {"principled", all(c, 0.5f, 0, 0, 1.5f)},
      {"principled metal", all(c, 0.4f, 1, 0, 1.5f, 0.8f)},
      {"principled glass", all(c, 0.5f, 0, 1, 1.5f), false},
      {"principled half glass",
       all(c, 0.6f, 0.3f, 0.5f, 1.33f, 0.5f, 0.4f, 0.3f, 0.7f, 0.5f, 0.8f, 0.5f), false},
      {"principled cloth", all(c, 1, 0, 0, 1.5f, 0, 0, 1, 1, 1), true, false, false, false, 1.35},
      {"principled paint", all(c, 0.6f, 0.2f, 0, 1.5f, 0, 1, 0, 0, 0, 1, 0.2f)}};
}

template <>
inline std::vector<BsdfCase> bsdf_cases<PrincipledThin>() {
  const auto all = [](const auto&... parameters) {
    return make_material<PrincipledThin>(parameters...);
  };
  const Color c = coloured_case;
  return {{"thin principled", all(c, 0.5f, 0, 1.5f)},
          {"thin principled leaf", all(c, 0.5f, 0, 1.5f, 0, 0, 0, 0, 0.3f, 1)},
          {"thin principled pane", all(c, 0.4f, 1, 1.5f), false},
          {"thin principled, half of all",
           all(c, 0.6f, 0.5f, 1.4f, 0.7f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f), false}};
}

inline const std::vector<BsdfCase>& all_bsdf_cases() {
  static std::vector<BsdfCase> all;
  if (!all.empty()) return all;
  for_each_type(Bsdfs{}, [&](auto type) {
    const auto cases = bsdf_cases<typename decltype(type)::type>();
    all.insert(all.end(), cases.begin(), cases.end());
  });
  return all;
}

}  // namespace pt
