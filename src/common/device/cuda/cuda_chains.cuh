// Markov chains on CUDA (docs/design/metropolis.md): their memory, and what they do before and
// after their paths are traced.
#pragma once

#include <cuda_runtime_api.h>

#include <vector>

#include "common/render/chain_layout.h"

namespace pt {

class CudaRenderer;

class CudaChains : public ChainDevice {
 public:
  /// Traces paths by `renderer`, which must outlive this.
  CudaChains(CudaRenderer& renderer, const ChainLayout& layout);

  static ChainDefaults defaults(const cudaDeviceProp& device);

  /// What paths draw their numbers from, in the device's memory.
  const Chains* numbers() const { return arrays_.chains; }
  /// Launches every kernel that chains use, for a path or two.
  void load_kernels(RenderRun& run);

  void begin_chains(const ChainWindow& window) override;
  bool trace_bootstrap(std::uint32_t first, std::uint32_t count, RenderRun& run,
                       const std::function<bool()>& cancel) override;
  void splat_bootstrap(std::uint32_t count, const ChainStep& step, RenderRun& run) override;
  std::vector<TargetSum> sum_targets(std::uint32_t paths, RenderRun& run) override;
  void start_chains(const ChainStarts& starts, const ChainStep& step, RenderRun& run) override;
  void mutate_chains(std::uint32_t chains, const ChainStep& step, std::uint32_t last,
                     RenderRun& run) override;
  void finish_chains(std::uint32_t chains, const ChainStep& step, RenderRun& run) override;
  ChainSums take_chain_sums() override;

 private:
  void clear_sums();
  void step_together(std::uint32_t chains, const ChainStep& step, RenderRun& run);

  CudaRenderer& renderer_;
  const ChainLayout layout_;
  ChainWindow window_;
  ChainArrays arrays_;
  ChainRun* run_ = nullptr;
  std::uint32_t steps_ = 0;  ///< that each chain has taken, where all take them together
};

}  // namespace pt
