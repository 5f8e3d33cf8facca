#include "common/device/feature_kernels.cuh"
#include "common/device/stage_stamp.cuh"

namespace pt {
namespace {

template <class Traits>
__global__ void find_features(const __grid_constant__ Scene scene,
                              const __grid_constant__ FilmView film,
                              const __grid_constant__ SampleBuffer batch, PhiloxSource source,
                              StageClock* clock) {
  stamp_first_thread(clock, StageId::features);
  const std::uint32_t pixel = blockIdx.x * blockDim.x + threadIdx.x;
  if (pixel >= batch.pixel_count.divisor()) return;
  accumulate_features<Traits>(film, batch, scene, source, pixel);
}

}  // namespace

FeatureKernel feature_kernel(const SceneTraits& traits) {
  // Features know no light: scenes of spheres and quads need no kernel for each kind of lighting.
  const bool has_textures = traits.geometry != Geometry::spheres_and_quads;
  const SceneTraits needed = {traits.accel, traits.geometry,
                              has_textures ? traits.lighting : Lighting::sky};
  using SphereKinds = TypeList<Traits<Accel::brute, Geometry::spheres_and_quads, Lighting::sky>,
                               Traits<Accel::bvh2, Geometry::spheres_and_quads, Lighting::sky>>;
  FeatureKernel kernel = nullptr;
  dispatch_traits(decltype(concatenate(SphereKinds{}, TriangleSceneKinds{})){}, needed,
                  [&](auto kind) { kernel = find_features<decltype(kind)>; });
  return kernel;
}

}  // namespace pt
