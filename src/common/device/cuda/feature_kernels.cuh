// The pass that finds the features of first hits (film_planes.h): a thread per pixel.
#pragma once

#include <cuda_runtime_api.h>

#include "common/device/cuda/stage_clock.h"
#include "common/film/film_planes.h"
#include "common/render/dispatch.h"
#include "common/sampling/sampler_source.h"

namespace pt {

using FeatureKernel = void (*)(Scene scene, FilmView film, SampleBuffer batch, SamplerSource source,
                               StageClock* clock);

/// The kernel for a scene. Throws Error where there is none.
FeatureKernel feature_kernel(const SceneTraits& traits);

}  // namespace pt
