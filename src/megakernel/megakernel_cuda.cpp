#include "megakernel/megakernel_cuda.h"

#include <fmt/format.h>

#include "common/error.h"
#include "common/scene/scene_options.h"
#include "megakernel/megakernel.h"

namespace pt {

MegakernelCuda::MegakernelCuda(const Options& options, const SceneData& scene, int device)
    : CudaRenderer(options, scene, device), kernel_(choose_kernel()) {
  const std::int64_t threads = std::int64_t{options.block.x} * options.block.y;
  if (threads > properties_.maxThreadsPerBlock) {
    throw Error(fmt::format("--block {}x{}: {} threads; a block has at most {}", options.block.x,
                            options.block.y, threads, properties_.maxThreadsPerBlock));
  }
  if (kernel_ == MegakernelKind::vote && !can_vote()) {
    throw Error(
        fmt::format("--kernel vote: expected --accel cwbvh, --work persistent and a --block of 32 "
                    "to 256 threads, a multiple of 32; {}x{} has {}",
                    options.block.x, options.block.y, threads));
  }
  if (kernel_ == MegakernelKind::sort && !can_sort()) {
    throw Error(
        "--kernel sort: expected --accel cwbvh, --work persistent and a device whose blocks may "
        "have 73 KiB of shared memory");
  }
  next_path_ = memory_.allocate<std::uint32_t>("counters", 1);
  if (kernel_ != MegakernelKind::sort) return;
  if (traits_.has_masks) {
    allocate_slots<true>();
  } else {
    allocate_slots<false>();
  }
}

MegakernelKind MegakernelCuda::choose_kernel() const {
  if (options_.kernel != MegakernelKind::automatic) return options_.kernel;
  if (can_sort() && may_sort(options_)) return MegakernelKind::sort;
  return can_vote() ? MegakernelKind::vote : MegakernelKind::loop;
}

void MegakernelCuda::trace_batch(const SampleBuffer& batch) {
  check_cuda(cudaMemsetAsync(next_path_, 0, sizeof *next_path_, stream()), "cudaMemsetAsync");
  with_random_source([&](const auto& source) {
    using Source = std::remove_cvref_t<decltype(source)>;
    const SceneStorage<SceneMemory::global> in_global{scene_};
    if constexpr (std::is_same_v<Source, SamplerSource>) {
      if (kernel_ == MegakernelKind::vote) return launch_phase_voting(source, batch);
      if (kernel_ == MegakernelKind::sort) {
        return traits_.has_masks ? launch_block_wavefront<true>(source, batch)
                                 : launch_block_wavefront<false>(source, batch);
      }
      launch_megakernel(in_global, 0, source, batch);
    } else {
      if constexpr (std::is_same_v<Source, PhiloxSource>) {
        if (traits_.accel == Accel::brute) {
          return with_scene_storage([&](const auto& storage, std::size_t shared_bytes) {
            launch_megakernel(storage, shared_bytes, source, batch);
          });
        }
      }
      launch_megakernel(in_global, 0, source, batch);
    }
  });
}

std::unique_ptr<Renderer> make_megakernel_cuda(const Options& options, const SceneData& scene,
                                               int device) {
  return std::make_unique<MegakernelCuda>(options, scene, device);
}

}  // namespace pt
