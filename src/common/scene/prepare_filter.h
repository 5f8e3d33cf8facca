// Reconstruction filters: what --filter and scene files name becomes a table to draw from.
#pragma once

#include "common/scene/scene_data.h"

namespace pt {

/// f(x), x in pixels from the centre, not normalised. 0 beyond filter_radius.
///   box       1
///   tent      1 - |x| / radius
///   gaussian  exp(-x^2 / (2 sigma^2)), cut off at 4 sigma and lowered so that it is 0 there
///   mitchell  the cubic with B and C of Mitchell and Netravali, Reconstruction Filters in Computer
///             Graphics, 1988
///   lanczos   sinc(x) sinc(x / lobes)
double filter_value(const FilterChoice& filter, double x);
double filter_radius(const FilterChoice& filter);

/// The parameters that a filter has unless others are given.
FilterChoice default_filter(FilterKind kind);

/// The options' choice, else the scene file's, else a box of one pixel.
FilterChoice filter_of(const Options& options, const SceneData& scene);

/// Fills in `filter` and its table. Throws Error for a filter whose negative part outweighs the
/// positive one.
void prepare_filter(SceneData& scene, const FilterChoice& filter);

}  // namespace pt
