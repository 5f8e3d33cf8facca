// Plastics as materials: what their BSDFs need of the coat is computed here, once a material.
#pragma once

#include "common/scene/data/material_description.h"

namespace pt {

struct PlasticCoat {
  float eta = 1.49f;       ///< index of refraction inside over outside
  bool nonlinear = false;  ///< as in Mitsuba: the body colours each internal reflection
};

MaterialDescription make_plastic(const Color& diffuse, const Color& specular, PlasticCoat coat);

/// `alpha` is the roughness (see Microfacets); a texture of it changes the highlight alone.
MaterialDescription make_rough_plastic(const Color& diffuse, const Color& specular,
                                       PlasticCoat coat, float alpha, bool is_beckmann);

/// What a smooth boundary reflects of diffuse light; `eta` as in fresnel_dielectric.
double diffuse_reflectance(double eta);

}  // namespace pt
