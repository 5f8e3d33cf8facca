// Definition of MegakernelCuda::launch_megakernel, for the files that instantiate it.
#pragma once

#include "common/device/cuda/curand_state.cuh"
#include "megakernel/megakernel_cuda.h"
#include "megakernel/megakernel_kernel.cuh"

namespace pt {

template <class Kernel>
dim3 MegakernelCuda::grid_size(Kernel kernel, dim3 block, std::size_t shared_bytes,
                               const SampleBuffer& batch) {
  if (plan_.work == Work::persistent) {
    return dim3(resident_blocks(reinterpret_cast<const void*>(kernel),
                                static_cast<int>(block.x * block.y), shared_bytes));
  }
  return dim3((batch.width.divisor() + block.x - 1) / block.x,
              (batch.height() + block.y - 1) / block.y,
              plan_.work == Work::sample ? batch.sample_count : 1);
}

template <SceneMemory memory, class Source>
void MegakernelCuda::launch_megakernel(const SceneStorage<memory>& storage,
                                       std::size_t shared_bytes, const Source& source,
                                       const SampleBuffer& batch) {
  const dim3 block(plan_.block.x, plan_.block.y);
  const WorkDivision division{plan_.work, batch.width.divisor(), batch.height(), next_path_};
  using Kernels = KernelSelection<true, Source, memory, KernelBody::loop>;
  dispatch_traits(TraitsOf<Kernels>{}, traits_, [&](auto traits) {
    using Kind = decltype(traits);
    dispatch_branching<true, Kind, Source, memory, KernelBody::loop>(
        plan_.branching, [&](auto branching) {
          constexpr auto kernel = megakernel<Kind, decltype(branching)::value, memory, Source>;
          launch("megakernel", kernel, grid_size(kernel, block, shared_bytes, batch), block,
                 shared_bytes, storage, batch, division, source, path_settings_, clock());
        });
  });
}

}  // namespace pt
