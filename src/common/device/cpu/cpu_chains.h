// Markov chains on the CPU (docs/design/metropolis.md): their memory, and what they do before and
// after their paths are traced.
#pragma once

#include <vector>

#include "common/render/chain_layout.h"

namespace pt {

class CpuRenderer;

class CpuChains : public ChainDevice {
 public:
  /// Traces paths by `renderer`, which must outlive this.
  CpuChains(CpuRenderer& renderer, const ChainLayout& layout);

  /// What paths draw their numbers from.
  const Chains* numbers() const { return arrays_.chains; }
  std::uint64_t size_bytes() const;

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
  template <class Function>
  void for_each_path(std::uint32_t count, Function&& function);

  CpuRenderer& renderer_;
  const ChainLayout layout_;
  ChainWindow window_;
  ChainArrays arrays_;
  ChainRun run_;
  std::vector<std::vector<char>> memory_;  ///< of arrays_
};

}  // namespace pt
