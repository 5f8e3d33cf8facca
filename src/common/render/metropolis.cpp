#include "common/render/metropolis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error/host_memory.h"
#include "common/options/option_names.h"
#include "common/render/batches.h"

namespace pt {
namespace {

// With --time-limit: of the time, and the paths for each mutation that are expected to come of it.
constexpr double bootstrap_time_share = 0.5;
constexpr double timed_bootstrap_share = 2.0;
constexpr double least_seconds = 1e-6;  // 0 would be no limit
/// Longer paths draw the numbers of their last rays afresh: 2 KiB for a chain.
constexpr std::uint32_t stored_blocks_max = 128;
/// Sums are taken from the device after so many mutations: they fit whatever they are. One mutation
/// adds less than 2 b / 0.0722 to a channel, the smallest share of one in luminance, where b is the
/// brightness or what was expected, whichever is larger: below 2^5 b, all of them in one pixel 2^37
/// b, or 2^62 quanta.
constexpr std::uint64_t mutations_per_segment = std::uint64_t{1} << 32;
constexpr double quanta_per_brightness = 0x1p25;

std::uint64_t mutations_of(std::uint64_t pixels, int samples) {
  return pixels * static_cast<std::uint64_t>(samples);
}

void refuse(const std::string& option, const std::string& reason) {
  throw Error(fmt::format("{} with --integrator mlt: {}", option, reason));
}

/// What was splatted on the device, taken from it in parts.
class SplatTotals {
 public:
  explicit SplatTotals(std::uint64_t pixels) : quanta_(3 * pixels) {}

  void take(ChainDevice& device) {
    const ChainSums sums = device.take_chain_sums();
    for (std::size_t i = 0; i < quanta_.size(); ++i) {
      quanta_[i] += static_cast<double>(static_cast<std::int64_t>(sums.sums[i]));
    }
    steps_ = steps_ + sums.steps;
    paths_ = paths_ + sums.paths;
  }

  double operator[](std::size_t i) const { return quanta_[i]; }
  const ChainTally& steps() const { return steps_; }
  const PathTally& paths() const { return paths_; }

 private:
  std::vector<double> quanta_;
  ChainTally steps_;
  PathTally paths_;
};

/// The paths before the chains, and what they have added to the image.
class BootstrapRun {
 public:
  BootstrapRun(ChainDevice& device, const ChainPlan& plan, MutationWeights weights,
               std::uint64_t pixels)
      : device_(device), plan_(plan), splats_(pixels) {
    step_.weights = weights;
  }

  /// Until `ends()` once the least is there, or until it is cancelled.
  template <class Ends>
  void trace(Ends&& ends, const std::function<bool()>& cancel, RenderRun& run) {
    while (paths_ < plan_.bootstrap && (paths_ == 0 || !ends())) {
      const auto count =
          static_cast<std::uint32_t>(std::min(plan_.bootstrap_batch, plan_.bootstrap - paths_));
      if (!device_.trace_bootstrap(static_cast<std::uint32_t>(paths_), count, run, cancel)) break;
      paths_ += count;
      if (!is_lit()) expect_brightness(run);
      if (is_lit()) device_.splat_bootstrap(count, step_, run);
    }
    splats_.take(device_);
  }

  std::uint32_t paths() const { return static_cast<std::uint32_t>(paths_); }
  const SplatTotals& splats() const { return splats_; }
  const ChainStep& step() const { return step_; }

 private:
  bool is_lit() const { return step_.scale > 0; }
  /// Batches before the first with light have nothing to add, whatever is expected.
  void expect_brightness(RenderRun& run) {
    double sum = 0;
    for (const TargetSum& group : device_.sum_targets(paths(), run)) sum += group.sum;
    step_.weights.expected = sum / static_cast<double>(paths_);
    step_.scale = sum > 0 ? quanta_per_brightness / step_.weights.expected : 0.0;
  }

