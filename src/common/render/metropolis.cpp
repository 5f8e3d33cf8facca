#include "common/render/metropolis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/memory_error.h"
#include "common/render/option_names.h"

namespace pt {
namespace {

constexpr std::uint64_t bootstrap_batch_max = std::uint64_t{1} << 20;
/// Longer paths draw the numbers of their last rays afresh: 2 KiB for a chain.
constexpr std::uint32_t stored_blocks_max = 128;
/// Sums are taken from the device after so many mutations: they fit whatever they are. One mutation
/// adds less than 2 b / 0.0722 to a channel, the smallest share of one in luminance: below 2^5 b,
/// all of them in one pixel 2^37 b, or 2^62 quanta.
constexpr std::uint64_t mutations_per_segment = std::uint64_t{1} << 32;
constexpr double quanta_per_brightness = 0x1p25;

std::uint64_t mutations_of(std::uint64_t pixels, int samples) {
  return pixels * static_cast<std::uint64_t>(samples);
}

void refuse(const std::string& option, const std::string& reason) {
  throw Error(fmt::format("{} with --integrator mlt: {}", option, reason));
}

std::vector<Proposal> bootstrap_paths(std::uint64_t first, std::uint64_t count) {
  std::vector<Proposal> proposals(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    proposals[i] = {static_cast<std::uint32_t>(first + i), bootstrap_iteration, 0, 1};
  }
  return proposals;
}

/// Traces the bootstrap paths and returns their targets.
std::vector<float> run_bootstrap(ChainDevice& device, const ChainPlan& plan, RenderRun& run,
                                 PathTally& tally) {
  std::vector<float> targets;
  targets.reserve(plan.bootstrap);
  while (targets.size() < plan.bootstrap) {
    const std::uint64_t count = std::min(plan.bootstrap_batch, plan.bootstrap - targets.size());
    const auto paths = static_cast<std::uint32_t>(count);
    device.set_proposals(bootstrap_paths(targets.size(), count));
    device.run_chains(paths, {}, run);
    for (const Sample& sample : device.read_chain_samples(paths)) {
      const bool finite = count_sample(sample, tally, [&](int bin) { ++tally.lengths[bin]; });
      targets.push_back(finite ? chain_target(sample.radiance) : 0.0f);
    }
  }
  return targets;
}

/// Adds up what chains have added to the device's sums.
class ChainTotals {
 public:
  explicit ChainTotals(std::uint64_t pixels) : quanta_(3 * pixels) {}

  void take(ChainDevice& device, std::uint32_t chains, ChainStep step, RenderRun& run) {
    step.kind = ChainStep::Kind::finish;
    device.run_chains(chains, step, run);
    const ChainSums sums = device.take_chain_sums();
    for (std::size_t i = 0; i < quanta_.size(); ++i) {
      quanta_[i] += static_cast<double>(static_cast<std::int64_t>(sums.sums[i]));
    }
    steps_ = steps_ + sums.steps;
    paths_ = paths_ + sums.paths;
  }

  const ChainTally& steps() const { return steps_; }

  /// As sums of so many samples of each pixel.
  void fill_film(double radiance_per_quantum, std::uint64_t samples, Film& film) const {
    film.pixels.resize(film.window.pixel_count());
    for (std::size_t i = 0; i < film.pixels.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        film.pixels[i].sum[c] =
            quanta_[3 * i + c] * radiance_per_quantum * static_cast<double>(samples);
      }
      film.pixels[i].samples = samples;
    }
    film.tally = film.tally + paths_;
  }

