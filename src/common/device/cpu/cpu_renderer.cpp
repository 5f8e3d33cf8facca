#include "common/device/cpu/cpu_renderer.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <span>

#include "common/device/cpu/huge_pages.h"
#include "common/error/host_memory.h"
#include "common/film/develop.h"
#include "common/plan/plan_steps.h"
#include "common/render/settings_of.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/transport/mask.h"

namespace pt {
namespace {

// Large enough to keep the threads busy; the first ones, whose rate is not known yet, small enough
// for a quick answer to an interruption.
constexpr std::uint64_t batch_paths_max = std::uint64_t{1} << 20;
constexpr std::uint64_t first_paths = std::uint64_t{1} << 12;

}  // namespace

int cpu_threads(int wanted) {
  using tbb::global_control;
  const auto allowed =
      static_cast<int>(global_control::active_value(global_control::max_allowed_parallelism));
  const int most = std::max(1, std::min(allowed, tbb::info::default_concurrency()));
  return wanted > 0 ? std::min(wanted, most) : most;
}

void StageTimer::add(const StageTime& time) {
  for (StageTime& entry : stages_) {
    if (entry.stage == time.stage) {
      entry.time_ms += time.time_ms;
      entry.launches += time.launches;
      return;
    }
  }
  stages_.push_back(time);
}

void StageTimer::add(const StageTimer& other, double share) {
  for (const StageTime& entry : other.stages_) {
    add({entry.stage, share * entry.time_ms, entry.launches});
  }
}

namespace {

Scene seeded_view(const SceneData& scene, const ExecutionPlan& plan) {
  Scene view = host_view(scene, plan.width, plan.height);
  view.triangles.accel = plan.traversal;
  view.mask_seed = mask_seed(plan.seed);
  view.shutter_times = shutter_times_of(plan);
  return view;
}

SceneTraits traits_by(SceneTraits traits, const ExecutionPlan& plan) {
  traits.accel = plan.traversal;
  return traits;
}

}  // namespace

CpuRenderer::CpuRenderer(const ExecutionPlan& plan, const SceneData& scene)
    : FilmRenderer(plan, scene),
      traits_(traits_by(scene.traits, plan)),
      scene_(seeded_view(scene, plan)),
      threads_(cpu_threads(plan.mode == Mode::serial ? 1 : plan.threads)),
      arena_(threads_),
      primitive_count_(scene.primitive_count()) {
  const auto start = std::chrono::steady_clock::now();
  use_huge_pages(scene, expected_cpu_trace_s(
                            expected_rays(double(image_window().pixel_count()), plan), threads_));
  const std::uint64_t state_bytes = plan.rng == RngKind::xorwow ? sizeof(XorwowState) : 0;
  // The image itself and its copy for writing come on top of the film.
  constexpr std::uint64_t image_bytes = 2 * 3 * sizeof(float);
  make_samples({"memory", free_host_memory(), film_plan_.bytes_per_pixel() + image_bytes,
                sizeof(Sample) + state_bytes, batch_paths_max, first_paths},
               {}, [&](std::uint64_t paths) {
                 sample_memory_.resize(paths);
                 if (state_bytes > 0) states_.resize(paths);
                 return sample_memory_.data();
               });
  const std::uint64_t pixels = image_window().pixel_count();
  sums_.reset(film_plan_, pixels);
  note_memory("film", pixels * film_plan_.bytes_per_pixel());
  note_memory("samples", sample_memory_.size() * sizeof(Sample));
  if (state_bytes > 0) note_memory("random states", states_.size() * state_bytes);
  if (has_chains()) {
    chains_ = std::make_unique<CpuChains>(*this, chain_layout());
    note_memory("chains", chains_->size_bytes());
  }
  setup_ms_ =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void CpuRenderer::note_memory(const char* name, std::uint64_t size_bytes) {
  memory_.push_back({name, size_bytes});
}

Image CpuRenderer::image() { return develop_window(sums_); }

bool CpuRenderer::set_camera(const Camera& camera) {
  scene_.camera = camera;
  forget_film();
  return true;
}

bool CpuRenderer::set_scene(const SceneData& scene, const SceneChanges&) {
  const Scene view = seeded_view(scene, plan_);
  // A path's slot has room for what a light tree needs, or none.
  if (view.light_selector.has_tree() != scene_.light_selector.has_tree()) return false;
  scene_ = view;
  forget_film();
  return true;
}

void CpuRenderer::store_film(const Film& film) {
  if (film.is_empty()) {
    sums_.reset(film_plan_, film.window.pixel_count());
  } else {
    sums_ = film;
  }
  first_sample_ = film.first_sample;
  tally_ = film.tally;
}

void CpuRenderer::begin_render(const Film* film) {
  if (film != nullptr) store_film(*film);
  timer_.reset();
  waves_ = 0;
}

/// False: it was abandoned.
bool CpuRenderer::trace_whole(const SampleBuffer& batch, const std::function<bool()>& cancel) {
  cancel_ = &cancel;
  trace_batch(batch);
  const bool is_whole = !is_cancelled();
  cancel_ = nullptr;
  return is_whole;
}

bool CpuRenderer::render_batch(const SampleBuffer& batch, RenderRun& run,
                               const std::function<bool()>& cancel) {
  bool is_whole = true;
  time_in_arena(run, [&] {
    is_whole = trace_whole(batch, cancel);
    if (!is_whole) return;
    if (film_plan_.feature_planes() > 0) {
      timer_.time(to_string(StageId::features), [&] { accumulate_features(batch); });
    }
    timer_.time("accumulate", [&] { accumulate(batch); });
  });
  return is_whole;
}

void CpuRenderer::end_render(RenderRun& run) {
  run.stages = timer_.stages();
  run.waves = waves_;
}

void CpuRenderer::read_film(Film& film) {
  static_cast<FilmSums&>(film) = sums_;
  film.tally = tally_;
}

void CpuRenderer::init_random_states(const SampleBuffer& batch) {
  tbb::parallel_for(std::uint32_t{0}, batch.path_count, [&](std::uint32_t i) {
    xorwow_init(xorwow_seed(plan_.seed, batch.id_of(i)), states_[i]);
  });
}

void CpuRenderer::count_paths(const SampleBuffer& batch) {
  const tbb::blocked_range<std::uint32_t> paths(0, batch.path_count, 4096);
  tally_ =
      tally_ + tbb::parallel_reduce(
                   paths, PathTally{},
                   [&](const tbb::blocked_range<std::uint32_t>& range, PathTally sum) {
                     for (std::uint32_t i = range.begin(); i < range.end(); ++i) {
                       count_sample(batch.samples[i], sum, [&](int bin) { ++sum.lengths[bin]; });
                     }
                     return sum;
                   },
                   [](const PathTally& a, const PathTally& b) { return a + b; });
}

FilmView CpuRenderer::film_view() {
  return {sums_.pixels.data(),
          film_plan_.moments ? sums_.moments.data() : nullptr,
          sums_.features.data(),
          film_plan_.aovs,
          film_plan_.feature_planes(),
          film_plan_.two_signs,
          first_sample_};
}

void CpuRenderer::accumulate(const SampleBuffer& batch) {
  const FilmView film = film_view();
  if (film_plan_.is_radiance_alone()) {
    accumulate_with(batch, [&](std::uint32_t i) { return RadianceSum(film.pixels, i); });
    return;
  }
  const SamplerSource source = sampler_source_of(plan_);
  accumulate_with(batch, [&](std::uint32_t i) {
    return PixelPlanes<SamplerSource>(film, batch, scene_.filter, source, i);
  });
}

template <class MakeSum>
void CpuRenderer::accumulate_with(const SampleBuffer& batch, MakeSum&& make_sum) {
  const tbb::blocked_range<std::uint32_t> pixels(0, batch.pixel_count.divisor(), 4096);
  tally_ = tally_ + tbb::parallel_reduce(
                        pixels, PathTally{},
                        [&](const tbb::blocked_range<std::uint32_t>& range, PathTally sum) {
                          for (std::uint32_t i = range.begin(); i < range.end(); ++i) {
                            accumulate_pixel(make_sum(i), batch, i, sum,
                                             [&](int bin) { ++sum.lengths[bin]; });
                          }
                          return sum;
                        },
                        [](const PathTally& a, const PathTally& b) { return a + b; });
}

void CpuRenderer::accumulate_features(const SampleBuffer& batch) {
  const FilmView film = film_view();
  const SamplerSource source = sampler_source_of(plan_);
  dispatch_traits(CpuSceneKinds{}, feature_traits(traits_), [&](auto traits) {
    if constexpr (feature_traits(traits.value()) == traits.value()) {
      tbb::parallel_for(std::uint32_t{0}, batch.pixel_count.divisor(), [&](std::uint32_t i) {
        pt::accumulate_features<decltype(traits)>(film, batch, scene_, source, i);
      });
    }
  });
}

void CpuRenderer::describe(RenderReport& report) const {
  report.device_kind = "cpu";
  report.device_name = fmt::format("CPU, {} thread{}", threads_, threads_ == 1 ? "" : "s");
  report.accel = accel_name(traits_.accel);
  describe_plan(report);
  report.pool_size = pool_size_;
  report.primitives = primitive_count_;
  report.setup_ms = setup_ms_;
  report.counts = summarize(tally_);
  report.memory = memory_;
}

}  // namespace pt
