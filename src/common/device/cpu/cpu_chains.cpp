#include "common/device/cpu/cpu_chains.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "common/device/cpu/cpu_renderer.h"

namespace pt {

CpuChains::CpuChains(CpuRenderer& renderer, const ChainLayout& layout)
    : renderer_(renderer), layout_(layout) {
  layout_.make_arrays(arrays_, [&]<class T>(T*& pointer, std::uint64_t count) {
    // operator new aligns for all of them.
    memory_.emplace_back(count * sizeof(T));
    pointer = reinterpret_cast<T*>(memory_.back().data());
  });
}

std::uint64_t CpuChains::size_bytes() const {
  std::uint64_t bytes = 0;
  for (const std::vector<char>& array : memory_) bytes += array.size();
  return bytes;
}

void CpuChains::begin_chains(const ChainWindow& window) {
  window_ = window;
  *arrays_.chains = layout_.view(arrays_, window);
  clear_sums();
}

void CpuChains::clear_sums() {
  std::fill_n(arrays_.counts, ChainCounts::copies, ChainCounts{});
  std::fill_n(arrays_.sums, sum_count(window_), SplatSum{0});
}

/// In parallel, within the time of the stage `mutate`.
template <class Function>
void CpuChains::for_each_path(std::uint32_t count, Function&& function) {
  renderer_.timer_.time(to_string(StageId::mutate), [&] {
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, 64), [&](const auto& range) {
      for (std::uint32_t i = range.begin(); i < range.end(); ++i) function(i);
    });
  });
}

bool CpuChains::trace_bootstrap(std::uint32_t first, std::uint32_t count, RenderRun& run,
                                const std::function<bool()>& cancel) {
  const SampleBuffer batch = layout_.batch(count);
  bool is_whole = true;
  renderer_.time_in_arena(run, [&] {
    for_each_path(count,
                  [&](std::uint32_t i) { arrays_.proposals[i] = bootstrap_path(first + i); });
    is_whole = renderer_.trace_whole(batch, cancel);
    if (!is_whole) return;
    for_each_path(count, [&](std::uint32_t i) {
      arrays_.bootstrap.targets[first + i] = target_of(batch.samples[i]);
    });
    renderer_.count_paths(batch);
  });
  return is_whole;
}

void CpuChains::splat_bootstrap(std::uint32_t count, const ChainStep& step, RenderRun& run) {
  renderer_.time_in_arena(run, [&] {
    for_each_path(count, [&](std::uint32_t i) {
      pt::splat_bootstrap(arrays_, step, arrays_.proposals[i], layout_.samples[i]);
    });
  });
}

std::vector<TargetSum> CpuChains::sum_targets(std::uint32_t paths, RenderRun& run) {
  const auto groups = static_cast<std::uint32_t>(Bootstrap::group_count(paths));
  const Bootstrap& bootstrap = arrays_.bootstrap;
  renderer_.time_in_arena(run, [&] {
    for_each_path(groups, [&](std::uint32_t group) {
      bootstrap.groups[group] = sum_group(bootstrap, group, paths);
    });
  });
  return {bootstrap.groups, bootstrap.groups + groups};
}

void CpuChains::start_chains(const ChainStarts& starts, const ChainStep& step, RenderRun& run) {
  const Bootstrap& bootstrap = arrays_.bootstrap;
  std::ranges::copy(starts.below, bootstrap.below);
  renderer_.time_in_arena(run, [&] {
    for_each_path(starts.positions.chains, [&](std::uint32_t chain) {
      arrays_.proposals[chain] = bootstrap_path(start_of(bootstrap, starts.positions, chain));
    });
  });
  step_together(starts.positions.chains, step, run);
}

/// Traces a path of each chain, and the chain takes this step.
void CpuChains::step_together(std::uint32_t chains, const ChainStep& step, RenderRun& run) {
  const SampleBuffer batch = layout_.batch(chains);
  renderer_.time_in_arena(run, [&] {
    renderer_.trace_batch(batch);
    for_each_path(chains, [&](std::uint32_t chain) {
      step_chain(arrays_, step, chain, batch.samples[chain]);
    });
  });
}

void CpuChains::mutate_chains(std::uint32_t chains, const ChainStep& step, std::uint32_t last,
                              RenderRun& run) {
  if (!renderer_.can_repeat_paths()) {
    while (arrays_.proposals[0].iteration <= last) step_together(chains, step, run);
    return;
  }
  const SampleBuffer batch = layout_.batch(chains);
  run_ = {arrays_, step, last};
  std::fill_n(batch.samples, chains, Sample{});
  renderer_.set_supply({&run_});
  renderer_.time_in_arena(run, [&] { renderer_.trace_batch(batch); });
  renderer_.set_supply({});
}

void CpuChains::finish_chains(std::uint32_t chains, const ChainStep& step, RenderRun& run) {
  renderer_.time_in_arena(run, [&] {
    for_each_path(chains, [&](std::uint32_t chain) { finish_chain(arrays_, step, chain); });
  });
}

ChainSums CpuChains::take_chain_sums() {
  ChainSums result{{arrays_.sums, arrays_.sums + sum_count(window_)}, {}, {}};
  result.add(arrays_.counts);
  clear_sums();
  return result;
}

}  // namespace pt
