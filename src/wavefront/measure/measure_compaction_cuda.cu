#include <algorithm>

#include "common/cuda/cuda_check.cuh"
#include "common/cuda/cuda_memory.cuh"
#include "common/cuda/used_gpu.cuh"
#include "wavefront/compaction/compaction_cuda.h"
#include "wavefront/measure/measure_compaction.h"
#include "wavefront/stage_kernel.cuh"

namespace pt {
namespace {

constexpr int block_threads = 256;  // as --stage-block has it
constexpr std::uint64_t items_per_time = std::uint64_t{1} << 28;
constexpr std::uint64_t cold_bytes = std::uint64_t{1} << 28;  // more than the L2 caches of today

/// What a stage does with slots that it has finished.
template <int streams>
__global__ void __launch_bounds__(block_threads)
    append_waiting(const __grid_constant__ CompactionRequest request) {
  using Appender = BlockAppender<streams>;
  __shared__ typename Appender::Shared shared;
  Appender appender(shared);
  std::uint32_t *queues[streams], *ends[streams];
  for (int s = 0; s < streams; ++s) queues[s] = request.queues[s], ends[s] = request.counts + s;
  for (std::uint32_t base = blockIdx.x * blockDim.x; base < request.slot_count;
       base += gridDim.x * blockDim.x) {
    const std::uint32_t slot = base + threadIdx.x;
    const StageId tag = slot < request.slot_count ? request.tags[slot] : StageId::idle;
    bool wanted[streams];
    for (int s = 0; s < streams; ++s) wanted[s] = tag == request.wanted[s];
    appender.append(wanted, slot, queues, ends);
  }
}

__global__ void __launch_bounds__(block_threads)
    copy_wide(const uint4* from, uint4* to, std::uint64_t count) {
  const std::uint64_t i = std::uint64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i < count) to[i] = from[i];
}

class Stream {
 public:
  Stream() { check_cuda(cudaStreamCreate(&stream_), "cudaStreamCreate"); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() { cudaStreamDestroy(stream_); }
  cudaStream_t get() const { return stream_; }

 private:
  cudaStream_t stream_ = nullptr;
};

/// What enqueue() puts on a stream, to be launched as often as wanted.
class Graph {
 public:
  template <class Enqueue>
  Graph(cudaStream_t stream, Enqueue&& enqueue) {
    check_cuda(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal),
               "cudaStreamBeginCapture");
    enqueue();
    check_cuda(cudaStreamEndCapture(stream, &graph_), "cudaStreamEndCapture");
    check_cuda(cudaGraphInstantiate(&exec_, graph_, 0), "cudaGraphInstantiate");
    check_cuda(cudaGraphUpload(exec_, stream), "cudaGraphUpload");
  }
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;
  ~Graph() {
    if (exec_ != nullptr) cudaGraphExecDestroy(exec_);
    if (graph_ != nullptr) cudaGraphDestroy(graph_);
  }
  void launch(cudaStream_t stream) const {
    check_cuda(cudaGraphLaunch(exec_, stream), "cudaGraphLaunch");
  }

 private:
  cudaGraph_t graph_ = nullptr;
  cudaGraphExec_t exec_ = nullptr;
};

/// Tags and queues, `sets` times; counts for each pass.
class Slots {
 public:
  Slots(Compaction strategy, const std::vector<StageId>& tags, int queues, const PassPlan& plan)
      : slot_count_(static_cast<std::uint32_t>(tags.size())), queue_count_(queues), plan_(plan) {
    const TagPass pass = compaction_info(strategy).pass;
    if (pass != TagPass::none) {
      compactor_ = std::make_unique<CudaCompactor>(pass, slot_count_, memory_);
    }
    tags_ = memory_.allocate<StageId>("tags", stride() * plan.sets);
    queues_ = memory_.allocate<std::uint32_t>("queues", stride() * plan.sets * queues_per_set());
    counts_ = memory_.allocate<std::uint32_t>("counts", counts_per_pass * plan.passes);
    for (std::uint32_t set = 0; set < plan.sets; ++set) {
      check_cuda(cudaMemcpy(tags_ + stride() * set, set == 0 ? tags.data() : tags_, tags.size(),
                            set == 0 ? cudaMemcpyHostToDevice : cudaMemcpyDeviceToDevice),
                 "cudaMemcpy");
    }
    check_cuda(
        cudaMemset(queues_, 0xff, stride() * plan.sets * queues_per_set() * sizeof(std::uint32_t)),
        "cudaMemset");
    int blocks = 0;
    check_cuda(
        cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, append_waiting<2>, block_threads, 0),
        "cudaOccupancyMaxActiveBlocksPerMultiprocessor");
    const std::uint32_t wanted = (slot_count_ + block_threads - 1) / block_threads;
    grid_ = std::min(wanted, static_cast<std::uint32_t>(blocks * used_multiprocessors()));
  }

  CompactionRequest request(std::uint32_t pass) const {
    CompactionRequest result;
    const std::uint64_t set = pass % plan_.sets;
    result.tags = tags_ + stride() * set;
    result.slot_count = result.capacity = slot_count_;
    result.queues_wanted = queue_count_;
    for (int q = 0; q < queue_count_; ++q) {
      result.wanted[q] = measured_stages[q];
      result.queues[q] =
          queues_ + stride() * (set * queues_per_set() + static_cast<std::uint64_t>(q));
    }
    result.counts = counts_ + counts_per_pass * pass;
    return result;
  }

  void clear_counts(cudaStream_t stream) const {
    check_cuda(
        cudaMemsetAsync(counts_, 0, counts_per_pass * plan_.passes * sizeof *counts_, stream),
        "cudaMemsetAsync");
  }

