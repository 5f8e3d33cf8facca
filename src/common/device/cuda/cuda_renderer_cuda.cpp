#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "common/accel/build/check_builder.h"
#include "common/accel/build_cuda/device_triangle_tree.cuh"
#include "common/device/cuda/chain_kernels.cuh"
#include "common/device/cuda/cuda_renderer.cuh"
#include "common/device/cuda/feature_kernels.cuh"
#include "common/device/cuda/film_kernels.cuh"
#include "common/device/cuda/profiler_range.cuh"
#include "common/device/cuda/read_properties.cuh"
#include "common/error/error.h"
#include "common/film/develop.h"
#include "common/options/option_names.h"
#include "common/render/lane_histograms.h"
#include "common/scene/data/scene_arrays.h"
#include "common/scene/data/scene_facts.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/scene/prepare/prepare_triangles.h"
#include "common/transport/mask.h"

namespace pt {
namespace {

// One batch takes a tenth of a second at most, and 2 GiB for its samples.
constexpr std::uint64_t batch_paths_max = std::uint64_t{1} << 27;
constexpr std::uint64_t first_paths = std::uint64_t{1} << 24;  // of a scene of unknown speed

/// Two chains for each thread that the device holds at once, about 2^19 on an H200. More take more
/// mutations a second, but each walks a shorter way from its start: half as many and twice as many
/// have a larger error at equal time (results/).
ChainDefaults chain_defaults(const cudaDeviceProp& device) {
  return {2 * static_cast<std::uint64_t>(device.multiProcessorCount) *
              static_cast<std::uint64_t>(device.maxThreadsPerMultiProcessor),
          std::uint64_t{1} << 20, std::uint64_t{1} << 30, std::uint64_t{1} << 23};
}

/// Of this device. Throws Error where it is not there.
cudaDeviceProp read_properties(int device) {
  cudaDeviceProp properties{};
  check_cuda(cudaGetDeviceProperties(&properties, device), "cudaGetDeviceProperties");
  return properties;
}

class Stopwatch {
 public:
  double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_)
        .count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

CudaRenderer::CudaRenderer(const Options& options, const SceneData& scene, int device)
    : FilmRenderer(options, scene, plan_properties(read_properties(device))),
      properties_(read_properties(device)),
      traits_(scene.traits),
      device_(device),
      primitive_count_(scene.primitive_count()),
      half_spheres_(scene.half_spheres) {
  const Stopwatch watch;
  check_cuda(cudaSetDevice(device), "cudaSetDevice");
  int driver = 0, runtime = 0;
  check_cuda(cudaDriverGetVersion(&driver), "cudaDriverGetVersion");
  check_cuda(cudaRuntimeGetVersion(&runtime), "cudaRuntimeGetVersion");
  driver_ = fmt::format("CUDA driver {}.{}, runtime {}.{}", driver / 1000, driver % 1000 / 10,
                        runtime / 1000, runtime % 1000 / 10);
  check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "cudaStreamCreate");
  check_cuda(cudaEventCreate(&start_), "cudaEventCreate");
  check_cuda(cudaEventCreate(&stop_), "cudaEventCreate");
  const Stopwatch transfer;
  upload(scene);
  transfer_ms_ = transfer.ms();
  allocate_film();
  setup_ms_ = watch.ms() - transfer_ms_;
}

CudaRenderer::~CudaRenderer() {
  cudaEventDestroy(start_);
  cudaEventDestroy(stop_);
  cudaStreamDestroy(stream_);
}

void CudaRenderer::upload(const SceneData& scene) {
  scene_ = host_view(scene, options_.width, options_.height);
  scene_.mask_seed = mask_seed(options_.seed);
  if constexpr (counts_lanes) {
    lane_counts_ = memory_.allocate<LaneCounts>("lane counts", 1);
    set_lanes(scene_, LaneCounter(lane_counts_));
  }
  const auto upload_array = [&](auto*& pointer, const auto& values, const char* kind) {
    pointer = memory_.upload(kind, values);
  };
  for_each_array(scene, scene_, upload_array);
  if (traits_.geometry != Geometry::spheres_and_quads && is_device_builder(options_.builder)) {
    const DeviceTriangleTree built = build_device_triangle_tree(
        scene.meshes, scene.instances, tree_options(traits_.accel, options_.builder), memory_);
    scene_.triangles = built.view;
    tree_facts_ = tree_facts(built.summary, scene.triangle_count());
  } else {
    scene_.triangles = scene.tree.view(upload_array);
  }
}

void CudaRenderer::allocate_planes(std::uint64_t pixels) {
  const std::uint64_t count = plan_.signs() * pixels;
  film_.aovs = plan_.aovs;
  film_.planes = plan_.feature_planes();
  film_.two_signs = plan_.two_signs;
  film_.pixels = memory_.allocate<FilmPixel>("film", count);
  if (plan_.moments) film_.moments = memory_.allocate<PixelMoments>("film", count);
  if (film_.planes > 0) film_.features = memory_.allocate<double>("film", count * film_.planes);
}

void CudaRenderer::allocate_film() {
  const std::uint64_t pixels = image_window().pixel_count();
  const std::uint64_t state_bytes = options_.rng == RngKind::xorwow ? random_state_bytes() : 0;
  make_samples({"device memory", CudaMemory::free_bytes(), plan_.bytes_per_pixel(),
                sizeof(Sample) + state_bytes, batch_paths_max, first_paths},
               chain_defaults(properties_), [&](std::uint64_t paths) {
                 allocate_planes(pixels);
                 Sample* samples = memory_.allocate<Sample>("samples", paths);
                 if (state_bytes > 0) {
                   states_ = reinterpret_cast<CurandState*>(
                       memory_.allocate<char>("random states", paths * state_bytes));
                 }
                 return samples;
               });
  if (has_chains()) allocate_chains();
  tally_ = memory_.allocate<PathTally>("counters", 1);
  clock_ = memory_.allocate<StageClock>("counters", 1);
  check_cuda(cudaMemset(tally_, 0, sizeof(PathTally)), "cudaMemset");
}

std::uint32_t CudaRenderer::resident_blocks(const void* kernel, int block_threads,
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

void CudaRenderer::note_kernel(const char* name, const void* kernel, dim3 block,
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

void CudaRenderer::launch_erased(const char* name, const void* kernel, dim3 grid, dim3 block,
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
int CudaRenderer::count_kernels(const std::function<void()>& enqueue) const {
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
void CudaRenderer::launch_others(const char* name, int kind, const std::function<void()>& enqueue) {
  if (is_counting()) {
    const auto [entry, is_new] = others_.try_emplace({name, kind}, 0);
    if (is_new) entry->second = count_kernels(enqueue);
    for (int i = 0; i < entry->second; ++i) counters_->note_launch(name, wave_);
  }
  enqueue();
}

HardwareCounters CudaRenderer::count_hardware() {
  check_cuda(cudaSetDevice(device_), "cudaSetDevice");
  const std::uint64_t pixels = image_window().pixel_count();
  const int count = batch_samples(options_.spp, pixels, batch_paths());
  const SampleBuffer batch{samples(), image_window(), 0, static_cast<std::uint32_t>(count)};
  Film film;
  film.window = image_window();
  counters_ = std::make_unique<CounterSession>(device_);
  const std::shared_ptr<void> end(nullptr, [&](void*) { counters_.reset(); });
  HardwareCounters result = counters_->count([&] {
    begin_render(film);
    RenderRun run;
    render_batch(batch, run, {});
    take_wave_count();
  });
  predict_bytes(result.launches);
  const PathCounts counts = summarize(read_tally());
  result.samples = count;
  result.rays = counts.rays + counts.shadow_rays;
  result.warps_per_sm = properties_.maxThreadsPerMultiProcessor / 32;
  return result;
}

/// Calls `enqueue` between two readings of the clocks.
template <class Enqueue>
void CudaRenderer::time_batch(RenderRun& run, Enqueue&& enqueue) {
  set_wave(-1);
  check_cuda(cudaEventRecord(start_, stream_), "cudaEventRecord");
  launch("start_clock", start_clock, 1, 1, 0, clock_);
  enqueue();
  launch("stop_clock", stop_clock, 1, 1, 0, clock_);
  check_cuda(cudaEventRecord(stop_, stream_), "cudaEventRecord");
  check_cuda(cudaEventSynchronize(stop_), "rendering a batch");
  float elapsed_ms = 0;
  check_cuda(cudaEventElapsedTime(&elapsed_ms, start_, stop_), "cudaEventElapsedTime");
  run.kernel_ms += elapsed_ms;
}

bool CudaRenderer::render_batch(const SampleBuffer& batch, RenderRun& run,
                                const std::function<bool()>&) {
  constexpr int block = 256;
  const ProfilerRange range(fmt::format("batch of {} paths", batch.path_count));
  prepare_batch(batch);
  time_batch(run, [&] {
    if (options_.rng == RngKind::xorwow) {
      launch("render_init", render_init, (batch.path_count + block - 1) / block, block, 0, states_,
             batch, options_.seed, clock_);
    }
    trace_batch(batch);
    set_wave(-1);
    accumulate(batch);
  });
  return true;
}

void CudaRenderer::allocate_chains() {
  make_chain_arrays(chain_arrays_, [&]<class T>(T*& pointer, std::uint64_t count) {
    pointer = memory_.allocate<T>("chains", count);
    check_cuda(cudaMemset(pointer, 0, count * sizeof(T)), "cudaMemset");
  });
  chain_run_ = memory_.allocate<ChainRun>("chains", 1);
}

void CudaRenderer::begin_chains(const ChainWindow& window) {
  const Chains chains = chains_view(chain_arrays_, window);
  check_cuda(cudaMemcpyAsync(chain_arrays_.chains, &chains, sizeof chains, cudaMemcpyHostToDevice,
                             stream_),
             "cudaMemcpyAsync");
  chain_steps_ = 0;
  clear_chain_sums();
}

void CudaRenderer::clear_chain_sums() {
  const std::uint64_t bytes = 3 * window().pixel_count() * sizeof(SplatSum);
  check_cuda(cudaMemsetAsync(chain_arrays_.sums, 0, bytes, stream_), "cudaMemset");
  check_cuda(
      cudaMemsetAsync(chain_arrays_.counts, 0, ChainCounts::copies * sizeof(ChainCounts), stream_),
      "cudaMemset");
}

/// Launches a kernel of a thread for each of `count`.
template <class... Parameters, class... Arguments>
void CudaRenderer::launch_each(const char* name, void (*kernel)(Parameters...), std::uint32_t count,
                               const Arguments&... arguments) {
  constexpr std::uint32_t block = 256;
  launch(name, kernel, (count + block - 1) / block, block, 0, arguments...);
}

bool CudaRenderer::trace_bootstrap(std::uint32_t first, std::uint32_t count, RenderRun& run,
                                   const std::function<bool()>&) {
  const SampleBuffer batch = chain_batch(count);
  const ProfilerRange range(fmt::format("{} bootstrap paths", count));
  prepare_batch(batch);
  time_batch(run, [&] {
    launch_each("propose_bootstrap", propose_bootstrap, count, chain_arrays_.proposals, first,
                count, clock_);
    trace_batch(batch);
    set_wave(-1);
    launch_each("keep_targets", keep_targets, count, chain_arrays_.bootstrap.targets + first, batch,
                tally_, clock_);
  });
  return true;
}

void CudaRenderer::splat_bootstrap(std::uint32_t count, const ChainStep& step, RenderRun& run) {
  time_batch(run, [&] {
    launch_each("splat_bootstrap", splat_bootstrap_paths, count, chain_arrays_, chain_batch(count),
                step, clock_);
  });
}

std::vector<TargetSum> CudaRenderer::sum_targets(std::uint32_t paths, RenderRun& run) {
  const auto groups = static_cast<std::uint32_t>(Bootstrap::group_count(paths));
  time_batch(run, [&] {
    launch_each("sum_targets", sum_groups, groups, chain_arrays_.bootstrap, paths, clock_);
  });
  std::vector<TargetSum> result(groups);
  check_cuda(cudaMemcpy(result.data(), chain_arrays_.bootstrap.groups, groups * sizeof(TargetSum),
                        cudaMemcpyDeviceToHost),
             "downloading sums of targets");
  return result;
}

void CudaRenderer::start_chains(const ChainStarts& starts, const ChainStep& step, RenderRun& run) {
  check_cuda(cudaMemcpyAsync(chain_arrays_.bootstrap.below, starts.below.data(),
                             starts.below.size() * sizeof(double), cudaMemcpyHostToDevice, stream_),
             "uploading sums of targets");
  time_batch(run, [&] {
    launch_each("propose_starts", propose_starts, starts.positions.chains, chain_arrays_,
                starts.positions, clock_);
  });
  run_chains(starts.positions.chains, step, run);
}

/// Traces a path of each chain, and the chain takes this step.
void CudaRenderer::run_chains(std::uint32_t chains, const ChainStep& step, RenderRun& run) {
  const SampleBuffer batch = chain_batch(chains);
  const ProfilerRange range(fmt::format("batch of {} chains", chains));
  prepare_batch(batch);
  time_batch(run, [&] {
    trace_batch(batch);
    set_wave(-1);
    launch_each("step_chains", step_chains, chains, chain_arrays_, batch, step, clock_);
  });
}

void CudaRenderer::mutate_chains(std::uint32_t chains, const ChainStep& step, std::uint32_t last,
                                 RenderRun& run) {
  if (!runs_chains_async()) {
    for (; chain_steps_ < last; ++chain_steps_) run_chains(chains, step, run);
    return;
  }
  const SampleBuffer batch = chain_batch(chains);
  const ProfilerRange range(fmt::format("{} chains up to step {}", chains, last));
  const ChainRun chain_run{chain_arrays_, step, last};
  check_cuda(
      cudaMemcpyAsync(chain_run_, &chain_run, sizeof chain_run, cudaMemcpyHostToDevice, stream_),
      "cudaMemcpyAsync");
  check_cuda(cudaMemsetAsync(samples(), 0, chains * sizeof(Sample), stream_), "cudaMemsetAsync");
  chains_are_async_ = true;
  prepare_batch(batch);
  time_batch(run, [&] { trace_batch(batch); });
  chains_are_async_ = false;
}

void CudaRenderer::finish_chains(std::uint32_t chains, const ChainStep& step, RenderRun& run) {
  time_batch(run, [&] {
    launch_each("finish_chains", finish_all_chains, chains, chain_arrays_, chains, step, clock_);
  });
}

ChainSums CudaRenderer::take_chain_sums() {
  ChainSums result;
  result.sums.resize(3 * window().pixel_count());
  check_cuda(cudaMemcpy(result.sums.data(), chain_arrays_.sums,
                        result.sums.size() * sizeof(SplatSum), cudaMemcpyDeviceToHost),
             "downloading the film");
  std::vector<ChainCounts> counts(ChainCounts::copies);
  check_cuda(cudaMemcpy(counts.data(), chain_arrays_.counts, counts.size() * sizeof counts[0],
                        cudaMemcpyDeviceToHost),
             "downloading counts");
  result.add(counts.data());
  clear_chain_sums();
  return result;
}

void CudaRenderer::accumulate(const SampleBuffer& batch) {
  const int block = options_.stage_block[static_cast<int>(StageId::accumulate)];
  const int grid = (batch.pixel_count.divisor() + block - 1) / block;
  const SamplerSource source = sampler_source_of(options_);
  if (film_.features != nullptr) {
    constexpr int feature_block = 128;
    Scene scene = scene_;
    set_lanes(scene, {});  // these camera rays belong to no path
    launch("features", feature_kernel(traits_),
           (batch.pixel_count.divisor() + feature_block - 1) / feature_block, feature_block, 0,
           scene, film_, batch, source, clock_);
  }
  if (plan_.is_radiance_alone()) {
    launch("accumulate", accumulate_film, grid, block, 0, film_.pixels, batch, tally_, clock_);
  } else {
    launch("accumulate", accumulate_planes, grid, block, 0, film_, batch, scene_.filter, source,
           tally_, clock_);
  }
}

// CUDA loads a kernel at its first use, which takes longer than most of them run. A batch
// of a few pixels loads all that the render will use.
void CudaRenderer::load_kernels() {
  const Stopwatch watch;
  // Set-up filled memory on the default stream, for which stream_ does not wait.
  check_cuda(cudaDeviceSynchronize(), "setting up");
  Window window = image_window();
  window.width = std::min(window.width, 8u), window.height = std::min(window.height, 4u);
  RenderRun run;
  if (has_chains()) {
    begin_chains({0, 0, 1, 1});
    trace_bootstrap(0, 1, run, {});
    sum_targets(1, run);
    splat_bootstrap(1, {}, run);
    start_chains({0, 0, {0.0}, {}}, {}, run);
    mutate_chains(1, {}, 0, run);
    finish_chains(1, {}, run);
  } else {
    render_batch({samples(), window, 0, 1}, run, {});
  }
  take_wave_count();
  load_ms_ = watch.ms();
}

/// function(device's array, film's array, planes of both) for those that the film has.
template <class SomeFilm, class Function>
void CudaRenderer::for_each_film_array(SomeFilm& film, Function&& function) const {
  const std::uint64_t signs = plan_.signs();
  function(film_.pixels, film.pixels, signs);
  if (plan_.moments) function(film_.moments, film.moments, signs);
  if (film_.planes > 0) function(film_.features, film.features, signs * film_.planes);
}

void CudaRenderer::store_film(const Film& film) {
  film_.first_sample = film.first_sample;
  const auto upload_plane = [&](auto* place, const auto& values, std::uint64_t planes) {
    const std::uint64_t bytes = planes * film.window.pixel_count() * sizeof *place;
    if (film.is_empty()) {
      check_cuda(cudaMemsetAsync(place, 0, bytes, stream_), "cudaMemset");
    } else {
      check_cuda(cudaMemcpyAsync(place, values.data(), bytes, cudaMemcpyHostToDevice, stream_),
                 "uploading the film");
    }
  };
  for_each_film_array(film, upload_plane);
  check_cuda(
      cudaMemcpyAsync(tally_, &film.tally, sizeof(PathTally), cudaMemcpyHostToDevice, stream_),
      "cudaMemcpyAsync");
  check_cuda(cudaStreamSynchronize(stream_), "uploading the film");
}

void CudaRenderer::begin_render(const Film& film) {
  check_cuda(cudaSetDevice(device_), "cudaSetDevice");
  if (load_ms_ == 0) load_kernels();
  store_film(film);
  check_cuda(cudaMemsetAsync(clock_, 0, sizeof(StageClock), stream_), "cudaMemset");
  if (lane_counts_ != nullptr) {
    check_cuda(cudaMemsetAsync(lane_counts_, 0, sizeof(LaneCounts), stream_), "cudaMemset");
  }
}

void CudaRenderer::end_render(RenderRun& run) {
  run.waves = take_wave_count();
  read_clock(run);
}

void CudaRenderer::read_film(Film& film) {
  const Stopwatch transfer;
  for_each_film_array(film, [&](auto* place, auto& values, std::uint64_t planes) {
    values.resize(planes * film.window.pixel_count());
    check_cuda(
        cudaMemcpy(values.data(), place, values.size() * sizeof *place, cudaMemcpyDeviceToHost),
        "downloading the film");
  });
  transfer_ms_ += transfer.ms();
  film.tally = read_tally();
}

PathTally CudaRenderer::read_tally() const {
  PathTally tally;
  check_cuda(cudaMemcpy(&tally, tally_, sizeof tally, cudaMemcpyDeviceToHost), "cudaMemcpy");
  return tally;
}

std::vector<LaneHistogram> CudaRenderer::read_lane_counts() const {
  if (lane_counts_ == nullptr) return {};
  const auto counts = std::make_unique<LaneCounts>();
  check_cuda(cudaMemcpy(counts.get(), lane_counts_, sizeof *counts, cudaMemcpyDeviceToHost),
             "reading lane counts");
  return lane_histograms(*counts);
}

void CudaRenderer::read_clock(RenderRun& run) {
  StageClock clock;
  check_cuda(cudaMemcpy(&clock, clock_, sizeof clock, cudaMemcpyDeviceToHost), "cudaMemcpy");
  for (const StageInfo& stage : stage_table) {
    const auto i = static_cast<std::size_t>(stage.id);
    if (clock.launches[i] == 0) continue;
    run.stages.push_back(
        {std::string(stage.name), static_cast<double>(clock.time_ns[i]) * 1e-6, clock.launches[i]});
  }
}

void CudaRenderer::describe(RenderReport& report) const {
  report.device_kind = "cuda";
  report.device_name = properties_.name;
  report.driver = driver_;
  report.accel = accel_name(traits_.accel);
  describe_plan(report);
  report.pool_size = pool_size_;
  report.primitives = primitive_count_;
  if (tree_facts_.nodes > 0) report.scene.tree = tree_facts_;
  report.setup_ms = setup_ms_;
  report.load_ms = load_ms_;
  report.transfer_ms = transfer_ms_;
  report.counts = summarize(read_tally());
  report.memory = memory_.buffers();
  report.kernels = kernels_;
  report.divergence = read_lane_counts();
}

}  // namespace pt
