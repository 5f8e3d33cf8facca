#include <fmt/format.h>

#include <algorithm>

#include "common/accel/build/build_triangle_tree.h"
#include "common/accel/build_cuda/device_triangle_tree.cuh"
#include "common/device/cuda/cuda_image.cuh"
#include "common/device/cuda/cuda_launcher.cuh"
#include "common/device/cuda/cuda_renderer.cuh"
#include "common/device/cuda/film_kernels.cuh"
#include "common/device/cuda/stage_clock.h"
#include "common/error/host_memory.h"
#include "common/film/develop.h"
#include "common/options/option_names.h"
#include "common/plan/plan_steps.h"
#include "common/render/lane_histograms.h"
#include "common/scene/data/scene_arrays.h"
#include "common/scene/data/scene_facts.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/scene/prepare/prepare_steps.h"
#include "common/transport/mask.h"

namespace pt {
namespace {

SceneTraits traits_on_cuda(const SceneData& scene) {
  SceneTraits traits = scene.traits;
  traits.has_sparse = looks_up_sparse_grids(scene.properties);
  return traits;
}

// One batch takes a tenth of a second at most, and 2 GiB for its samples.
constexpr std::uint64_t batch_paths_max = std::uint64_t{1} << 27;
constexpr std::uint64_t first_paths = std::uint64_t{1} << 24;  // of a scene of unknown speed

}  // namespace

CudaRenderer::CudaRenderer(const ExecutionPlan& plan, const SceneData& scene, int device)
    : FilmRenderer(plan, scene),
      CudaLauncher(device, plan.limits),
      traits_(traits_on_cuda(scene)),
      primitive_count_(scene.primitive_count()),
      half_spheres_(scene.half_spheres) {
  const WallTimer watch;
  int driver = 0, runtime = 0;
  check_cuda(cudaDriverGetVersion(&driver), "cudaDriverGetVersion");
  check_cuda(cudaRuntimeGetVersion(&runtime), "cudaRuntimeGetVersion");
  driver_ = fmt::format("CUDA driver {}.{}, runtime {}.{}", driver / 1000, driver % 1000 / 10,
                        runtime / 1000, runtime % 1000 / 10);
  const WallTimer transfer;
  try {
    upload(scene);
  } catch (const OutOfMemory& error) {
    throw Error(error.what());  // which less memory for paths does not mend
  }
  transfer_ms_ = transfer.ms();
  allocate_film();
  setup_ms_ = opening_ms() + watch.ms() - transfer_ms_;
}

CudaRenderer::~CudaRenderer() = default;

void CudaRenderer::upload(const SceneData& scene) {
  scene_ = host_view(scene, plan_.width, plan_.height);
  scene_.mask_seed = mask_seed(plan_.seed);
  scene_.shutter_times = shutter_times_of(plan_);
  if constexpr (counts_lanes) {
    lane_counts_ = memory_.allocate<LaneCounts>("lane counts", 1);
    set_lanes(scene_, LaneCounter(lane_counts_));
  }
  const auto upload_array = [&](auto*& pointer, const auto& values, const char* kind) {
    pointer = memory_.upload(kind, values);
  };
  for_each_array(scene, scene_, [&](auto*& pointer, const auto& values, const char* kind) {
    upload_array(pointer, values, kind);
    array_sizes_.push_back(values.size());
  });
  if (scene.motion.prepared) {
    Motion motion = scene.motion.prepared->view;
    scene.motion.prepared->for_each_array(motion, [&](auto*& pointer, const auto& values) {
      upload_array(pointer, values, "motion");
    });
    scene_.motion = memory_.upload("motion", std::vector<Motion>{motion});
  }
  if (traits_.geometry != Geometry::spheres_and_quads && is_device_builder(plan_.builder)) {
    const DeviceTriangleTree built = build_device_triangle_tree(
        scene.meshes, scene.instances, tree_options(traits_.accel, plan_.builder), memory_);
    scene_.triangles = built.view;
    tree_facts_ = tree_facts(built.summary, scene.triangle_count());
  } else {
    scene_.triangles = scene.tree.view(upload_array);
  }
}

void CudaRenderer::allocate_planes(std::uint64_t pixels) {
  const std::uint64_t count = film_plan_.signs() * pixels;
  film_.aovs = film_plan_.aovs;
  film_.planes = film_plan_.feature_planes();
  film_.two_signs = film_plan_.two_signs;
  film_.pixels = memory_.allocate<FilmPixel>("film", count);
  if (film_plan_.moments) film_.moments = memory_.allocate<PixelMoments>("film", count);
  if (film_.planes > 0) film_.features = memory_.allocate<double>("film", count * film_.planes);
}

void CudaRenderer::allocate_film() {
  const std::uint64_t pixels = image_window().pixel_count();
  const std::uint64_t state_bytes = plan_.rng == RngKind::xorwow ? random_state_bytes() : 0;
  make_samples(
      {"device memory", CudaMemory::free_bytes() >> plan_.memory_halvings,
       film_plan_.bytes_per_pixel(), sizeof(Sample) + state_bytes, batch_paths_max, first_paths},
      CudaChains::defaults(properties_), [&](std::uint64_t paths) {
        allocate_planes(pixels);
        Sample* samples = memory_.allocate<Sample>("samples", paths);
        if (state_bytes > 0) {
          states_ = reinterpret_cast<CurandState*>(
              memory_.allocate<char>("random states", paths * state_bytes));
        }
        return samples;
      });
  if (has_chains()) chains_ = std::make_unique<CudaChains>(*this, chain_layout());
  tally_ = memory_.allocate<PathTally>("counters", 1);
  set_clock(memory_.allocate<StageClock>("counters", 1));
  check_cuda(cudaMemset(tally_, 0, sizeof(PathTally)), "cudaMemset");
}

HardwareCounters CudaRenderer::count_hardware() {
  use_device();
  const std::uint64_t pixels = image_window().pixel_count();
  const int count = batch_samples(plan_.spp, pixels, batch_paths());
  const SampleBuffer batch{samples(), image_window(), 0, static_cast<std::uint32_t>(count)};
  Film film;
  film.window = image_window();
  HardwareCounters result = count_launches([&] {
    begin_render(&film);
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

bool CudaRenderer::render_batch(const SampleBuffer& batch, RenderRun& run,
                                const std::function<bool()>&) {
  constexpr int block = 256;
  const ProfilerRange range(fmt::format("batch of {} paths", batch.path_count));
  prepare_batch(batch);
  time_batch(run, [&] {
    if (plan_.rng == RngKind::xorwow) {
      launch("render_init", render_init, (batch.path_count + block - 1) / block, block, 0, states_,
             batch, plan_.seed, clock());
    }
    trace_batch(batch);
    set_wave(-1);
    accumulate(batch);
  });
  return true;
}

void CudaRenderer::accumulate(const SampleBuffer& batch) {
  const int block = plan_.stage_block[static_cast<int>(StageId::accumulate)];
  const int grid = (batch.pixel_count.divisor() + block - 1) / block;
  const SamplerSource source = sampler_source_of(plan_);
  if (film_.features != nullptr) {
    constexpr int feature_block = 128;
    Scene scene = scene_;
    set_lanes(scene, {});  // these camera rays belong to no path
    launch("features", feature_kernel(traits_),
           (batch.pixel_count.divisor() + feature_block - 1) / feature_block, feature_block, 0,
           scene, film_, batch, source, clock());
  }
  if (film_plan_.is_radiance_alone()) {
    launch("accumulate", accumulate_film, grid, block, 0, film_.pixels, batch, tally_, clock());
  } else {
    launch("accumulate", accumulate_planes, grid, block, 0, film_, batch, scene_.filter, source,
           tally_, clock());
  }
}

// CUDA loads a kernel at its first use, which takes longer than most of them run. A batch
// of a few pixels loads all that the render will use.
void CudaRenderer::load_kernels() {
  const WallTimer watch;
  // Set-up filled memory on the default stream, for which stream_ does not wait. (To wait for the
  // device would break the graph that another thread records.)
  check_cuda(cudaStreamSynchronize(nullptr), "setting up");
  Window window = image_window();
  Film empty;
  empty.window = window;
  store_film(empty);  // so that nothing is read that was not written (initcheck)
  reset_clock();
  window.width = std::min(window.width, 8u), window.height = std::min(window.height, 4u);
  RenderRun run;
  if (has_chains()) {
    chains_->load_kernels(run);
  } else {
    render_batch({samples(), window, 0, 1}, run, {});
  }
  take_wave_count();
  load_ms_ = watch.ms();
}

/// function(device's array, film's array, planes of both) for those that the film has.
template <class SomeFilm, class Function>
void CudaRenderer::for_each_film_array(SomeFilm& film, Function&& function) const {
  const std::uint64_t signs = film_plan_.signs();
  function(film_.pixels, film.pixels, signs);
  if (film_plan_.moments) function(film_.moments, film.moments, signs);
  if (film_.planes > 0) function(film_.features, film.features, signs * film_.planes);
}

// Enqueues it.
void CudaRenderer::develop_into(float* rgb) {
  const Image image = frame();
  develop_film(film_.pixels, rgb, static_cast<std::uint32_t>(image.width * image.height), stream());
  check_cuda(cudaGetLastError(), "developing the film");
}

// Without layers, what the viewer of a render at work waits for is a third of the film. The samples
// of a batch, which has ended, are in the film: their place holds the image's three floats a pixel.
// That of Markov chains may be smaller.
Image CudaRenderer::image() {
  if (!develops_here()) return FilmRenderer::image();
  use_device();
  const WallTimer transfer;
  Image image = blank_image();
  static_assert(sizeof(Sample) >= 3 * sizeof(float));
  auto* const rgb = reinterpret_cast<float*>(samples());
  develop_into(rgb);
  download_.copy(image.rgb.data(), rgb, image.rgb.size() * sizeof *rgb, stream());
  transfer_ms_ += transfer.ms();
  return image;
}

std::unique_ptr<DeviceImage> CudaRenderer::device_image() {
  use_device();
  if (develops_here()) {
    auto result = std::make_unique<CudaImage>(frame(), device());
    develop_into(result->rgb());
    check_cuda(cudaStreamSynchronize(stream()), "developing the film");
    return result;
  }
  Image image = FilmRenderer::image();
  const std::vector<float> rgb = std::move(image.rgb);
  auto result = std::make_unique<CudaImage>(std::move(image), device());
  check_cuda(
      cudaMemcpy(result->rgb(), rgb.data(), rgb.size() * sizeof(float), cudaMemcpyHostToDevice),
      "uploading the image");
  return result;
}

bool CudaRenderer::set_camera(const Camera& camera) {
  scene_.camera = camera;
  forget_film();
  return true;
}

bool CudaRenderer::has_same_sizes(const SceneData& scene) {
  Scene none;
  std::vector<std::size_t> sizes;
  for_each_array(scene, none,
                 [&](auto*&, const auto& values, const char*) { sizes.push_back(values.size()); });
  return sizes == array_sizes_;
}

bool CudaRenderer::set_scene(const SceneData& scene, const SceneChanges& changes) {
  const bool may_move = scene.moves() || changes.move_surfaces() || changes.normals;
  if (may_move || !has_same_sizes(scene)) return false;
  use_device();
  Scene changed = host_view(scene, plan_.width, plan_.height);  // the numbers of the view
  changed.mask_seed = scene_.mask_seed;
  changed.triangles = scene_.triangles;
  if constexpr (counts_lanes) set_lanes(changed, LaneCounter(lane_counts_));
  std::vector<const void*> places;
  for_each_array(scene, scene_,
                 [&](auto*& pointer, const auto&, const char*) { places.push_back(pointer); });
  auto place = places.begin();
  for_each_array(scene, changed, [&](auto*& pointer, const auto& values, const std::string& kind) {
    pointer = static_cast<std::remove_reference_t<decltype(pointer)>>(*place++);
    if (values.empty() || (kind != "scene" && kind != "lights")) return;  // no edit reaches others
    check_cuda(cudaMemcpy(const_cast<void*>(static_cast<const void*>(pointer)), values.data(),
                          values.size() * sizeof *pointer, cudaMemcpyHostToDevice),
               "uploading what has changed of the scene");
  });
  check_cuda(cudaStreamSynchronize(nullptr), "uploading what has changed of the scene");
  scene_ = changed;
  forget_film();
  return true;
}

void CudaRenderer::store_film(const Film& film) {
  film_.first_sample = film.first_sample;
  const auto upload_plane = [&](auto* place, const auto& values, std::uint64_t planes) {
    const std::uint64_t bytes = planes * film.window.pixel_count() * sizeof *place;
    if (film.is_empty()) {
      check_cuda(cudaMemsetAsync(place, 0, bytes, stream()), "cudaMemset");
    } else {
      check_cuda(cudaMemcpyAsync(place, values.data(), bytes, cudaMemcpyHostToDevice, stream()),
                 "uploading the film");
    }
  };
  for_each_film_array(film, upload_plane);
  check_cuda(
      cudaMemcpyAsync(tally_, &film.tally, sizeof(PathTally), cudaMemcpyHostToDevice, stream()),
      "cudaMemcpyAsync");
  check_cuda(cudaStreamSynchronize(stream()), "uploading the film");
}

void CudaRenderer::begin_render(const Film* film) {
  use_device();
  if (load_ms_ == 0) load_kernels();
  if (film != nullptr) store_film(*film);
  reset_clock();
  if (lane_counts_ != nullptr) {
    check_cuda(cudaMemsetAsync(lane_counts_, 0, sizeof(LaneCounts), stream()), "cudaMemset");
  }
}

void CudaRenderer::end_render(RenderRun& run) {
  run.waves = take_wave_count();
  read_clock(run);
}

void CudaRenderer::read_film(Film& film) {
  const WallTimer transfer;
  for_each_film_array(film, [&](auto* place, auto& values, std::uint64_t planes) {
    values.resize(planes * film.window.pixel_count());
    download_.copy(values.data(), place, values.size() * sizeof *place, stream());
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

void CudaRenderer::describe(RenderReport& report) const {
  report.device_kind = "cuda";
  report.device_name = properties_.name + part_text();
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
  report.kernels = kernels();
  report.divergence = read_lane_counts();
}

}  // namespace pt
