// What the options have a film sum.
#pragma once

#include "common/film/film_planes.h"
#include "common/options/options.h"
#include "common/sampling/pixel_filter.h"

namespace pt {

inline FilmPlan film_plan_of(const Options& options, const PixelFilter& filter) {
  return {options.aovs, needs_moments(options.aovs) || options.target_error > 0.0f,
          filter.has_negative()};
}

}  // namespace pt
