#include <fmt/format.h>

#include <algorithm>

#include "common/device/cuda/cuda_launcher.cuh"
#include "common/device/cuda/film_kernels.cuh"
#include "common/device/cuda/stage_clock.h"
#include "common/error/error.h"

namespace pt {

namespace {

cudaDeviceProp read_properties(int device, const DeviceLimits& limits) {
  cudaDeviceProp properties{};
  check_cuda(cudaGetDeviceProperties(&properties, device), "cudaGetDeviceProperties");
  if (limits.sms > 0) properties.multiProcessorCount = limits.sms;
  const auto shared_max = std::size_t{1024} * static_cast<std::size_t>(limits.shared_memory_max);
  if (shared_max > 0)
    properties.sharedMemPerBlockOptin = std::min(properties.sharedMemPerBlockOptin, shared_max);
  return properties;
}

}  // namespace

CudaLauncher::CudaLauncher(int device, const DeviceLimits& limits)
    : properties_(read_properties(device, limits)), device_(device, limits.sms) {
  const WallTimer timer;
  check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "cudaStreamCreate");
  check_cuda(cudaEventCreate(&start_), "cudaEventCreate");
  check_cuda(cudaEventCreate(&stop_), "cudaEventCreate");
  opening_ms_ = device_.opening_ms() + timer.ms();
}

CudaLauncher::~CudaLauncher() {
  cudaEventDestroy(start_);
  cudaEventDestroy(stop_);
  cudaStreamDestroy(stream_);
}

std::uint32_t CudaLauncher::resident_blocks(const void* kernel, int block_threads,
                                            std::size_t shared_bytes) {
  if (shared_bytes > 48 * 1024) {  // more than every kernel may take without asking
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                    static_cast<int>(shared_bytes)),
               "cudaFuncSetAttribute");
  }
  int per_multiprocessor = 0;
  check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&per_multiprocessor, kernel,
                                                           block_threads, shared_bytes),
             "cudaOccupancyMaxActiveBlocksPerMultiprocessor");
  return static_cast<std::uint32_t>(std::max(per_multiprocessor, 1) *
                                    properties_.multiProcessorCount);
}

void CudaLauncher::note_kernel(const char* name, const void* kernel, dim3 block,
                               std::size_t shared_bytes) {
  cudaFuncAttributes attributes{};
  check_cuda(cudaFuncGetAttributes(&attributes, kernel), name);
  const int threads = static_cast<int>(block.x * block.y * block.z);
  if (threads > attributes.maxThreadsPerBlock) {
    throw Error(
        fmt::format("kernel {} uses {} registers per thread: a block has at most {} threads, "
                    "{} were asked for (--block, --stage-block)",
                    name, attributes.numRegs, attributes.maxThreadsPerBlock, threads));
  }
  const std::uint32_t resident = resident_blocks(kernel, threads, shared_bytes);
  const int warps = (threads + 31) / 32 * static_cast<int>(resident);
  const int room = properties_.multiProcessorCount * (properties_.maxThreadsPerMultiProcessor / 32);
  noted_kernels_.emplace_back(kernel, name);
  kernels_.push_back({name, attributes.numRegs, attributes.localSizeBytes,
                      attributes.sharedSizeBytes + shared_bytes, threads,
                      static_cast<double>(warps) / room});
}

void CudaLauncher::launch_erased(const char* name, const void* kernel, dim3 grid, dim3 block,
                                 std::size_t shared_bytes, void** arguments) {
  const bool is_noted = std::ranges::any_of(noted_kernels_, [&](const auto& noted) {
    return noted.first == kernel && noted.second == name;
  });
  if (!is_noted) note_kernel(name, kernel, block, shared_bytes);
  if (is_counting()) counters_->note_launch(name, wave_);
  const ProfilerRange range(name);
  check_cuda(cudaLaunchKernel(kernel, grid, block, arguments, shared_bytes, stream_), name);
}

// How many kernels a library launches is its own affair: a capture tells.
int CudaLauncher::count_kernels(const std::function<void()>& enqueue) const {
  check_cuda(cudaStreamBeginCapture(stream_, cudaStreamCaptureModeThreadLocal),
             "cudaStreamBeginCapture");
  enqueue();
  cudaGraph_t graph{};
  check_cuda(cudaStreamEndCapture(stream_, &graph), "cudaStreamEndCapture");
  std::size_t count = 0;
  check_cuda(cudaGraphGetNodes(graph, nullptr, &count), "cudaGraphGetNodes");
  std::vector<cudaGraphNode_t> nodes(count);
  check_cuda(cudaGraphGetNodes(graph, nodes.data(), &count), "cudaGraphGetNodes");
  int kernels = 0;
  for (const cudaGraphNode_t node : nodes) {
    cudaGraphNodeType type{};
    check_cuda(cudaGraphNodeGetType(node, &type), "cudaGraphNodeGetType");
    kernels += type == cudaGraphNodeTypeKernel ? 1 : 0;
  }
  check_cuda(cudaGraphDestroy(graph), "cudaGraphDestroy");
  return kernels;
}

// Only the first time, before a profiler looks at what is launched.
void CudaLauncher::launch_others(const char* name, int kind, const std::function<void()>& enqueue) {
  if (is_counting()) {
    const auto [entry, is_new] = others_.try_emplace({name, kind}, 0);
    if (is_new) entry->second = count_kernels(enqueue);
    for (int i = 0; i < entry->second; ++i) counters_->note_launch(name, wave_);
  }
  enqueue();
}

void CudaLauncher::time_batch(RenderRun& run, const std::function<void()>& enqueue) {
  set_wave(-1);
  check_cuda(cudaEventRecord(start_, stream_), "cudaEventRecord");
  launch("start_clock", start_clock, 1, 1, 0, clock_);
  enqueue();
  launch("stop_clock", stamp_stage, 1, 1, 0, clock_, StageId::idle);
  check_cuda(cudaEventRecord(stop_, stream_), "cudaEventRecord");
  check_cuda(cudaEventSynchronize(stop_), "rendering a batch");
  float elapsed_ms = 0;
  check_cuda(cudaEventElapsedTime(&elapsed_ms, start_, stop_), "cudaEventElapsedTime");
  run.kernel_ms += elapsed_ms;
}

void CudaLauncher::enqueue_stamp(StageId stage) {
  launch("stamp", stamp_stage, 1, 1, 0, clock_, stage);
}

HardwareCounters CudaLauncher::count_launches(const std::function<void()>& work) {
  if (device_.is_part())
    throw CountersUnavailable(
        "--sms: counters are read of whole GPUs; CUPTI counts in green contexts from CUDA 13.3 on");
  counters_ = std::make_unique<CounterSession>(device());
  const std::shared_ptr<void> end(nullptr, [&](void*) { counters_.reset(); });
  return counters_->count(work);
}

void CudaLauncher::reset_clock() {
  check_cuda(cudaMemsetAsync(clock_, 0, sizeof(StageClock), stream_), "cudaMemset");
}

void CudaLauncher::read_clock(RenderRun& run) const {
  StageClock clock;
  check_cuda(cudaMemcpy(&clock, clock_, sizeof clock, cudaMemcpyDeviceToHost), "cudaMemcpy");
  for (const StageInfo& stage : stage_table) {
    const auto i = static_cast<std::size_t>(stage.id);
    if (clock.launches[i] == 0) continue;
    run.stages.push_back(
        {std::string(stage.name), static_cast<double>(clock.time_ns[i]) * 1e-6, clock.launches[i]});
  }
}

}  // namespace pt
