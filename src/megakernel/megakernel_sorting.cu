// Scenes of triangles alone, without masks, by blocks that sort their paths.
#include "megakernel/sorting_kernel.cuh"

namespace pt {

bool MegakernelCuda::can_sort() const {
  constexpr std::size_t shared_bytes =
      std::max(sizeof(BlockMemory<SortingTraits<false>>), sizeof(BlockMemory<SortingTraits<true>>));
  using Masked = Traits<Accel::cwbvh, Geometry::mixed, Lighting::full, true>;
  const bool is_plain = traits_ == SortingTraits<false>::value();
  const bool is_masked = traits_ == Masked::value() && scene_.has_only_triangles();
  return (is_plain || is_masked) && options_.work == Work::persistent &&
         shared_bytes <= properties_.sharedMemPerBlockOptin;
}

template void MegakernelCuda::allocate_slots<false>();
template void MegakernelCuda::launch_sorting<false>(const SamplerSource&, const SampleBuffer&);

}  // namespace pt
