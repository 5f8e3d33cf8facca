// The kernels before and after the paths. Seen from C++, a kernel is the function that launches it.
#pragma once

#include <cuda_runtime_api.h>

#include "common/device/cuda/stage_clock.h"
#include "common/film/film_planes.h"
#include "common/render/dispatch.h"
#include "common/sampling/sampler_source.h"

namespace pt {

struct CurandState;
std::size_t random_state_bytes();

/// The paper's render_init: one generator state per path of the batch.
__global__ void render_init(CurandState* states, SampleBuffer batch, std::uint64_t seed,
                            StageClock* clock);

/// Adds the batch's samples to the film and to the tally: a thread per pixel.
__global__ void accumulate_film(FilmPixel* film, SampleBuffer batch, PathTally* tally,
                                StageClock* clock);

/// The same with all that a film may sum (film_planes.h).
__global__ void accumulate_planes(const __grid_constant__ FilmView film,
                                  const __grid_constant__ SampleBuffer batch,
                                  const __grid_constant__ PixelFilter filter, SamplerSource source,
                                  PathTally* tally, StageClock* clock);

/// Enqueues what writes each pixel's mean: 3 floats.
void develop_film(const FilmPixel* film, float* rgb, std::uint32_t pixel_count,
                  cudaStream_t stream);

/// The stage clock runs from the first of these on, to the second with StageId::idle; of one thread
/// each.
__global__ void start_clock(StageClock* clock);
__global__ void stamp_stage(StageClock* clock, StageId id);

using FeatureKernel = void (*)(Scene scene, FilmView film, SampleBuffer batch, SamplerSource source,
                               StageClock* clock);

/// The kernel for a scene. Throws Error where there is none.
FeatureKernel feature_kernel(const SceneTraits& traits);

}  // namespace pt
