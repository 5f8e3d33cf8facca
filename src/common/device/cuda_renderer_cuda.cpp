#include <fmt/format.h>
#include <nvtx3/nvToolsExt.h>

#include <algorithm>
#include <chrono>

#include "common/accel/build/check_builder.h"
#include "common/accel/build_cuda/device_triangle_tree.cuh"
#include "common/device/cuda_renderer.cuh"
#include "common/device/film_kernels.cuh"
#include "common/error.h"
#include "common/film/develop.h"
#include "common/render/batches.h"
#include "common/render/option_names.h"
#include "common/scene/prepare_scene.h"
#include "common/scene/prepare_triangles.h"
#include "common/scene/scene_facts.h"

namespace pt {
namespace {

// One batch takes a tenth of a second at most, and 2 GiB for its samples.
constexpr std::uint64_t batch_paths_max = std::uint64_t{1} << 27;

constexpr double mib = 1024.0 * 1024.0;

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
    : options_(options),
      limits_(path_limits_of(options)),
      traits_(scene.traits),
      device_(device),
      primitive_count_(scene.primitive_count()),
      scan_spheres_(scene.scan_spheres) {
  const Stopwatch watch;
  check_cuda(cudaSetDevice(device), "cudaSetDevice");
  check_cuda(cudaGetDeviceProperties(&properties_, device), "cudaGetDeviceProperties");
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
  const std::size_t sphere_bytes = scene.scan_spheres.size() * sizeof(Sphere);
  const bool fits_constant = scene.scan_spheres.size() <= constant_spheres_max;
  scene_memory_ = options_.scene_memory;
  if (scene_memory_ == SceneMemory::automatic) {
    scene_memory_ = fits_constant && traits_.geometry == Geometry::spheres_and_quads &&
                            traits_.accel == Accel::brute
                        ? SceneMemory::constant
                        : SceneMemory::global;
  }
  if (scene_memory_ != SceneMemory::global && traits_.geometry != Geometry::spheres_and_quads) {
    throw Error(
        fmt::format("--scene-memory {}: holds the spheres of scenes without triangles; expected "
                    "global or auto",
                    to_string(scene_memory_)));
  }
  if (scene_memory_ == SceneMemory::constant && !fits_constant) {
    throw Error(
        fmt::format("--scene-memory constant: the scene has {} spheres; a kernel's "
                    "parameters hold at most {}",
                    scene.spheres.size(), constant_spheres_max));
  }
  constexpr std::size_t own_shared_bytes = 2048;  // what a kernel needs besides, at most
  if (scene_memory_ == SceneMemory::shared &&
      sphere_bytes + own_shared_bytes > properties_.sharedMemPerBlockOptin) {
    throw Error(
        fmt::format("--scene-memory shared: the scene's {} spheres take {} bytes; a block "
                    "of this device has at most {}",
                    scene.spheres.size(), sphere_bytes, properties_.sharedMemPerBlockOptin));
  }
  scene_ = host_view(scene, options_.width, options_.height);
  scene_.primitives.spheres = memory_.upload("scene", scene.spheres);
  scene_.primitives.scan = memory_.upload("scene", scene.scan_spheres);
  scene_.primitives.quads = memory_.upload("scene", scene.quads);
  scene_.materials = memory_.upload("scene", scene.materials);
  scene_.material_of = memory_.upload("scene", scene.material_of);
  scene_.lights = memory_.upload("scene", scene.lights);
  scene_.bvh_nodes = memory_.upload("acceleration structure", scene.bvh_nodes);
  if (traits_.geometry != Geometry::spheres_and_quads) upload_triangles(scene);
}

void CudaRenderer::upload_tree(const TriangleTreeData& data) {
  TriangleTree& tree = scene_.triangles;
  tree.bvh2 = memory_.upload("acceleration structure", data.bvh2);
  tree.cwbvh = memory_.upload("acceleration structure", data.cwbvh);
  tree.triangles = memory_.upload("triangles", data.triangles);
  tree.instances = memory_.upload("instances", data.instances);
}

void CudaRenderer::upload_triangles(const SceneData& scene) {
  if (is_device_builder(options_.builder)) {
    const DeviceTriangleTree built = build_device_triangle_tree(
        scene.meshes, scene.instances, tree_options(traits_.accel, options_.builder), memory_);
    scene_.triangles = built.view;
    tree_facts_ = tree_facts(built.summary, scene.triangle_count());
  } else {
    upload_tree(scene.tree);
  }
  scene_.to_world = memory_.upload("instances", scene.to_world);
  scene_.attributes = {memory_.upload("vertex attributes", scene.attributes.triangles),
                       memory_.upload("vertex attributes", scene.attributes.normals),
                       memory_.upload("vertex attributes", scene.attributes.uvs)};
  scene_.light_list.lights = memory_.upload("lights", scene.light_list.lights);
  scene_.light_list.selection = memory_.upload("lights", scene.light_list.selection);
  scene_.environment.texels = memory_.upload("environment", scene.environment_map.texels);
  scene_.environment.alias = memory_.upload("environment", scene.environment_map.alias);
  scene_.material_textures = memory_.upload("scene", scene.material_textures);
  scene_.textures = memory_.upload("textures", scene.textures);
  scene_.texels = memory_.upload("textures", scene.texels);
}

void CudaRenderer::allocate_film() {
  const std::uint64_t pixels = std::uint64_t(options_.width) * std::uint64_t(options_.height);
  const std::uint64_t bytes_per_path =
      sizeof(Sample) + (options_.rng == RngKind::xorwow ? random_state_bytes() : 0);
  const std::uint64_t least = pixels * (sizeof(FilmPixel) + bytes_per_path);
  const std::uint64_t free = CudaMemory::free_bytes();
  if (least > free || pixels > 0x7fffffffu) {
    throw Error(
        fmt::format("not enough device memory: an image of {} x {} pixels needs {:.0f} MiB, "
                    "{:.0f} MiB are free",
                    options_.width, options_.height, static_cast<double>(least) / mib,
                    static_cast<double>(free) / mib));
  }
  // Half of what is free is left to the path pool and to others.
  const std::uint64_t room = std::max(free / 2, least) - pixels * sizeof(FilmPixel);
  batch_samples_ =
      batch_samples(options_.spp, pixels, std::min(batch_paths_max, room / bytes_per_path));
  const std::uint64_t paths = pixels * static_cast<std::uint64_t>(batch_samples_);
  batch_paths_ = paths;
  film_ = memory_.allocate<FilmPixel>("film", pixels);
  samples_ = memory_.allocate<Sample>("samples", paths);
  if (options_.rng == RngKind::xorwow) {
    states_ = reinterpret_cast<CurandState*>(
        memory_.allocate<char>("random states", paths * random_state_bytes()));
  }
  tally_ = memory_.allocate<PathTally>("counters", 1);
  clock_ = memory_.allocate<StageClock>("counters", 1);
  check_cuda(cudaMemset(film_, 0, pixels * sizeof(FilmPixel)), "cudaMemset");
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
  kernel_pointers_.push_back(kernel);
  kernels_.push_back({name, attributes.numRegs, attributes.localSizeBytes,
                      attributes.sharedSizeBytes + shared_bytes, threads,
                      static_cast<double>(warps) / room});
}

void CudaRenderer::launch_erased(const char* name, const void* kernel, dim3 grid, dim3 block,
                                 std::size_t shared_bytes, void** arguments) {
  if (std::find(kernel_pointers_.begin(), kernel_pointers_.end(), kernel) ==
      kernel_pointers_.end()) {
    note_kernel(name, kernel, block, shared_bytes);
  }
  nvtxRangePushA(name);
  const cudaError_t status =
      cudaLaunchKernel(kernel, grid, block, arguments, shared_bytes, stream_);
  nvtxRangePop();
  check_cuda(status, name);
}

void CudaRenderer::render_batch(const SampleBuffer& batch, RenderRun& run) {
  constexpr int block = 256;
  prepare_batch(batch);
  check_cuda(cudaEventRecord(start_, stream_), "cudaEventRecord");
  launch("start_clock", start_clock, 1, 1, 0, clock_);
  if (options_.rng == RngKind::xorwow) {
    launch("render_init", render_init, (batch.path_count + block - 1) / block, block, 0, states_,
           batch, options_.seed, clock_);
  }
  trace_batch(batch);
  const int accumulate_block = options_.stage_block[static_cast<int>(StageId::accumulate)];
  launch("accumulate", accumulate_film,
         (batch.pixel_count.divisor() + accumulate_block - 1) / accumulate_block, accumulate_block,
         0, film_, batch, tally_, clock_);
  launch("stop_clock", stop_clock, 1, 1, 0, clock_);
  check_cuda(cudaEventRecord(stop_, stream_), "cudaEventRecord");
  check_cuda(cudaEventSynchronize(stop_), "rendering a batch");
  float elapsed_ms = 0;
  check_cuda(cudaEventElapsedTime(&elapsed_ms, start_, stop_), "cudaEventElapsedTime");
  run.kernel_ms += elapsed_ms;
}

SampleBuffer CudaRenderer::sample_buffer(std::uint32_t width, std::uint32_t pixels) const {
  SampleBuffer batch;
  batch.samples = samples_;
  batch.width = FastDivider(width);
  batch.pixel_count = FastDivider(pixels);
  return batch;
}

// CUDA loads a kernel when it is first asked for, which takes longer than most of them run. A batch
// of a few pixels asks for all that the render will.
void CudaRenderer::load_kernels() {
  const Stopwatch watch;
  const int width = std::min(options_.width, 8), height = std::min(options_.height, 4);
  SampleBuffer batch =
      sample_buffer(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(width * height));
  batch.sample_count = 1;
  batch.path_count = batch.pixel_count.divisor();
  RenderRun run;
  render_batch(batch, run);
  take_wave_count();
  load_ms_ = watch.ms();
}

RenderRun CudaRenderer::render(const RenderHooks& hooks) {
  check_cuda(cudaSetDevice(device_), "cudaSetDevice");
  if (load_ms_ == 0) load_kernels();
  const std::uint64_t pixels = std::uint64_t(options_.width) * std::uint64_t(options_.height);
  check_cuda(cudaMemsetAsync(film_, 0, pixels * sizeof(FilmPixel), stream_), "cudaMemset");
  check_cuda(cudaMemsetAsync(tally_, 0, sizeof(PathTally), stream_), "cudaMemset");
  check_cuda(cudaMemsetAsync(clock_, 0, sizeof(StageClock), stream_), "cudaMemset");
  SampleBuffer batch =
      sample_buffer(static_cast<std::uint32_t>(options_.width), static_cast<std::uint32_t>(pixels));
  RenderRun run;
  run.samples_done = for_each_batch(
      options_.spp, batch_samples_, pixels, hooks, [&](int first_sample, int samples) {
        batch.first_sample = static_cast<std::uint32_t>(first_sample);
        batch.sample_count = static_cast<std::uint32_t>(samples);
        batch.path_count = static_cast<std::uint32_t>(pixels) * batch.sample_count;
        render_batch(batch, run);
      });
  run.waves = take_wave_count();
  read_clock(run);
  return run;
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

Image CudaRenderer::image() {
  const Stopwatch transfer;
  std::vector<FilmPixel> film(std::uint64_t(options_.width) * std::uint64_t(options_.height));
  check_cuda(
      cudaMemcpy(film.data(), film_, film.size() * sizeof(FilmPixel), cudaMemcpyDeviceToHost),
      "downloading the image");
  transfer_ms_ += transfer.ms();
  return develop(film, options_.width, options_.height);
}

void CudaRenderer::describe(RenderReport& report) const {
  PathTally tally;
  check_cuda(cudaMemcpy(&tally, tally_, sizeof tally, cudaMemcpyDeviceToHost), "cudaMemcpy");
  report.device_kind = "cuda";
  report.device_name = properties_.name;
  report.driver = driver_;
  report.accel = accel_name(traits_.accel);
  report.schedule = schedule_;
  report.pool_size = pool_size_;
  report.primitives = primitive_count_;
  if (tree_facts_.nodes > 0) report.scene.tree = tree_facts_;
  report.setup_ms = setup_ms_;
  report.load_ms = load_ms_;
  report.transfer_ms = transfer_ms_;
  report.counts = summarize(tally);
  report.memory = memory_.buffers();
  report.kernels = kernels_;
}

}  // namespace pt
