// What the options have a film sum.
#pragma once

#include "common/film/film_planes.h"
#include "common/options/options.h"
#include "common/sampling/pixel_filter.h"

namespace pt {

inline FilmPlan film_plan_of(const ImageSettings& settings, const PixelFilter& filter) {
  return {settings.aovs, needs_moments(settings.aovs) || settings.target_error > 0.0f,
          filter.has_negative()};
}

}  // namespace pt