 private:
  std::vector<double> quanta_;
  ChainTally steps_;
  PathTally paths_;
};

double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

MetropolisStats statistics_of(const ChainPlan& plan, const ChainStarts& starts,
                              const ChainTally& tally) {
  MetropolisStats stats;
  stats.chains = plan.chains;
  stats.mutations = tally.large + tally.small;
  stats.bootstrap = plan.bootstrap;
  stats.brightness = starts.brightness;
  stats.brightness_error = starts.brightness_error;
  stats.large_share = ratio(tally.large, stats.mutations);
  stats.large_acceptance = ratio(tally.large_accepted, tally.large);
  stats.small_acceptance = ratio(tally.small_accepted, tally.small);
  return stats;
}

/// Half of the mutations, within bounds. Where light is hard to find chains seldom leave the path
/// at which they begin, so that many beginnings are worth more than many steps (results/).
std::uint64_t automatic_bootstrap(const Options& o, const ChainDefaults& defaults,
                                  std::uint64_t pixels) {
  const std::uint64_t least = defaults.bootstrap;
  if (o.time_limit > 0) return 8 * least;  // nobody knows how many mutations there will be
  return std::clamp(mutations_of(pixels, o.spp) / 2, least, 64 * least);
}

}  // namespace

void check_metropolis(const Options& o, const SceneTraits& traits, const PixelFilter& filter) {
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
  if (o.counters) refuse("--counters", "they are read of a path tracer's batch; expected path");
  if (filter.has_negative()) {
    refuse("--filter",
           "a filter with negative parts is no density; expected box, tent or gaussian");
  }
  if (traits.has_masks) {
    refuse("a scene with masks",
           "whether a mask hides is no random number that a chain could keep; "
           "expected materials without an opacity between 0 and 1");
  }
}

ChainPlan plan_chains(const Options& o, const ChainDefaults& defaults, const FilmMemory& memory) {
  const std::uint64_t pixels = window_of(o).pixel_count();
  ChainPlan plan;
  plan.blocks = std::min(used_blocks(static_cast<std::uint32_t>(o.max_depth)), stored_blocks_max);
  plan.bootstrap = o.bootstrap > 0 ? o.bootstrap : automatic_bootstrap(o, defaults, pixels);
  plan.bootstrap_batch = std::min(plan.bootstrap, bootstrap_batch_max);
  const std::uint64_t film_bytes = pixels * (memory.bytes_per_pixel + 3 * sizeof(SplatSum));
  const std::uint64_t bytes_per_path = memory.bytes_per_path + sizeof(Proposal);
  const std::uint64_t bytes_per_chain = ChainArrays::bytes_per_chain(plan.blocks);
  plan.chains = o.chains;
  if (plan.chains == 0) {
    const std::uint64_t fitting = memory.free_bytes / 4 / (bytes_per_chain + bytes_per_path);
    const std::uint64_t quarter = mutations_of(pixels, o.spp) / 4;
    plan.chains = std::max<std::uint64_t>(std::min({defaults.chains, fitting, quarter}), 1);
  }
  plan.turn = static_cast<int>(std::max<std::uint64_t>(defaults.turn / plan.chains, 1));
  const std::uint64_t bytes =
      film_bytes + plan.batch_paths() * bytes_per_path + plan.chains * bytes_per_chain;
  if (bytes > memory.free_bytes) {
    throw memory_error(memory.name,
                       fmt::format("an image of {} pixels by --chains {} --bootstrap {}", pixels,
                                   plan.chains, plan.bootstrap),
                       bytes, memory.free_bytes);
  }
  return plan;
}

void ChainSums::add(const ChainCounts* counts) {
  for (std::uint32_t i = 0; i < ChainCounts::places; ++i) {
    steps = steps + counts[i].steps;
    paths = paths + counts[i].paths;
  }
}

