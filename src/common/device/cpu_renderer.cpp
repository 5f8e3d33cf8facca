#include "common/device/cpu_renderer.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <fstream>
#include <span>
#include <thread>

#include "common/film/develop.h"
#include "common/memory_error.h"
#include "common/scene/prepare_scene.h"
#include "common/transport/mask.h"

namespace pt {
namespace {

// Small enough for a quick answer to an interruption, large enough to keep the threads busy.
constexpr std::uint64_t batch_paths_max = std::uint64_t{1} << 20;

std::uint64_t free_host_memory() {
  std::ifstream file("/proc/meminfo");
  std::string key, unit;
  std::uint64_t kib = 0;
  while (file >> key >> kib && std::getline(file, unit)) {
    if (key == "MemAvailable:") return kib * 1024;
  }
  return ~std::uint64_t{0};  // unknown: let the allocation decide
}

}  // namespace

void check_host_memory(std::uint64_t size_bytes, const std::string& purpose) {
  const std::uint64_t available = free_host_memory();
  if (size_bytes > available) throw memory_error("memory", purpose, size_bytes, available);
}

void StageTimer::add(const std::string& stage, std::chrono::duration<double, std::milli> elapsed) {
  for (StageTime& entry : stages_) {
    if (entry.stage == stage) {
      entry.time_ms += elapsed.count();
      ++entry.launches;
      return;
    }
  }
  stages_.push_back({stage, elapsed.count(), 1});
}

namespace {

Scene seeded_view(const SceneData& scene, const Options& options) {
  Scene view = host_view(scene, options.width, options.height);
  view.mask_seed = mask_seed(options.seed);
  return view;
}

}  // namespace

CpuRenderer::CpuRenderer(const Options& options, const SceneData& scene, int threads)
    : FilmRenderer(options),
      traits_(scene.traits),
      scene_(seeded_view(scene, options)),
      threads_(threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency())),
      arena_(threads_),
      primitive_count_(scene.primitive_count()) {
  const auto start = std::chrono::steady_clock::now();
  const std::uint64_t state_bytes = options.rng == RngKind::xorwow ? sizeof(XorwowState) : 0;
  // The image itself and its copy for writing come on top of the film.
  constexpr std::uint64_t image_bytes = 2 * 3 * sizeof(float);
  make_samples({"memory", free_host_memory(), sizeof(FilmPixel) + image_bytes,
                sizeof(Sample) + state_bytes, batch_paths_max},
               [&](std::uint64_t paths) {
                 sample_memory_.resize(paths);
                 if (state_bytes > 0) states_.resize(paths);
                 return sample_memory_.data();
               });
  pixels_.resize(std::size_t(options.width) * std::size_t(options.height));
  note_memory("film", pixels_.size() * sizeof(FilmPixel));
  note_memory("samples", sample_memory_.size() * sizeof(Sample));
  if (state_bytes > 0) note_memory("random states", states_.size() * state_bytes);
  setup_ms_ =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void CpuRenderer::note_memory(const char* name, std::uint64_t size_bytes) {
  memory_.push_back({name, size_bytes});
}

Image CpuRenderer::image() {
  const Window& w = window();
  return develop(std::span<const FilmPixel>(pixels_).first(w.pixel_count()),
                 static_cast<int>(w.width), static_cast<int>(w.height));
}

void CpuRenderer::begin_render(const Film& film) {
  if (film.is_empty()) {
    std::fill_n(pixels_.begin(), film.window.pixel_count(), FilmPixel{});
  } else {
    std::copy(film.pixels.begin(), film.pixels.end(), pixels_.begin());
  }
  tally_ = film.tally;
  timer_.reset();
  waves_ = 0;
}

void CpuRenderer::render_batch(const SampleBuffer& batch, RenderRun& run) {
  const auto start = std::chrono::steady_clock::now();
  arena_.execute([&] {
    trace_batch(batch);
    timer_.time("accumulate", [&] { accumulate(batch); });
  });
  const std::chrono::duration<double, std::milli> elapsed =
      std::chrono::steady_clock::now() - start;
  run.kernel_ms += elapsed.count();
}

void CpuRenderer::end_render(RenderRun& run) {
  run.stages = timer_.stages();
  run.waves = waves_;
}

void CpuRenderer::read_film(Film& film) {
  film.pixels.assign(pixels_.begin(),
                     pixels_.begin() + static_cast<std::ptrdiff_t>(film.window.pixel_count()));
  film.tally = tally_;
}

void CpuRenderer::init_random_states(const SampleBuffer& batch) {
  tbb::parallel_for(std::uint32_t{0}, batch.path_count, [&](std::uint32_t i) {
    xorwow_init(xorwow_seed(options_.seed, batch.id_of(i)), states_[i]);
  });
}

void CpuRenderer::accumulate(const SampleBuffer& batch) {
  const tbb::blocked_range<std::uint32_t> pixels(0, batch.pixel_count.divisor(), 4096);
  tally_ = tally_ + tbb::parallel_reduce(
                        pixels, PathTally{},
                        [&](const tbb::blocked_range<std::uint32_t>& range, PathTally sum) {
                          for (std::uint32_t i = range.begin(); i < range.end(); ++i) {
                            accumulate_pixel(pixels_.data(), batch, i, sum,
                                             [&](int bin) { ++sum.lengths[bin]; });
                          }
                          return sum;
                        },
                        [](const PathTally& a, const PathTally& b) { return a + b; });
}

void CpuRenderer::describe(RenderReport& report) const {
  report.device_kind = "cpu";
  report.device_name = fmt::format("CPU, {} thread{}", threads_, threads_ == 1 ? "" : "s");
  report.accel = accel_name(traits_.accel);
  report.pool_size = pool_size_;
  report.primitives = primitive_count_;
  report.setup_ms = setup_ms_;
  report.counts = summarize(tally_);
  report.memory = memory_;
}

}  // namespace pt
