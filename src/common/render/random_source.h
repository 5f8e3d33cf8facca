// Which source of random numbers a render has: by its scene's kernels and --rng.
#pragma once

#include "common/render/options.h"
#include "common/sampling/sampler_source.h"
#include "common/scene/scene.h"

namespace pt {

/// Calls function(source). `states`: those of --rng xorwow.
template <class State, class Function>
void with_random_source(const Options& options, const SceneTraits& traits, State* states,
                        Function&& function) {
  if (traits.geometry != Geometry::spheres_and_quads) {
    const auto samples = static_cast<std::uint32_t>(options.spp);
    function(SamplerSource{options.seed, make_sampler(options.sampler, samples)});
  } else if (options.rng == RngKind::philox) {
    function(PhiloxSource{options.seed});
  } else {
    function(XorwowSource<State>{states});
  }
}

}  // namespace pt
