#include <fmt/format.h>

#include "common/device/cuda/chain_kernels.cuh"
#include "common/device/cuda/cuda_chains.cuh"
#include "common/device/cuda/cuda_renderer.cuh"

namespace pt {

// Two chains for each thread that the device holds at once, about 2^19 on an H200. More take more
// mutations a second, but each walks a shorter way from its start: half as many and twice as many
// have a larger error at equal time (results/).
ChainDefaults CudaChains::defaults(const cudaDeviceProp& device) {
  return {2 * static_cast<std::uint64_t>(device.multiProcessorCount) *
              static_cast<std::uint64_t>(device.maxThreadsPerMultiProcessor),
          std::uint64_t{1} << 20, std::uint64_t{1} << 30, std::uint64_t{1} << 23};
}

CudaChains::CudaChains(CudaRenderer& renderer, const ChainLayout& layout)
    : renderer_(renderer), layout_(layout) {
  layout_.make_arrays(arrays_, [&]<class T>(T*& pointer, std::uint64_t count) {
    pointer = renderer_.memory_.allocate<T>("chains", count);
    check_cuda(cudaMemset(pointer, 0, count * sizeof(T)), "cudaMemset");
  });
  run_ = renderer_.memory_.allocate<ChainRun>("chains", 1);
}

void CudaChains::load_kernels(RenderRun& run) {
  begin_chains({0, 0, 1, 1});
  trace_bootstrap(0, 1, run, {});
  sum_targets(1, run);
  splat_bootstrap(1, {}, run);
  start_chains({0, 0, {0.0}, {}}, {}, run);
  mutate_chains(1, {}, 0, run);
  finish_chains(1, {}, run);
}

void CudaChains::begin_chains(const ChainWindow& window) {
  window_ = window;
  const Chains chains = layout_.view(arrays_, window);
  check_cuda(cudaMemcpyAsync(arrays_.chains, &chains, sizeof chains, cudaMemcpyHostToDevice,
                             renderer_.stream()),
             "cudaMemcpyAsync");
  steps_ = 0;
  clear_sums();
}

void CudaChains::clear_sums() {
  const std::uint64_t bytes = sum_count(window_) * sizeof(SplatSum);
  check_cuda(cudaMemsetAsync(arrays_.sums, 0, bytes, renderer_.stream()), "cudaMemset");
  check_cuda(cudaMemsetAsync(arrays_.counts, 0, ChainCounts::copies * sizeof(ChainCounts),
                             renderer_.stream()),
             "cudaMemset");
}

bool CudaChains::trace_bootstrap(std::uint32_t first, std::uint32_t count, RenderRun& run,
                                 const std::function<bool()>&) {
  const SampleBuffer batch = layout_.batch(count);
  const ProfilerRange range(fmt::format("{} bootstrap paths", count));
  renderer_.prepare_batch(batch);
  renderer_.time_batch(run, [&] {
    renderer_.launch_each("propose_bootstrap", propose_bootstrap, count, arrays_.proposals, first,
                          count, renderer_.clock());
    renderer_.trace_batch(batch);
    renderer_.set_wave(-1);
    renderer_.launch_each("keep_targets", keep_targets, count, arrays_.bootstrap.targets + first,
                          batch, renderer_.tally_, renderer_.clock());
  });
  return true;
}

void CudaChains::splat_bootstrap(std::uint32_t count, const ChainStep& step, RenderRun& run) {
  renderer_.time_batch(run, [&] {
    renderer_.launch_each("splat_bootstrap", splat_bootstrap_paths, count, arrays_,
                          layout_.batch(count), step, renderer_.clock());
  });
}

std::vector<TargetSum> CudaChains::sum_targets(std::uint32_t paths, RenderRun& run) {
  const auto groups = static_cast<std::uint32_t>(Bootstrap::group_count(paths));
  renderer_.time_batch(run, [&] {
    renderer_.launch_each("sum_targets", sum_groups, groups, arrays_.bootstrap, paths,
                          renderer_.clock());
  });
  std::vector<TargetSum> result(groups);
  check_cuda(cudaMemcpy(result.data(), arrays_.bootstrap.groups, groups * sizeof(TargetSum),
                        cudaMemcpyDeviceToHost),
             "downloading sums of targets");
  return result;
}

void CudaChains::start_chains(const ChainStarts& starts, const ChainStep& step, RenderRun& run) {
  check_cuda(cudaMemcpyAsync(arrays_.bootstrap.below, starts.below.data(),
                             starts.below.size() * sizeof(double), cudaMemcpyHostToDevice,
                             renderer_.stream()),
             "uploading sums of targets");
  renderer_.time_batch(run, [&] {
    renderer_.launch_each("propose_starts", propose_starts, starts.positions.chains, arrays_,
                          starts.positions, renderer_.clock());
  });
  step_together(starts.positions.chains, step, run);
}

/// Traces a path of each chain, and the chain takes this step.
void CudaChains::step_together(std::uint32_t chains, const ChainStep& step, RenderRun& run) {
  const SampleBuffer batch = layout_.batch(chains);
  const ProfilerRange range(fmt::format("batch of {} chains", chains));
  renderer_.prepare_batch(batch);
  renderer_.time_batch(run, [&] {
    renderer_.trace_batch(batch);
    renderer_.set_wave(-1);
    renderer_.launch_each("step_chains", step_chains, chains, arrays_, batch, step,
                          renderer_.clock());
  });
}

void CudaChains::mutate_chains(std::uint32_t chains, const ChainStep& step, std::uint32_t last,
                               RenderRun& run) {
  if (!renderer_.can_repeat_paths()) {
    for (; steps_ < last; ++steps_) step_together(chains, step, run);
    return;
  }
  const SampleBuffer batch = layout_.batch(chains);
  const ProfilerRange range(fmt::format("{} chains up to step {}", chains, last));
  const ChainRun chain_run{arrays_, step, last};
  check_cuda(cudaMemcpyAsync(run_, &chain_run, sizeof chain_run, cudaMemcpyHostToDevice,
                             renderer_.stream()),
             "cudaMemcpyAsync");
  check_cuda(cudaMemsetAsync(batch.samples, 0, chains * sizeof(Sample), renderer_.stream()),
             "cudaMemsetAsync");
  renderer_.set_supply({run_});
  renderer_.prepare_batch(batch);
  renderer_.time_batch(run, [&] { renderer_.trace_batch(batch); });
  renderer_.set_supply({});
}

void CudaChains::finish_chains(std::uint32_t chains, const ChainStep& step, RenderRun& run) {
  renderer_.time_batch(run, [&] {
    renderer_.launch_each("finish_chains", finish_all_chains, chains, arrays_, chains, step,
                          renderer_.clock());
  });
}

ChainSums CudaChains::take_chain_sums() {
  ChainSums result;
  result.sums.resize(sum_count(window_));
  check_cuda(cudaMemcpy(result.sums.data(), arrays_.sums, result.sums.size() * sizeof(SplatSum),
                        cudaMemcpyDeviceToHost),
             "downloading the film");
  std::vector<ChainCounts> counts(ChainCounts::copies);
  check_cuda(cudaMemcpy(counts.data(), arrays_.counts, counts.size() * sizeof counts[0],
                        cudaMemcpyDeviceToHost),
             "downloading counts");
  result.add(counts.data());
  clear_sums();
  return result;
}

}  // namespace pt
