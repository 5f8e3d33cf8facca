#include "common/device/cpu_renderer.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <fstream>
#include <thread>

#include "common/error.h"
#include "common/film/develop.h"
#include "common/render/batches.h"
#include "common/scene/prepare_scene.h"

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

PathTally operator+(PathTally a, const PathTally& b) {
  a.rays += b.rays;
  a.shadow_rays += b.shadow_rays;
  a.nonfinite += b.nonfinite;
  for (int i = 0; i < path_length_bins; ++i) a.lengths[i] += b.lengths[i];
  return a;
}

}  // namespace

void check_host_memory(std::uint64_t size_bytes, const std::string& purpose) {
  constexpr double mib = 1024.0 * 1024.0;
  const std::uint64_t available = free_host_memory();
  if (size_bytes > available) {
    throw Error(fmt::format("not enough memory: {} needs {:.0f} MiB, {:.0f} MiB are free", purpose,
                            static_cast<double>(size_bytes) / mib,
                            static_cast<double>(available) / mib));
  }
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

CpuRenderer::CpuRenderer(const Options& options, const SceneData& scene, int threads)
    : options_(options),
      limits_(path_limits_of(options)),
      traits_(scene.traits),
      scene_(host_view(scene, options.width, options.height)),
      threads_(threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency())),
      arena_(threads_),
      primitive_count_(scene.primitive_count()) {
  const auto start = std::chrono::steady_clock::now();
  const std::uint64_t pixels = std::uint64_t(options.width) * std::uint64_t(options.height);
  batch_samples_ = batch_samples(options.spp, pixels, batch_paths_max);
  const std::uint64_t paths = pixels * static_cast<std::uint64_t>(batch_samples_);
  const std::uint64_t state_bytes =
      options.rng == RngKind::xorwow ? paths * sizeof(XorwowState) : 0;
  // The image itself and its copy for writing come on top of the film.
  check_host_memory(pixels * (sizeof(FilmPixel) + 24) + paths * sizeof(Sample) + state_bytes,
                    fmt::format("an image of {} x {} pixels", options.width, options.height));
  if (paths > 0x7fffffffu) {
    throw Error(fmt::format("--width {} --height {}: expected fewer than 2^31 pixels",
                            options.width, options.height));
  }
  film_.resize(pixels);
  samples_.resize(paths);
  if (state_bytes > 0) states_.resize(paths);
  note_memory("film", pixels * sizeof(FilmPixel));
  note_memory("samples", paths * sizeof(Sample));
  if (state_bytes > 0) note_memory("random states", state_bytes);
  setup_ms_ =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void CpuRenderer::note_memory(const char* name, std::uint64_t size_bytes) {
  memory_.push_back({name, size_bytes});
}

RenderRun CpuRenderer::render(const RenderHooks& hooks) {
  film_.assign(film_.size(), {});
  tally_ = {};
  timer_.reset();
  waves_ = 0;
  SampleBuffer buffer;
  buffer.samples = samples_.data();
  buffer.width = FastDivider(static_cast<std::uint32_t>(options_.width));
  buffer.pixel_count = FastDivider(static_cast<std::uint32_t>(film_.size()));
  RenderRun run;
  run.samples_done = for_each_batch(
      options_.spp, batch_samples_, film_.size(), hooks, [&](int first_sample, int samples) {
        const auto start = std::chrono::steady_clock::now();
        buffer.first_sample = static_cast<std::uint32_t>(first_sample);
        buffer.sample_count = static_cast<std::uint32_t>(samples);
        buffer.path_count = static_cast<std::uint32_t>(film_.size()) * buffer.sample_count;
        arena_.execute([&] {
          trace_batch(buffer);
          timer_.time("accumulate", [&] { accumulate(buffer); });
        });
        const std::chrono::duration<double, std::milli> elapsed =
            std::chrono::steady_clock::now() - start;
        run.kernel_ms += elapsed.count();
      });
  run.stages = timer_.stages();
  run.waves = waves_;
  return run;
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
                            accumulate_pixel(film_.data(), batch, i, sum,
                                             [&](int bin) { ++sum.lengths[bin]; });
                          }
                          return sum;
                        },
                        [](const PathTally& a, const PathTally& b) { return a + b; });
}

Image CpuRenderer::image() { return develop(film_, options_.width, options_.height); }

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
