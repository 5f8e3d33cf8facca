// From run-time choices to types: calls a generic function with the choice as a constant.
#pragma once

#include <type_traits>
#include <utility>

#include "common/render/options.h"
#include "common/scene/scene.h"

namespace pt {

template <auto value>
using Constant = std::integral_constant<decltype(value), value>;

/// function(Traits<...>{}) for the scene's traits.
template <class Function>
decltype(auto) dispatch_traits(SceneTraits traits, Function&& function) {
  if (traits.accel == Accel::brute) {
    return traits.has_lights ? function(Traits<Accel::brute, true>{})
                             : function(Traits<Accel::brute, false>{});
  }
  return traits.has_lights ? function(Traits<Accel::bvh2, true>{})
                           : function(Traits<Accel::bvh2, false>{});
}

/// function(Constant<branching>).
template <class Function>
decltype(auto) dispatch_branching(Branching branching, Function&& function) {
  return branching == Branching::divergent ? function(Constant<Branching::divergent>{})
                                           : function(Constant<Branching::reduced>{});
}

}  // namespace pt
