// Which source of random numbers a render has: by its scene's kernels and --rng.
#pragma once

#include "common/options/options.h"
#include "common/sampling/sampler_source.h"
#include "common/scene/data/scene.h"

namespace pt {

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