  ChainDevice& device_;
  const ChainPlan& plan_;
  std::uint64_t paths_ = 0;
  ChainStep step_{ChainStep::Kind::start, {}, 0.0, 0};
  SplatTotals splats_;
};

/// As sums of so many samples of each pixel; `radiance` is that of [pixel][channel].
template <class Radiance>
void fill_film(Radiance&& radiance, std::uint64_t samples, Film& film) {
  film.pixels.resize(film.window.pixel_count());
  for (std::size_t i = 0; i < film.pixels.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      film.pixels[i].sum[c] = radiance(3 * i + c) * static_cast<double>(samples);
    }
    film.pixels[i].samples = samples;
  }
}

double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

MetropolisStats statistics_of(const ChainStarts& starts, const ChainTally& tally) {
  MetropolisStats stats;
  stats.chains = starts.positions.chains;
  stats.mutations = tally.large + tally.small;
  stats.bootstrap = starts.positions.paths;
  stats.brightness = starts.brightness;
  stats.brightness_error = starts.brightness_error;
  stats.large_share = ratio(tally.large, stats.mutations);
  stats.large_acceptance = ratio(tally.large_accepted, tally.large);
  stats.small_acceptance = ratio(tally.small_accepted, tally.small);
  return stats;
}

/// Twice as many as mutations, within bounds. Where light is hard to find chains seldom leave the
/// path at which they begin, so that many beginnings are worth more than many steps (results/).
std::uint64_t automatic_bootstrap(const ImageSettings& o, const ChainDefaults& defaults,
                                  std::uint64_t pixels, std::uint64_t free_bytes) {
  const std::uint64_t least = defaults.bootstrap;
  const std::uint64_t fitting =
      free_bytes / 8 / Bootstrap::bytes_per_group * Bootstrap::group_paths;
  const std::uint64_t most = std::max(std::min(defaults.bootstrap_most, fitting), least);
  // The number of mutations is not known in advance.
  return o.time_limit > 0 ? most : std::clamp(2 * mutations_of(pixels, o.spp), least, most);
}

}  // namespace

void check_metropolis(const ImageSettings& o, const SceneProperties& scene,
                      const PixelFilter& filter) {
  if (o.integrator != IntegratorKind::mlt) return;
  if (o.rng != RngKind::philox) {
    refuse("--rng " + to_string(o.rng), "a chain's numbers have no state; expected --rng philox");
  }
  if (o.sampler != SamplerKind::independent) {
    refuse("--sampler " + to_string(o.sampler),
           "chains mutate independent numbers; expected --sampler independent");
  }
  if (o.target_error > 0) {
    refuse(fmt::format("--target-error {}", o.target_error),
           "the samples of a chain depend on each other, and their variance tells no error; "
           "expected --spp or --time-limit");
  }
  if (o.aovs != 0) {
    refuse("--aov", "chains visit pixels by their light; render the layers with --integrator path");
  }
  if (filter.has_negative()) {
    refuse("--filter",
           "a filter with negative parts is no density; expected box, tent or gaussian");
  }
  if (scene.has_media) {
    refuse("a scene with media",
           "where a flight ends is no random number that a chain could keep; expected path");
  }
  if (scene.has_masks) {
    refuse("a scene with masks, a far plane or hidden emitters",
           "whether a mask hides is no random number that a chain could keep; "
           "expected materials without an opacity between 0 and 1");
  }
}

