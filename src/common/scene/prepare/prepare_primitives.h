// Spheres and quads made ready for tracing: their BVH, the spheres for the scan, the emitters.
#pragma once

#include "common/geometry/bounds.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Lists the emitters, joins the material numbers, makes the spheres of the scan and, if `tree`,
/// the binary BVH, which reorders the primitives. `others`: where else rays may begin.
void prepare_primitives(SceneData& scene, bool tree, const Bounds& others = {});

}  // namespace pt
