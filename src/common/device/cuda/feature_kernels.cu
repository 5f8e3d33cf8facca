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

/// A kernel for each kind of scene that the table of kernels has, as far as features tell them
/// apart.
struct FeatureKernels {
  static constexpr bool has(const SceneTraits& kernel) {
    for (const KernelRow& row : kernel_table) {
      if (!row.on_cuda || !row.accels.contains(kernel.accel)) continue;
      SceneTraits scene = traits_of(row.extras);
      scene.accel = kernel.accel, scene.geometry = row.geometry;
      for (const Lighting lighting : {Lighting::sky, Lighting::emitters, Lighting::full}) {
        scene.lighting = lighting;
        if (row.lighting.contains(lighting) && feature_traits(scene) == kernel) return true;
      }
    }
    return false;
  }
};

}  // namespace

FeatureKernel feature_kernel(const SceneTraits& traits) {
  FeatureKernel kernel = nullptr;
  dispatch_traits(TraitsOf<FeatureKernels>{}, feature_traits(traits),
                  [&](auto kind) { kernel = find_features<decltype(kind)>; });
  return kernel;
}

}  // namespace pt