ChainPlan plan_chains(const ImageSettings& o, const ChainDefaults& defaults,
                      const FilmMemory& memory) {
  const std::uint64_t pixels = window_of(o).pixel_count();
  ChainPlan plan;
  plan.blocks = std::min(used_blocks(static_cast<std::uint32_t>(o.max_depth)), stored_blocks_max);
  plan.bootstrap =
      o.bootstrap > 0 ? o.bootstrap : automatic_bootstrap(o, defaults, pixels, memory.free_bytes);
  plan.bootstrap_is_timed = o.bootstrap == 0 && o.time_limit > 0;
  plan.bootstrap_batch = std::min(plan.bootstrap, defaults.clock_interval);
  const std::uint64_t film_bytes = pixels * (memory.bytes_per_pixel + 3 * sizeof(SplatSum));
  const std::uint64_t bytes_per_path = memory.bytes_per_path + sizeof(Proposal);
  const std::uint64_t bytes_per_chain = ChainArrays::bytes_per_chain(plan.blocks);
  plan.chains = o.chains;
  if (plan.chains == 0) {
    const std::uint64_t fitting = memory.free_bytes / 4 / (bytes_per_chain + bytes_per_path);
    const std::uint64_t quarter = mutations_of(pixels, o.spp) / 4;
    plan.chains = std::max<std::uint64_t>(std::min({defaults.chains, fitting, quarter}), 1);
  }
  plan.clock_interval =
      static_cast<int>(std::max<std::uint64_t>(defaults.clock_interval / plan.chains, 1));
  const std::uint64_t bytes = film_bytes + plan.batch_paths() * bytes_per_path +
                              plan.chains * bytes_per_chain +
                              Bootstrap::group_count(plan.bootstrap) * Bootstrap::bytes_per_group;
  if (bytes > memory.free_bytes) {
    throw memory_error(memory.name,
                       fmt::format("an image of {} pixels by --chains {} --bootstrap {}", pixels,
                                   plan.chains, plan.bootstrap),
                       bytes, memory.free_bytes);
  }
  return plan;
}

void ChainSums::add(const ChainCounts* counts) {
  for (std::uint32_t i = 0; i < ChainCounts::copies; ++i) {
    steps = steps + counts[i].steps;
    paths = paths + counts[i].paths;
  }
}

ChainStarts choose_starts(const std::vector<TargetSum>& groups, std::uint32_t paths,
                          std::uint32_t chains, double u) {
  ChainStarts starts;
  double sum = 0, squares = 0;
  for (const TargetSum& group : groups) {
    starts.below.push_back(sum);
    sum += group.sum;
    squares += group.squares;
  }
  if (!(sum > 0)) {
    throw Error(
        fmt::format("--integrator mlt: {} bootstrap paths found no light; expected a scene "
                    "that some path of the image finds lit, or more --bootstrap paths",
                    paths));
  }
  const double n = paths;
  starts.brightness = sum / n;
  const double spread = std::max(squares - sum * starts.brightness, 0.0);
  starts.brightness_error = n > 1 ? std::sqrt(spread / (n * (n - 1))) : 0.0;
  starts.positions = {paths, chains, sum, u};
  return starts;
}

