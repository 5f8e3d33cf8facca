// The paper's create_world kernel: the random spheres are made on the device, by one thread.
#pragma once

#include "common/scene/builtin/builtin_scenes.h"

namespace pt {

/// A creator that runs on the CUDA device of this ordinal. Only in a build with CUDA.
SphereWorldCreator create_world_on(int device);

}  // namespace pt
