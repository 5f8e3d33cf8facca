#include "wavefront/wavefront_cuda.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "common/accel/trace_optix/optix_memory_cuda.h"
#include "common/accel/trace_optix/optix_tracer.h"
#include "common/error/error.h"
#include "wavefront/optix/optix_queue.h"
#include "wavefront/wavefront.h"

namespace pt {
namespace {

// An iteration of the graph's loop costs more than a kernel: a few waves share one. Those after the
// last ray find empty queues.
constexpr int waves_per_iteration = 2;

constexpr double mib = 1024.0 * 1024.0;

}  // namespace

WavefrontCuda::WavefrontCuda(const ExecutionPlan& plan, const SceneData& scene, int device)
    : CudaRenderer(plan, scene, device),
      has_masks_(scene.properties.has_masks),
      finish_paths_(plan_.finish_paths) {
  make_optix();
  allocate_pool(scene);
  if (plan_.finishes_in_blocks) {
    const std::uint64_t most = std::min<std::uint64_t>(batch_paths(), finish_paths_);
    CudaLauncher& launcher = *this;
    blocks_ = std::make_unique<BlockWavefronts>(launcher, memory_, traits_,
                                                scene_.triangles.instance_count > 0,
                                                plan_.path_bytes, static_cast<std::uint32_t>(most));
    finish_paths_ = std::min(finish_paths_, blocks_->capacity());
  }
  check_cuda(cudaMallocHost(reinterpret_cast<void**>(&host_counters_), sizeof *host_counters_),
             "cudaMallocHost");
}

WavefrontCuda::~WavefrontCuda() {
  destroy_graph();
  cudaFreeHost(host_counters_);
}

void WavefrontCuda::make_optix() {
  optix_.reset();  // its memory is needed
  if (!plan_.traces_by_optix) return;
  optix_memory_ = std::make_unique<CudaOptixMemory>(stream());
  optix_ =
      std::make_unique<OptixTracer>(*optix_memory_, scene_, plan_.optix_hits, optix_queue_module());
}

void WavefrontCuda::trace_by_optix(StageId stage, const StageQueues& queues,
                                   const SampleBuffer& samples) {
  enqueue_stamp(stage);
  pt::trace_by_optix(*optix_,
                     stage == StageId::shadow ? OptixPipeline::any : OptixPipeline::closest,
                     {.world = scene_,
                      .has_masks = has_masks_,
                      .pool = buffers_.pool,
                      .slots = queues.slots,
                      .count = queues.count,
                      .samples = samples});
}

void WavefrontCuda::describe(RenderReport& report) const {
  CudaRenderer::describe(report);
  if (optix_ != nullptr) optix_->describe(report, false);
}

void WavefrontCuda::allocate_pool(const SceneData& scene) {
  const bool has_volumes = std::ranges::any_of(
      scene.media, [](const Medium& medium) { return !medium.is_homogeneous(); });
  const WavePolicy policy(plan_, traits_, scene_, has_volumes);
  const bool appends = policy.compaction.appends;
  buffers_.policy = policy;
  const std::uint64_t bytes_per_slot = PathPool::bytes_per_slot(policy.fields) +
                                       buffers_.queue_bytes_per_slot() + sizeof(std::uint32_t);
  const int halvings = plan_.pool_size == 0 ? plan_.memory_halvings : 0;
  const std::uint64_t free = CudaMemory::free_bytes() >> halvings;
  if (plan_.pool_size == 0) {
    const std::uint64_t most = plan_.pool_paths_max;
    const std::uint64_t wanted = most == 0 ? batch_paths() : std::min(most, batch_paths());
    pool_size_ = std::min(wanted, free / 2 / bytes_per_slot);
  } else {
    pool_size_ = plan_.pool_size;
  }
  buffers_.reuses_slots = !appends || pool_size_ < batch_paths() || paths_repeat();
  if (pool_size_ == 0 || pool_size_ * bytes_per_slot > free) {
    throw Error(
        fmt::format("not enough device memory: a pool of {} paths (--pool-size) needs "
                    "{:.0f} MiB, {:.0f} MiB are free",
                    pool_size_, static_cast<double>(pool_size_ * bytes_per_slot) / mib,
                    static_cast<double>(free) / mib));
  }
  const std::uint64_t n = pool_size_;
  PathPool& pool = buffers_.pool;
  pool.slot_count = buffers_.all_slots = static_cast<std::uint32_t>(n);
  pool.allocate_arrays(policy.fields, [&](auto* array, std::uint64_t count) {
    return memory_.allocate<std::remove_pointer_t<decltype(array)>>("path pool", count);
  });
  buffers_.for_each_queue([&](auto*& queue, std::uint64_t capacity) {
    queue = memory_.allocate<std::remove_pointer_t<std::remove_reference_t<decltype(queue)>>>(
        "queues", capacity);
  });
  if (appends && buffers_.reuses_slots) {
    std::vector<std::uint32_t> all(n);
    std::iota(all.begin(), all.end(), 0u);
    all_slots_ = memory_.upload("queues", all);
  }
  if (policy.compaction.pass != TagPass::none) {
    compactor_ = std::make_unique<CudaCompactor>(policy.compaction.pass, pool.slot_count, memory_);
  }
  buffers_.counters = memory_.allocate<WaveCounters>("counters", 1);
  buffers_.slot_count =
      memory_.upload("counters", std::vector<std::uint32_t>{static_cast<std::uint32_t>(n)});
}

void WavefrontCuda::compact(const CompactionRequest& request) {
  if (compactor_ == nullptr) return;
  launch_others("compact", request.queues_wanted,
                [&] { compactor_->enqueue(request, clock(), stream()); });
}

// Every slot is free when a batch begins.
void WavefrontCuda::start_queues() {
  const PathPool& pool = buffers_.pool;
  const auto fill = [&](StageId* tags) {
    if (tags == nullptr) return;
    check_cuda(cudaMemsetAsync(tags, static_cast<int>(free_slot), pool.slot_count, stream()),
               "cudaMemsetAsync");
  };
  check_cuda(cudaMemsetAsync(buffers_.counters, 0, sizeof(WaveCounters), stream()),
             "cudaMemsetAsync");
  fill(pool.tag);
  fill(pool.shadow_tag);
  if (!buffers_.policy.compaction.appends) return;
  const auto copy = [&](std::uint32_t* to, const std::uint32_t* from, std::size_t count) {
    check_cuda(cudaMemcpyAsync(to, from, count * sizeof *to, cudaMemcpyDeviceToDevice, stream()),
               "cudaMemcpyAsync");
  };
  if (all_slots_ != nullptr) copy(buffers_.queue(free_slot), all_slots_, pool.slot_count);
  copy(buffers_.waiting(free_slot), buffers_.slot_count, 1);
}

template <class Source>
StageContext<Source> WavefrontCuda::context_of(const SampleBuffer& batch,
                                               const Source& source) const {
  return {buffers_.pool,  batch,   source, buffers_.counters, buffers_.queue(StageId::intersect),
          path_settings_, supply()};
}

template <class Function>
void WavefrontCuda::with_context(const SampleBuffer& batch, Function&& function) {
  with_random_source([&](const auto& source) {
    using Source = std::remove_cvref_t<decltype(source)>;
    if constexpr (std::is_same_v<Source, SamplerSource>) {
      using Carrying = CarryingSource<>;
      if (plan_.path_bytes > 0)
        return function(WaveKinds<Carrying>{}, context_of(batch, Carrying{source}));
      if (traits_.has_media && traits_.has_motion)
        return function(WaveKinds<Source, true, true>{}, context_of(batch, source));
      if (traits_.has_media) return function(WaveKinds<Source, true>{}, context_of(batch, source));
      if (traits_.has_motion)
        return function(WaveKinds<Source, false, true>{}, context_of(batch, source));
    }
    function(WaveKinds<Source>{}, context_of(batch, source));
  });
}

void WavefrontCuda::enqueue_wave(const SampleBuffer& batch, cudaGraphConditionalHandle loop,
                                 bool starts_paths) {
  path_count_ = supply().has_chains() ? 0 : batch.path_count;
  loop_ = loop;
  set_wave(static_cast<int>(flows_.size()));
  with_context(batch, [&](auto kinds, const auto& context) {
    enqueue_wave_of<decltype(kinds)>(context, starts_paths);
  });
}

void WavefrontCuda::enqueue_finish(const SampleBuffer& batch) {
  set_wave(static_cast<int>(flows_.size()) - 1);  // the last one, which found no more to do
  if (blocks_ != nullptr) return finish_in_blocks(batch);
  with_context(
      batch, [&](auto kinds, const auto& context) { enqueue_finish_of<decltype(kinds)>(context); });
}

bool WavefrontCuda::has_few_paths(const SampleBuffer& batch) const {
  return blocks_ != nullptr && !supply().has_chains() && batch.path_count <= finish_paths_;
}

void WavefrontCuda::prepare_batch(const SampleBuffer& batch) {
  if (!plan_.uses_graph || is_counting() || has_few_paths(batch)) return;
  if (graph_exec_ != nullptr && batch == graph_batch_ && supply() == graph_supply_) return;
  destroy_graph();
  build_graph(batch);
}

bool WavefrontCuda::set_camera(const Camera& camera) {
  destroy_graph();  // its kernels have the scene
  return CudaRenderer::set_camera(camera);
}

bool WavefrontCuda::set_scene(const SceneData& scene, const SceneChanges& changes) {
  destroy_graph();
  if (!CudaRenderer::set_scene(scene, changes)) return false;
  if (changes.move_surfaces()) make_optix();
  return true;
}

// A graph whose only node is a WHILE loop; its body is a few waves, recorded from the stream.
void WavefrontCuda::build_graph(const SampleBuffer& batch) {
  check_cuda(cudaGraphCreate(&graph_, 0), "cudaGraphCreate");
  cudaGraphConditionalHandle loop{};
  check_cuda(cudaGraphConditionalHandleCreate(&loop, graph_, 1, cudaGraphCondAssignDefault),
             "cudaGraphConditionalHandleCreate");
  cudaGraphNodeParams parameters{};
  parameters.type = cudaGraphNodeTypeConditional;
  parameters.conditional.handle = loop;
  parameters.conditional.type = cudaGraphCondTypeWhile;
  parameters.conditional.size = 1;
  cudaGraphNode_t node{};
#if CUDART_VERSION >= 13000
  check_cuda(cudaGraphAddNode(&node, graph_, nullptr, nullptr, 0, &parameters), "cudaGraphAddNode");
#else
  check_cuda(cudaGraphAddNode(&node, graph_, nullptr, 0, &parameters), "cudaGraphAddNode");
#endif
  const cudaGraph_t body = parameters.conditional.phGraph_out[0];
  check_cuda(cudaStreamBeginCaptureToGraph(stream(), body, nullptr, nullptr, 0,
                                           cudaStreamCaptureModeThreadLocal),
             "cudaStreamBeginCaptureToGraph");
  cudaGraph_t captured{};
  try {
    for (int i = 0; i < waves_per_iteration; ++i) enqueue_wave(batch, loop, buffers_.reuses_slots);
  } catch (...) {
    cudaStreamEndCapture(stream(), &captured);
    graph_ = nullptr;  // if the recording was broken, the driver crashes as it destroys the graph
    throw;
  }
  check_cuda(cudaStreamEndCapture(stream(), &captured), "cudaStreamEndCapture");
  check_cuda(cudaGraphInstantiate(&graph_exec_, graph_, 0), "cudaGraphInstantiate");
  check_cuda(cudaGraphUpload(graph_exec_, stream()), "cudaGraphUpload");
  check_cuda(cudaStreamSynchronize(stream()), "cudaGraphUpload");
  graph_batch_ = batch;
  graph_supply_ = supply();
}

void WavefrontCuda::destroy_graph() {
  if (graph_exec_ != nullptr) cudaGraphExecDestroy(graph_exec_);
  if (graph_ != nullptr) cudaGraphDestroy(graph_);
  graph_exec_ = nullptr;
  graph_ = nullptr;
}

void WavefrontCuda::read_counters() {
  check_cuda(cudaMemcpyAsync(host_counters_, buffers_.counters, sizeof(WaveCounters),
                             cudaMemcpyDeviceToHost, stream()),
             "reading the wave's counters");
  check_cuda(cudaStreamSynchronize(stream()), "running a wave");
}

template <class Wave>
void WavefrontCuda::while_waves(Wave&& wave) {
  if (graph_exec_ != nullptr && !is_counting()) {
    const ProfilerRange range("waves of a graph");
    check_cuda(cudaGraphLaunch(graph_exec_, stream()), "cudaGraphLaunch");
    return read_counters();
  }
  do {
    wave();
    if (!is_counting()) read_counters();
  } while (host_counters_->intersect > 0);
}

void WavefrontCuda::trace_batch(const SampleBuffer& batch) {
  flows_.clear();
  if (has_few_paths(batch)) {
    set_wave(-1);
    return blocks_->trace(scene_, batch, sampler_source_of(plan_), path_settings_, StageId::finish);
  }
  start_queues();
  int number = 0;
  const auto wave = [&](bool starts_paths) {
    const ProfilerRange range(fmt::format("wave {}", number++));
    enqueue_wave(batch, 0, starts_paths);
    if (is_counting()) note_flow();
  };
  run_all_waves(*this, buffers_, supply().has_chains(), wave, [&] {
    if (finish_paths_ > 0) enqueue_finish(batch);
  });
  waves_ += host_counters_->waves;
}

void WavefrontCuda::note_flow() {
  read_counters();
  if (!flows_.empty()) flows_.back().continued = host_counters_->live;
  flows_.push_back(flow_of(*host_counters_));
}

void WavefrontCuda::predict_bytes(std::vector<LaunchCounters>& launches) const {
  if (traits_.has_media) return;  // cells, voxels and pauses of flights are not foreseen
  WaveLayout layout;
  layout.fields = buffers_.policy.fields;
  layout.fields.lights = traits_.has_lights();
  layout.fused = plan_.fused;
  layout.slots = buffers_.pool.slot_count;
  layout.has_queues = buffers_.policy.compaction.has_queues;
  layout.appends = buffers_.policy.compaction.appends;
  layout.queues_free = buffers_.queue(free_slot) != nullptr;
  layout.all_lights = traits_.lighting == Lighting::full;
  layout.persistent = traces_queues_here();
  for (LaunchCounters& launch : launches) {
    if (launch.wave < 0) continue;
    const WaveFlow& flow = flows_.at(static_cast<std::size_t>(launch.wave));
    launch.predicted = pt::predict_bytes(launch.kernel, flow, layout);
  }
}

std::uint64_t WavefrontCuda::take_wave_count() { return std::exchange(waves_, 0); }

std::unique_ptr<Renderer> make_wavefront_cuda(const ExecutionPlan& plan, const SceneData& scene,
                                              int device) {
  return std::make_unique<WavefrontCuda>(plan, scene, device);
}

}  // namespace pt