RenderRun render_chains(ChainDevice& device, const ChainPlan& plan, const ImageSettings& settings,
                        int samples, const RenderHooks& hooks, Film& film, BatchPace* pace) {
  const Window& w = film.window;
  const std::uint64_t pixels = w.pixel_count();
  const auto chains = static_cast<std::uint32_t>(plan.chains);
  const std::uint64_t iterations = (mutations_of(pixels, samples) + plan.chains - 1) / plan.chains;
  const StopClock clock(hooks.stops);
  device.begin_chains({w.x, w.y, w.width, w.height});

  RenderRun run;
  MutationWeights weights;
  weights.large_step_probability = static_cast<double>(settings.large_step_probability);
  weights.bootstrap_share =
      plan.bootstrap_is_timed
          ? timed_bootstrap_share
          : static_cast<double>(plan.bootstrap) / static_cast<double>(iterations * plan.chains);
  BootstrapRun bootstrap(device, plan, weights, pixels);
  const double bootstrap_s = bootstrap_time_share * hooks.stops.seconds;
  const std::uint64_t in_all = plan.bootstrap + iterations * plan.chains;
  bootstrap.trace(
      [&] {
        const double elapsed = clock.elapsed_s();
        if (hooks.progress) {
          const double done = bootstrap.paths();
          const double ending = elapsed > 0 ? done * hooks.stops.seconds / elapsed : done;
          hooks.progress(bootstrap.paths(),
                         plan.bootstrap_is_timed ? static_cast<std::uint64_t>(ending) : in_all);
        }
        return (plan.bootstrap_is_timed && elapsed >= bootstrap_s) || (hooks.stop && hooks.stop());
      },
      hooks.cancel, run);
  if (bootstrap.paths() == 0) {
    fill_film([](std::size_t) { return 0.0; }, 0, film);
    run.ended_by = RunEnd::interrupted;
    return run;
  }

  Chains names;
  names.seed = settings.seed;
  const ChainStarts starts =
      choose_starts(device.sum_targets(bootstrap.paths(), run), bootstrap.paths(), chains,
                    names.decide(0, bootstrap_iteration).x);
  ChainStep step = bootstrap.step();
  step.blocks = plan.blocks;
  step.weights.brightness = starts.brightness;
  step.scale = quanta_per_brightness / std::max(starts.brightness, step.weights.expected);
  device.start_chains(starts, step, run);
  const double before_ms = run.kernel_ms;

  constexpr std::uint64_t most = std::numeric_limits<int>::max();
  const auto segment = static_cast<int>(std::min(mutations_per_segment / plan.chains, most));
  SplatTotals splats(pixels);
  std::int64_t in_segment = 0;
  const auto take = [&] {
    step.kind = ChainStep::Kind::finish;
    device.finish_chains(chains, step, run);
    splats.take(device);
    in_segment = 0;
  };
  const auto mutate = [&](int first, int count) {
    if (in_segment + count > segment) take();
    step.kind = ChainStep::Kind::mutate;
    device.mutate_chains(chains, step, static_cast<std::uint32_t>(first + count), run);
    in_segment += count;
    return true;
  };
  RenderHooks rest = hooks;
  if (rest.stops.seconds > 0) {
    rest.stops.seconds = std::max(rest.stops.seconds - clock.elapsed_s(), least_seconds);
  }
  if (hooks.progress) {
    rest.progress = [&](std::uint64_t mutated, std::uint64_t wanted) {
      hooks.progress(bootstrap.paths() + mutated, bootstrap.paths() + wanted);
    };
  }
  const BatchRun batches =
      for_each_batch(static_cast<int>(std::min(iterations, most)),
                     std::min(plan.clock_interval, segment), plan.chains, rest, mutate, {}, pace);
  const double mutated_ms = run.kernel_ms - before_ms;
  take();

  const auto done = static_cast<std::uint64_t>(batches.samples) * plan.chains;
  run.ended_by = batches.ended_by;
  // Less than a mutation per pixel is an image, too.
  const std::uint64_t whole = std::max<std::uint64_t>(done / pixels, done > 0 ? 1 : 0);
  run.samples_done = static_cast<int>(std::min<std::uint64_t>(whole, std::uint64_t(samples)));
  run.metropolis = statistics_of(starts, splats.steps());
  run.metropolis->bootstrap_ms = before_ms;
  run.metropolis->mutations_per_s =
      mutated_ms > 0 ? 1e3 * static_cast<double>(done) / mutated_ms : 0;

  const double bootstrap_weight =
      weights.bootstrap_share / (static_cast<double>(bootstrap.paths()) * bootstrap.step().scale);
  const double chains_weight = 1.0 / (static_cast<double>(done) * step.scale);
  const auto radiance = [&](std::size_t i) {  // the mean of a pixel's channel
    return static_cast<double>(pixels) *
           (bootstrap.splats()[i] * bootstrap_weight + splats[i] * chains_weight);
  };
  fill_film(radiance, static_cast<std::uint64_t>(std::max(run.samples_done, 1)), film);
  film.tally = film.tally + splats.paths();
  return run;
}

}  // namespace pt