ChainStarts choose_starts(const std::vector<float>& targets, std::uint64_t chains, double u) {
  const auto n = static_cast<double>(targets.size());
  double sum = 0, squares = 0;
  for (const float target : targets) sum += target;
  if (!(sum > 0)) {
    throw Error(
        fmt::format("--integrator mlt: {} bootstrap paths found no light; expected a scene "
                    "that some path of the image finds lit, or more --bootstrap paths",
                    targets.size()));
  }
  ChainStarts starts;
  starts.brightness = sum / n;
  for (const float target : targets) {
    squares += (target - starts.brightness) * (target - starts.brightness);
  }
  starts.brightness_error = n > 1 ? std::sqrt(squares / (n * (n - 1))) : 0.0;
  starts.paths.reserve(chains);
  double below = 0;  // the targets of the paths before this one
  std::size_t path = 0, last = 0;
  for (std::uint64_t chain = 0; chain < chains; ++chain) {
    const double place = (static_cast<double>(chain) + u) / static_cast<double>(chains) * sum;
    while (path < targets.size() && below + targets[path] <= place) {
      below += targets[path++];
    }
    // The last step may be lost to rounding; a path without light has no part of the sum.
    if (path < targets.size()) last = path;
    starts.paths.push_back(static_cast<std::uint32_t>(last));
  }
  return starts;
}

RenderRun render_chains(ChainDevice& device, const ChainPlan& plan, const Options& options,
                        int samples, const RenderHooks& hooks, Film& film) {
  const Window& w = film.window;
  const std::uint64_t pixels = w.pixel_count();
  const std::uint64_t iterations = (mutations_of(pixels, samples) + plan.chains - 1) / plan.chains;
  const ChainWindow window{w.x, w.y, w.width, w.height};
  device.begin_chains(window);

  RenderRun run;
  const std::vector<float> targets = run_bootstrap(device, plan, run, film.tally);
  Chains names;
  names.seed = options.seed;
  const double u = names.decide(0, bootstrap_iteration).x;
  const ChainStarts starts = choose_starts(targets, plan.chains, u);
  std::vector<Proposal> proposals;
  for (const std::uint32_t path : starts.paths) {
    proposals.push_back({path, bootstrap_iteration, 0, 1});
  }
  device.set_proposals(proposals);
  const auto chains = static_cast<std::uint32_t>(plan.chains);
  ChainStep step{ChainStep::Kind::start,
                 {starts.brightness, static_cast<double>(options.large_step_probability)},
                 quanta_per_brightness / starts.brightness,
                 plan.blocks};
  device.run_chains(chains, step, run);
  const double before_ms = run.kernel_ms;

  step.kind = ChainStep::Kind::mutate;
  constexpr std::uint64_t most = std::numeric_limits<int>::max();
  const auto segment = static_cast<int>(std::min(mutations_per_segment / plan.chains, most));
  ChainTotals totals(pixels);
  std::int64_t in_segment = 0;
  const auto mutate = [&](int first, int count) {
    if (in_segment + count > segment) {
      totals.take(device, chains, step, run);
      in_segment = 0;
    }
    device.mutate_chains(chains, step, static_cast<std::uint32_t>(first + count), run);
    in_segment += count;
  };
  const BatchRun batches = for_each_batch(static_cast<int>(std::min(iterations, most)),
                                          std::min(plan.turn, segment), plan.chains, hooks, mutate);
  const double mutated_ms = run.kernel_ms - before_ms;
  totals.take(device, chains, step, run);

  const auto done = static_cast<std::uint64_t>(batches.samples) * plan.chains;
  run.ended_by = batches.ended_by;
  // Less than a mutation per pixel is an image, too.
  const std::uint64_t whole = std::max<std::uint64_t>(done / pixels, done > 0 ? 1 : 0);
  run.samples_done = static_cast<int>(std::min<std::uint64_t>(whole, std::uint64_t(samples)));
  run.metropolis = statistics_of(plan, starts, totals.steps());
  run.metropolis->bootstrap_ms = before_ms;
  run.metropolis->mutations_per_s =
      mutated_ms > 0 ? 1e3 * static_cast<double>(done) / mutated_ms : 0;
  const double per_quantum = static_cast<double>(pixels) / (static_cast<double>(done) * step.scale);
  totals.fill_film(per_quantum, static_cast<std::uint64_t>(std::max(run.samples_done, 1)), film);
  return run;
}

}  // namespace pt
