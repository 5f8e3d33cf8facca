// What film, paths and random numbers take of the settings of an image.
#pragma once

#include "common/film/film_planes.h"
#include "common/options/options.h"
#include "common/sampling/pixel_filter.h"
#include "common/sampling/sampler_source.h"
#include "common/scene/data/scene.h"
#include "common/transport/path.h"

namespace pt {

/// `path_bytes`: as in ExecutionSettings.
inline PathSettings path_settings_of(const ImageSettings& settings, int path_bytes = 0) {
  return {static_cast<std::uint32_t>(settings.max_depth),
          static_cast<std::uint32_t>(settings.rr_depth),
          settings.nee,
          settings.sampling,
          settings.mis,
          static_cast<std::uint32_t>(path_bytes / path_bytes_step)};
}

inline FilmPlan film_plan_of(const ImageSettings& settings, const PixelFilter& filter) {
  return {settings.aovs, needs_moments(settings.aovs) || settings.target_error > 0.0f,
          filter.has_negative()};
}

inline ShutterTimes shutter_times_of(const ImageSettings& settings) {
  return {settings.sampler, static_cast<std::uint32_t>(settings.spp)};
}

/// The numbers of a path that depend on its name alone, whichever kernels it has: those of a lean
/// scene are PhiloxSource's. `chains`: of --integrator mlt, else null.
inline SamplerSource sampler_source_of(const ImageSettings& settings,
                                       const Chains* chains = nullptr) {
  return {settings.seed, make_sampler(settings.sampler, static_cast<std::uint32_t>(settings.spp)),
          chains};
}

/// Calls function(source). `states`: those of --rng xorwow.
template <class State, class Function>
void with_random_source(const ImageSettings& settings, const SceneTraits& traits, State* states,
                        const Chains* chains, Function&& function) {
  if (traits.geometry != Geometry::spheres_and_quads) {
    function(sampler_source_of(settings, chains));
  } else if (settings.rng == RngKind::philox) {
    function(PhiloxSource{settings.seed});
  } else {
    function(XorwowSource<State>{states});
  }
}

}  // namespace pt