  void enqueue(std::uint32_t pass, cudaStream_t stream) const {
    if (compactor_ != nullptr) return compactor_->enqueue(request(pass), nullptr, stream);
    const auto kernel = queue_count_ > 1 ? append_waiting<2> : append_waiting<1>;
    kernel<<<grid_, block_threads, 0, stream>>>(request(pass));
    check_cuda(cudaGetLastError(), "append_waiting");
  }

 private:
  static constexpr std::uint64_t counts_per_pass = 2;  // as CompactionRequest wants

  /// Slots from one set to the next, which begins at a boundary of 256 bytes.
  std::uint64_t stride() const { return (std::uint64_t{slot_count_} + 255) / 256 * 256; }
  std::uint64_t queues_per_set() const { return static_cast<std::uint64_t>(queue_count_); }

  std::uint32_t slot_count_;
  int queue_count_;
  PassPlan plan_;
  CudaMemory memory_;
  std::unique_ptr<CudaCompactor> compactor_;
  StageId* tags_ = nullptr;
  std::uint32_t *queues_ = nullptr, *counts_ = nullptr;
  std::uint32_t grid_ = 0;
};

class CompactionCuda : public CompactionDevice {
 public:
  CompactionCuda(int index, int sms) : device_(index, sms) {}

  std::vector<CopyWay> copy_ways() const override { return {CopyWay::memcpy, CopyWay::kernel}; }
  /// The graph of a time goes through all sets.
  PassPlan plan(std::uint64_t items, std::uint64_t bytes, bool cold) const override {
    const std::uint32_t sets = count_sets(cold ? cold_bytes : 0, bytes);
    return {std::max(count_passes(items_per_time, items), sets), sets};
  }
  int threads() const override { return 0; }

  CompactionResult compact(Compaction strategy, const std::vector<StageId>& tags,
                           int queues) override {
    const Slots slots(strategy, tags, queues, {});
    slots.clear_counts(stream_->get());
    slots.enqueue(0, stream_->get());
    check_cuda(cudaStreamSynchronize(stream_->get()), "a compaction");
    const CompactionRequest request = slots.request(0);
    CompactionResult result;
    result.counts = download(request.counts, static_cast<std::size_t>(queues));
    for (int q = 0; q < queues; ++q)
      result.queues.push_back(download(request.queues[q], tags.size()));
    return result;
  }

  std::vector<double> time_compaction(Compaction strategy, const std::vector<StageId>& tags,
                                      int queues, const PassPlan& plan,
                                      const MeasuredRuns& runs) override {
    const Slots slots(strategy, tags, queues, plan);
    return time_passes(
        plan, runs, [&] { slots.clear_counts(stream_->get()); },
        [&](std::uint32_t pass) { slots.enqueue(pass, stream_->get()); });
  }

  std::vector<double> time_copy(CopyWay way, std::uint64_t bytes, const PassPlan& plan,
                                const MeasuredRuns& runs) override {
    const std::uint64_t count = (bytes / 2 + sizeof(uint4) - 1) / sizeof(uint4);
    CudaMemory memory;
    uint4* const from = memory.allocate<uint4>("copy", count * plan.sets);
    uint4* const to = memory.allocate<uint4>("copy", count * plan.sets);
    check_cuda(cudaMemset(from, 1, count * plan.sets * sizeof(uint4)), "cudaMemset");
    const auto blocks = static_cast<std::uint32_t>((count + block_threads - 1) / block_threads);
    return time_passes(
        plan, runs, [] {},
        [&](std::uint32_t pass) {
          const std::uint64_t first = count * (pass % plan.sets);
          if (way == CopyWay::kernel) {
            copy_wide<<<blocks, block_threads, 0, stream_->get()>>>(from + first, to + first,
                                                                    count);
            check_cuda(cudaGetLastError(), "copy_wide");
          } else {
            check_cuda(cudaMemcpyAsync(to + first, from + first, count * sizeof(uint4),
                                       cudaMemcpyDeviceToDevice, stream_->get()),
                       "cudaMemcpyAsync");
          }
        });
  }

 private:
  static std::vector<std::uint32_t> download(const std::uint32_t* from, std::size_t count) {
    std::vector<std::uint32_t> values(count);
    check_cuda(cudaMemcpy(values.data(), from, count * sizeof *from, cudaMemcpyDeviceToHost),
               "cudaMemcpy");
    return values;
  }

  /// Calls before() outside of the time, then takes that of all enqueue(pass).
  template <class Before, class Enqueue>
  std::vector<double> time_passes(const PassPlan& plan, const MeasuredRuns& runs, Before&& before,
                                  Enqueue&& enqueue) const {
    const Graph graph(stream_->get(), [&] {
      for (std::uint32_t pass = 0; pass < plan.passes; ++pass) enqueue(pass);
    });
    const CudaEvent begin, end;
    std::vector<double> times_ms;
    for (int run = -runs.warmup; run < runs.repeat; ++run) {
      before();
      begin.record(stream_->get());
      graph.launch(stream_->get());
      end.record(stream_->get());
      const double ms = end.ms_since(begin);
      if (run >= 0) times_ms.push_back(ms / plan.passes);
    }
    return times_ms;
  }

  const UsedGpu device_;
  const std::unique_ptr<Stream> stream_ = std::make_unique<Stream>();
};

}  // namespace

std::unique_ptr<CompactionDevice> make_compaction_cuda(int index, int sms) {
  return std::make_unique<CompactionCuda>(index, sms);
}

}  // namespace pt
