// How OptiX's candidates become hits (--optix-hits).
#pragma once

namespace pt {

enum class OptixHits {
  custom,    ///< OptiX meets boxes; our test decides in an intersection program
  any_hit,   ///< OptiX meets triangles; our test decides about each in an any-hit program
  built_in,  ///< OptiX decides; our test evaluates its choice
};

}  // namespace pt
