#include "common/device/cuda/film_kernels.cuh"
#include "common/device/cuda/stage_stamp.cuh"

namespace pt {
namespace {

template <class Traits>
__global__ void find_features(const __grid_constant__ Scene scene,
                              const __grid_constant__ FilmView film,
                              const __grid_constant__ SampleBuffer batch, SamplerSource source,
                              StageClock* clock) {
  stamp_first_thread(clock, StageId::features);
  const std::uint32_t pixel = blockIdx.x * blockDim.x + threadIdx.x;
  if (pixel >= batch.pixel_count.divisor()) return;
  accumulate_features<Traits>(film, batch, scene, source, pixel);
}

}  // namespace

FeatureKernel feature_kernel(const SceneTraits& traits) {
  using Kinds =
      TypeList<Traits<Accel::brute, Geometry::spheres_and_quads, Lighting::sky>,
               Traits<Accel::bvh2, Geometry::spheres_and_quads, Lighting::sky>,
               Traits<Accel::bvh2, Geometry::mixed, Lighting::full>,
               Traits<Accel::cwbvh, Geometry::mixed, Lighting::full>,
               Traits<Accel::bvh2, Geometry::mixed, Lighting::full, true>,
               Traits<Accel::cwbvh, Geometry::mixed, Lighting::full, true>,
               Traits<Accel::bvh2, Geometry::mixed, Lighting::full, true, true>,
               Traits<Accel::cwbvh, Geometry::mixed, Lighting::full, true, true>,
               Traits<Accel::bvh2, Geometry::mixed, Lighting::full, true, true, true>,
               Traits<Accel::bvh2, Geometry::mixed, Lighting::full, false, false, false, true>,
               Traits<Accel::cwbvh, Geometry::mixed, Lighting::full, false, false, false, true>,
               Traits<Accel::bvh2, Geometry::mixed, Lighting::full, true, true, false, true>>;
  FeatureKernel kernel = nullptr;
  dispatch_traits(Kinds{}, feature_traits(traits),
                  [&](auto kind) { kernel = find_features<decltype(kind)>; });
  return kernel;
}

}  // namespace pt
