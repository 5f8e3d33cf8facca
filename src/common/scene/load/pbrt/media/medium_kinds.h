// The kinds of media: each reads one, and adds the grids that it needs to the scene.
#pragma once

#include "common/scene/load/pbrt/colors/read_color.h"

namespace pt::pbrt {

Medium read_homogeneous(Context& context, const Entity& entity);
Medium read_uniform_grid(Context& context, const Entity& entity);
Medium read_rgb_grid(Context& context, const Entity& entity);
Medium read_cloud(Context& context, const Entity& entity);
Medium read_nanovdb_grids(Context& context, const Entity& entity);

/// Extinction and albedo by sigma_a and sigma_s (both 1 unless they are given) times `scale`, and
/// the phase function by g.
Medium read_coefficients(Context& context, const Parameters& parameters, float scale);

/// By g, of which 0 is isotropic.
void read_phase(const Parameters& parameters, Medium& medium);

/// A factor, which must be finite and not negative.
float read_factor(const Parameters& parameters, std::string_view name, float fallback);

/// sigma_s of what has these coefficients, over their sum; 0 where there is nothing.
Color albedo_of(const Color& absorption, const Color& scattering);

}  // namespace pt::pbrt
