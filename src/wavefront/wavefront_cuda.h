// The wavefront's renderer on CUDA: the pool, the two ways to run the loop of waves.
#pragma once

#include "common/block_wavefront/block_wavefront_cuda.h"
#include "common/device/cuda/cuda_renderer.cuh"
#include "wavefront/compaction/compaction_cuda.h"
#include "wavefront/pool/stage_bytes.h"
#include "wavefront/wavefront.h"

namespace pt {

class WavefrontCuda : public CudaRenderer {
 public:
  WavefrontCuda(const Options& options, const SceneData& scene, int device);
  ~WavefrontCuda() override;
  bool set_camera(const Camera& camera) override;

  /// Enqueues one wave on stream(). `loop`: the handle of the graph's loop, 0 outside of one.
  /// `starts_paths`: see run_wave.
  void enqueue_wave(const SampleBuffer& batch, cudaGraphConditionalHandle loop, bool starts_paths);
  /// Enqueues what follows the last wave.
  void enqueue_finish(const SampleBuffer& batch);

  // The Executor of run_wave (wavefront.h):
  void compact(const CompactionRequest& request);
  void order_surfaces(const SurfaceOrder& order);
  void begin_wave();
  static constexpr bool streams_shading = true;
  template <class Stage>
  void run(const Stage& stage, const StageQueues& queues);
  /// Wide trees, where a thread per ray would wait for the slowest of its warp. Scenes with spheres
  /// or masks are of the same kinds as some without.
  template <class Traits>
  static constexpr bool traces_queues = Traits::accel == Accel::cwbvh;
  bool traces_queues_here() const { return execution_.persistent_warps; }
  void trace_queue(const StageQueues& queues, const SampleBuffer& samples);
  void trace_shadow_queue(const StageQueues& queues, const SampleBuffer& samples);
  static constexpr bool flies_queues = true;
  void fly_queue(const StageQueues& queues, const SampleBuffer& samples);

 protected:
  void prepare_batch(const SampleBuffer& batch) override;
  void trace_batch(const SampleBuffer& batch) override;
  std::uint64_t take_wave_count() override;
  void predict_bytes(std::vector<LaunchCounters>& launches) const override;

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
  void allocate_pool(const SceneData& scene);
  /// Whether blocks follow the whole batch from its first rays, as few paths as it has.
  bool has_few_paths(const SampleBuffer& batch) const;
  void finish_in_blocks(const SampleBuffer& batch);
  void build_graph(const SampleBuffer& batch);
  void destroy_graph();
  void read_counters();
  void start_queues();
  void note_flow();

  PathPool::Parts parts_{};
  WaveBuffers buffers_;
  std::uint32_t* all_slots_ = nullptr;  ///< 0, 1, 2, ...: the first queue of free slots
  std::unique_ptr<CudaCompactor> compactor_;
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
