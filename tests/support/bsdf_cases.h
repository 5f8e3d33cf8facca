// Every BSDF of the list with parameters for tests: the ends of each one's range and between. A new
// BSDF needs a specialization here, and tests do not compile without it.
#pragma once

#include <vector>

#include "common/scene/material_description.h"

namespace pt {

struct BsdfCase {
  const char* name;
  MaterialDescription material;
  bool is_reciprocal = true;
};

/// White ones and coloured ones.
template <class Bsdf>
std::vector<BsdfCase> bsdf_cases();

inline const Color white_case(1.0f), coloured_case(0.25f, 0.5f, 0.75f);

template <>
inline std::vector<BsdfCase> bsdf_cases<Diffuse>() {
  return {{"diffuse, white", make_diffuse(white_case)}, {"diffuse", make_diffuse(coloured_case)}};
}

/// Not reciprocal when fuzzy: its lobe is absorbed below the surface.
template <>
inline std::vector<BsdfCase> bsdf_cases<Metal>() {
  return {{"mirror, white", make_metal(white_case, 0)},
          {"mirror", make_metal(coloured_case, 0)},
          {"metal, fuzz 0.05", make_metal(white_case, 0.05f), false},
          {"metal, fuzz 0.3", make_metal(coloured_case, 0.3f), false},
          {"metal, fuzz 1", make_metal(white_case, 1), false}};
}

template <>
inline std::vector<BsdfCase> bsdf_cases<Dielectric>() {
  return {{"glass", make_dielectric(white_case, 1.5f)},
          {"tinted diamond", make_dielectric(coloured_case, 2.4f)},
          {"air in glass", make_dielectric(white_case, 1 / 1.5f)},
          {"nothing", make_dielectric(white_case, 1)}};
}

inline std::vector<BsdfCase> all_bsdf_cases() {
  std::vector<BsdfCase> all;
  for_each_type(Bsdfs{}, [&](auto type) {
    const auto cases = bsdf_cases<typename decltype(type)::type>();
    all.insert(all.end(), cases.begin(), cases.end());
  });
  return all;
}

}  // namespace pt
