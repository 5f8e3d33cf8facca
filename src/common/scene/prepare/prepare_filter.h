// Reconstruction filters: what --filter and scene files name becomes a table to draw from.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// f(x), x in pixels from the centre, not normalised (filters.h). 0 beyond filter_radius.
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
