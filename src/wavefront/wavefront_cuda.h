// The wavefront's renderer on CUDA: the pool, the two ways to run the loop of waves.
#pragma once

#include "common/block_wavefront/block_wavefront_cuda.h"
#include "common/device/cuda/cuda_renderer.cuh"
#include "wavefront/compaction/compaction_cuda.h"
#include "wavefront/loop.h"
#include "wavefront/pool/stage_bytes.h"

namespace pt {

class CudaOptixMemory;
class OptixTracer;

/// The scenes of a wavefront with this source of random numbers, as Traits; those with media and
/// those with motion apart, whose kernels compile beside the others.
template <class Source, bool has_media, bool has_motion>
struct WaveKernels {
  static constexpr bool has(const SceneTraits& scene) {
    using enum KernelBody;
    return scene.has_media == has_media && scene.has_motion == has_motion &&
           KernelSelection<true, Source, SceneMemory::global, stages, warps, fused>::has(scene);
  }
};
template <class Source, bool has_media = false, bool has_motion = false>
using WaveKinds = TraitsOf<WaveKernels<Source, has_media, has_motion>>;

class WavefrontCuda : public CudaRenderer {
 public:
  WavefrontCuda(const ExecutionPlan& plan, const SceneData& scene, int device);
  ~WavefrontCuda() override;
  bool set_camera(const Camera& camera) override;
  bool set_scene(const SceneData& scene, const SceneChanges& changes) override;

  /// Enqueues one wave on stream(). `loop`: the handle of the graph's loop, 0 outside of one.
  /// `starts_paths`: see run_wave.
  void enqueue_wave(const SampleBuffer& batch, cudaGraphConditionalHandle loop, bool starts_paths);
  /// Enqueues what follows the last wave.
  void enqueue_finish(const SampleBuffer& batch);

  // The Executor of run_wave (wave_steps.h):
  void compact(const CompactionRequest& request);
  void order_surfaces(const SurfaceOrder& order);
  void begin_wave();
  static constexpr bool streams_shading = true;
  template <class Stage>
  void run(const Stage& stage, const StageQueues& queues);
  template <class Traits>
  static constexpr bool traces_queues = has_kernel({true, KernelBody::warps, Traits::value(),
                                                    NumberSource::sampler});
  bool traces_queues_here() const { return plan_.persistent_warps; }
  void trace_queue(const StageQueues& queues, const SampleBuffer& samples);
  void trace_shadow_queue(const StageQueues& queues, const SampleBuffer& samples);
  static constexpr bool flies_queues = true;
  void fly_queue(const StageQueues& queues, const SampleBuffer& samples);
  /// Repeats a wave, on the host or in the graph that has been built of waves (run_all_waves).
  template <class Wave>
  void while_waves(Wave&& wave);

 protected:
  void prepare_batch(const SampleBuffer& batch) override;
  void trace_batch(const SampleBuffer& batch) override;
  std::uint64_t take_wave_count() override;
  void predict_bytes(std::vector<LaunchCounters>& launches) const override;
  void describe(RenderReport& report) const override;

 private:
  /// Calls function(kinds, context): a list of kinds of scenes that has this one, and what stages
  /// need, by the type of the random source.
  template <class Function>
  void with_context(const SampleBuffer& batch, Function&& function);
  template <class Source>
  StageContext<Source> context_of(const SampleBuffer& batch, const Source& source) const;
  template <class Rays>
  void trace_persistently(const Rays& rays, const SampleBuffer& samples, StageId stage);
  template <class Lane, class Rays>
  void run_persistent(const Rays& rays, StageId stage);
  template <class Kinds, class Source>
  void enqueue_wave_of(const StageContext<Source>& context, bool starts_paths);
  template <class Kinds, class Source>
  void enqueue_finish_of(const StageContext<Source>& context);
  /// Builds what OptiX needs, where it traces.
  void make_optix();
  /// The rays of a queue; the stage says of which kind.
  void trace_by_optix(StageId stage, const StageQueues& queues, const SampleBuffer& samples);
  void allocate_pool(const SceneData& scene);
  /// Whether blocks follow the whole batch from its first rays, as few paths as it has.
  bool has_few_paths(const SampleBuffer& batch) const;
  void finish_in_blocks(const SampleBuffer& batch);
  void build_graph(const SampleBuffer& batch);
  void destroy_graph();
  void read_counters();
  void start_queues();
  void note_flow();

  WaveBuffers buffers_;
  std::uint32_t* all_slots_ = nullptr;  ///< 0, 1, 2, ...: the first queue of free slots
  std::unique_ptr<CudaCompactor> compactor_;
  std::unique_ptr<CudaOptixMemory> optix_memory_;
  std::unique_ptr<OptixTracer> optix_;       ///< null: our own warps trace
  std::unique_ptr<BlockWavefronts> blocks_;  ///< null: threads follow the last paths
  bool has_masks_ = false;                   ///< where media have kernels with masks in any case
  std::uint32_t finish_paths_ = 0;           ///< of the plan, as far as blocks have room for them
  WaveCounters* host_counters_ = nullptr;    ///< pinned
  std::uint64_t waves_ = 0;
  std::vector<WaveFlow> flows_;  ///< of the batch's waves so far, where they are counted
  // What the wave being enqueued belongs to:
  std::uint32_t path_count_ = 0;
  cudaGraphConditionalHandle loop_ = 0;
  // The graph of the last batch: renders of the same batch share it.
  cudaGraph_t graph_ = nullptr;
  cudaGraphExec_t graph_exec_ = nullptr;
  SampleBuffer graph_batch_;
  PathSupply graph_supply_;
};

}  // namespace pt
