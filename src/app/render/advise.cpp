#include "app/render/advise.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "app/options/option_list.h"
#include "app/render/render_session.h"
#include "app/report/report.h"
#include "common/error/error.h"
#include "common/options/option_names.h"
#include "common/platform/steady_seconds.h"

namespace pt {
namespace {

/// Options whose values `auto` chooses by rules, and which keep the image.
constexpr std::array switches = {"accel", "kernel", "stages", "order-surfaces", "builder"};
constexpr double same = 0.02;         // as scripts/report has it
constexpr double worth_trying = 1.5;  // times the fastest mode's time, for a mode's switches
constexpr double worth_turns = 1.3;   // times the fastest way's time, for measuring in turns
constexpr std::size_t most_ways = 5;  // in turns, with the default
constexpr int rounds_min = 5, rounds_max = 15;
constexpr double render_share = 1.0 / 120;  // of the time, for one render
constexpr double turn_s = 0.05;             // short renders are repeated in their turn
constexpr double long_s = 0.5;              // longer renders need no warm-up
constexpr int turn_renders_max = 10;

double median(std::vector<double> values) { return spread(std::move(values)).median; }

/// Of 95 %, by bootstrap; unknown of too few values.
std::pair<double, double> interval_of_median(const std::vector<double>& values) {
  if (values.size() < 3) return {0.0, std::numeric_limits<double>::infinity()};
  std::vector<double> drawn;
  return bootstrap_interval(values.size(), 4000, [&](std::span<const std::size_t> indices) {
    drawn.clear();
    for (const std::size_t i : indices) drawn.push_back(values[i]);
    return median(drawn);
  });
}

std::string decided(const std::vector<Decision>& plan, const std::string& option) {
  const auto found = std::ranges::find(plan, option, &Decision::option);
  return found == plan.end() ? "" : found->value;
}

/// The values that an option's help lists, less `auto`.
std::vector<std::string> values_of(const std::string& option) {
  std::vector<std::string> values;
  std::string rest = find_option(option).placeholder + '|';
  for (std::size_t end; (end = rest.find('|')) != std::string::npos; rest.erase(0, end + 1))
    if (const std::string value = rest.substr(0, end); value != "auto") values.push_back(value);
  return values;
}

/// The mode's fastest way, or null.
template <class AnyAdvice>  // const or not
auto* fastest_of(AnyAdvice& advice, const std::string& mode) {
  const auto found = std::ranges::find(advice.ways, mode, &AdvisedWay::mode);
  auto* const other = found == advice.ways.end() ? nullptr : &*found;
  const bool is_standard = advice.standard.mode == mode && (other == nullptr || other->ratio <= 1);
  return is_standard ? &advice.standard : other;
}

class Advisor {
 public:
  Advisor(const WayMeasurer& measurer, int spp, const GivenOptions& given, double limit_s)
      : measurer_(measurer), given_(given), begin_s_(measurer.clock_s()), limit_s_(limit_s) {
    advice_.wanted_samples = spp;
  }

  std::optional<Advice> run() {
    const std::vector<Decision> plan = measurer_.plan({});
    if (!given_.contains("mode"))
      advice_.why = std::ranges::find(plan, "mode", &Decision::option)->reason;
    if (!choose_work(plan) || !try_way({})) return std::nullopt;
    try_modes(decided(plan, "mode"));
    try_switches();
    keep_the_fastest();
    while (advice_.rounds < rounds_max && !is_settled() && take_turns()) advice_.rounds++;
    judge();
    if (advice_.standard.run.is_on_gpu) count_hardware();
    advice_.tried = static_cast<int>(plans_.size());
    advice_.seconds = measurer_.clock_s() - begin_s_;
    return std::move(advice_);
  }

 private:
  struct Trial {
    WayOptions options;   ///< what the advice names
    WayOptions measured;  ///< with what `auto` would decide otherwise for fewer samples
    std::string mode;
    std::vector<double> total_ms;  ///< of each round
    WayRun run;
    double first_ms = 0;  ///< total time of the first try
  };

  double left_s() const { return limit_s_ - (measurer_.clock_s() - begin_s_); }

  /// So many samples that a render takes a small share of the time, or a smaller image with one:
  /// more tell nothing new, since time grows with samples once they fill the device.
  bool choose_work(const std::vector<Decision>& plan) {
    const std::optional<WayRun> one = measurer_.render(as_planned({}, plan), {1, 1}, true, false);
    if (!one) return false;
    const double fitting = 1e3 * limit_s_ * render_share / std::max(one->wall_ms, 1e-6);
    advice_.work.samples =
        static_cast<int>(std::clamp(fitting, 1.0, static_cast<double>(advice_.wanted_samples)));
    advice_.work.scale = std::sqrt(std::min(fitting, 1.0));
    return true;
  }

  /// Mode and builder depend on the number of samples, so they are those of all samples.
  WayOptions as_planned(const WayOptions& options, const std::vector<Decision>& plan) const {
    WayOptions fixed = options;
    for (const char* name : {"mode", "builder"}) {
      const std::string value = decided(plan, name);
      const bool is_free =
          !given_.contains(name) &&
          std::ranges::find(options, name, &WayOptions::value_type::first) == options.end();
      if (is_free && !value.empty()) fixed.emplace_back(name, value);
    }
    return fixed;
  }

  /// The time that all samples would take.
  double total_ms(const WayRun& run) const {
    const double share =
        advice_.work.samples * advice_.work.scale * advice_.work.scale / advice_.wanted_samples;
    return run.build_ms + run.kernel_ms / share;
  }

  /// A way that takes many times as long as the fastest is given up.
  WayWork work_of_try() const {
    WayWork work = advice_.work;
    for (const Trial& trial : trials_) {
      const double allowed_s = 1e-3 * (8 * trial.run.wall_ms + 8 * trial.run.build_ms) + 0.5;
      work.limit_s = std::min(work.limit_s, allowed_s);
    }
    return work;
  }

  /// False if there is no such way, it equals another one, or takes too long.
  bool try_way(const WayOptions& options) {
    Trial trial;
    trial.options = options;
    try {
      const std::vector<Decision> plan = measurer_.plan(options);
      std::string values;
      for (const Decision& decision : plan) values += decision.option + ' ' + decision.value + '\n';
      if (plans_.contains(values)) return false;
      trial.measured = as_planned(options, plan);
      trial.mode = decided(plan, "mode");
      const bool is_short = trials_.empty() || 1e-3 * trials_.front().run.wall_ms < long_s;
      const auto run = measurer_.render(trial.measured, work_of_try(), is_short, false);
      if (!run) return false;
      plans_.insert(values);
      trial.run = *run;
      trial.first_ms = total_ms(*run);
    } catch (const Error&) {
      if (trials_.empty()) throw;
      return false;
    }
    trials_.push_back(std::move(trial));
    return true;
  }

  void try_modes(const std::string& chosen) {
    if (given_.contains("mode")) return;
    for (const char* mode : {"wavefront", "megakernel"})
      if (mode != chosen) try_way({{"mode", mode}});
  }

  double fastest_ms() const {
    return std::ranges::min_element(trials_, {}, &Trial::first_ms)->first_ms;
  }

  /// Each switch alone, beside the mode.
  void try_switches() {
    std::vector<Trial> modes = trials_;
    std::ranges::sort(modes, {}, &Trial::first_ms);
    for (const Trial& mode : modes) {
      if (mode.first_ms > worth_trying * fastest_ms()) continue;
      for (const char* name : switches) {
        if (given_.contains(name)) continue;
        for (const std::string& value : values_of(name)) {
          // Where there is a tree, all primitives are too many.
          if (value == "brute" && mode.run.build_ms > 0) continue;
          WayOptions options = mode.options;
          options.emplace_back(name, value);
          // Half of the time is for turns; each builds the trees that differ.
          const double expected_s = 1e-3 * (2 * mode.run.build_ms + 2 * mode.run.wall_ms);
          if (left_s() - expected_s < limit_s_ / 2) continue;
          try_way(options);
        }
      }
    }
  }

  /// The default first, and with it the fastest way of each mode.
  void keep_the_fastest() {
    const double limit_ms = worth_turns * fastest_ms();
    std::ranges::stable_sort(trials_.begin() + 1, trials_.end(), {}, &Trial::first_ms);
    std::vector<Trial> kept = {std::move(trials_.front())};
    for (auto trial = trials_.begin() + 1; trial != trials_.end(); ++trial) {
      const bool is_first_of_mode =
          std::ranges::find(kept, trial->mode, &Trial::mode) == kept.end();
      if (is_first_of_mode || (trial->first_ms <= limit_ms && kept.size() < most_ways))
        kept.push_back(std::move(*trial));
    }
    trials_ = std::move(kept);
  }

  /// A turn for each, there and back, so that a steady drift of the device's speed counts for none.
  /// False: there was no time for all.
  bool take_turns() {
    std::vector<Trial*> order;
    for (Trial& trial : trials_) order.push_back(&trial);
    order.insert(order.end(), order.rbegin(), order.rend());
    std::map<Trial*, double> sums_ms;
    for (Trial* trial : order) {
      const std::optional<double> ms = take_turn(*trial);
      if (!ms) return false;
      sums_ms[trial] += *ms;
    }
    for (Trial& trial : trials_) trial.total_ms.push_back(sums_ms[&trial] / 2);
    return true;
  }

  std::optional<double> take_turn(Trial& trial) {
    const double render_s = 1e-3 * trial.run.wall_ms;
    const bool is_short = render_s < long_s;
    const int renders = static_cast<int>(
        std::clamp(turn_s / std::max(render_s, 1e-6), 1.0, double{turn_renders_max}));
    if (left_s() < render_s * (renders + is_short) + 1e-3 * trial.run.build_ms) return std::nullopt;
    std::vector<double> times_ms;
    for (int i = 0; i < renders; ++i) {
      const auto run = measurer_.render(trial.measured, advice_.work, is_short && i == 0, false);
      if (!run) return std::nullopt;
      trial.run = *run;
      times_ms.push_back(total_ms(*run));
    }
    return median(times_ms);
  }

  std::vector<double> ratios(const Trial& trial) const {
    std::vector<double> values;
    for (std::size_t round = 0; round < trial.total_ms.size(); ++round)
      values.push_back(trials_.front().total_ms[round] / trial.total_ms[round]);
    return values;
  }

  bool is_settled() const {
    return trials_.size() == 1 ||
           (advice_.rounds >= rounds_min && std::ranges::all_of(trials_, [&](const Trial& trial) {
              const auto [low, high] = interval_of_median(ratios(trial));
              return high - low < 0.01 || high < 1 - 2 * same;
            }));
  }

  AdvisedWay judged(const Trial& trial) const {
    AdvisedWay way{.options = trial.options, .mode = trial.mode, .run = trial.run};
    const bool has_rounds = !trial.total_ms.empty();
    way.total_ms = has_rounds ? median(trial.total_ms) : trial.first_ms;
    way.ratio = has_rounds ? median(ratios(trial)) : trials_.front().first_ms / trial.first_ms;
    std::tie(way.low, way.high) = interval_of_median(ratios(trial));
    way.word = way.low > 1                                   ? "faster"
               : way.high < 1                                ? "slower"
               : way.high - 1 <= same && 1 - way.low <= same ? "same"
                                                             : "ambiguous";
    return way;
  }

  void judge() {
    for (const Trial& trial : trials_) advice_.ways.push_back(judged(trial));
    advice_.standard = advice_.ways.front();
    advice_.standard.low = advice_.standard.high = 1;
    advice_.standard.word = "same";
    advice_.ways.erase(advice_.ways.begin());
    std::ranges::sort(advice_.ways, std::greater(), &AdvisedWay::ratio);
  }

  /// Of the fastest way of each mode.
  void count_hardware() {
    for (const char* mode : {"wavefront", "megakernel"}) {
      AdvisedWay* const way = fastest_of(advice_, mode);
      if (way == nullptr) continue;
      const auto trial = std::ranges::find(trials_, way->options, &Trial::options);
      const auto run = measurer_.render(trial->measured, advice_.work, false, true);
      if (run) way->run.counters = run->counters;
    }
  }

  const WayMeasurer& measurer_;
  const GivenOptions& given_;
  const double begin_s_, limit_s_;
  std::set<std::string> plans_;  ///< of all ways that were tried
  std::vector<Trial> trials_;    ///< the default first
  Advice advice_;
};

/// "intersect 46 %, shade_surface 30 %, shadow 12 %"
std::string shares_text(std::vector<StageTime> stages) {
  double sum_ms = 0;
  for (const StageTime& stage : stages) sum_ms += stage.time_ms;
  std::ranges::sort(stages, std::greater(), &StageTime::time_ms);
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(stages.size(), 3); ++i) {
    const double percent = 100 * stages[i].time_ms / sum_ms;
    if (percent >= 1)
      text += fmt::format("{}{} {:.0f} %", text.empty() ? "" : ", ", stages[i].stage, percent);
  }
  return text;
}

std::string counters_text(const WayRun& run) {
  if (!run.counters || run.counters->launches.empty()) return "";
  const CounterRatios ratios =
      ratios_of(sum_all(run.counters->launches).values, run.counters->warps_per_sm);
  return fmt::format("{:.1f} of 32 threads per instruction", ratios.threads_per_instruction);
}

/// Where the time of each mode's fastest way goes.
std::string modes_text(const Advice& advice) {
  std::string text;
  for (const char* mode : {"wavefront", "megakernel", "serial"}) {
    const AdvisedWay* const way = fastest_of(advice, mode);
    if (way == nullptr) continue;
    const std::string counters = counters_text(way->run);
    text += fmt::format("  {}: {}{}{}\n", mode, shares_text(way->run.stages),
                        counters.empty() ? "" : "; ", counters);
  }
  return text;
}

/// The image and its window at `scale` of their size.
void shrink(Options& options, double scale) {
  const auto pixels = [&](int all) { return static_cast<int>(std::lround(all * scale)); };
  options.width = std::max(pixels(options.width), 1);
  options.height = std::max(pixels(options.height), 1);
  if (!options.crop) return;
  CropWindow& crop = *options.crop;
  crop = {pixels(crop.x0), pixels(crop.y0), pixels(crop.x1), pixels(crop.y1)};
  crop.x0 = std::min(crop.x0, options.width - 1), crop.y0 = std::min(crop.y0, options.height - 1);
  crop.x1 = std::max(crop.x1, crop.x0 + 1), crop.y1 = std::max(crop.y1, crop.y0 + 1);
}

}  // namespace

std::optional<WayRun> way_run(const RenderResult& result) {
  if (result.interrupted || !result.has_image) return std::nullopt;
  const RenderReport& report = result.report;
  const RenderRun& run = report.runs.back();
  return WayRun{.kernel_ms = summarize(report).kernel_ms.median,
                .wall_ms = run.wall_ms,
                .build_ms = report.scene.tree.build_ms,
                .stages = run.stages,
                .counts = report.counts,
                .device = report.device_name,
                .is_on_gpu = report.device_kind == "cuda",
                .counters = report.counters};
}

const AdvisedWay& Advice::best() const {
  const bool is_better = !ways.empty() && ways.front().low > 1 && ways.front().ratio > 1 + same;
  return is_better ? ways.front() : standard;
}

std::optional<Advice> advise(const WayMeasurer& measurer, int spp, const GivenOptions& given,
                             double limit_s) {
  return Advisor(measurer, spp, given, limit_s).run();
}

std::optional<Advice> advise(RenderSession& session, const AdviceRequest& request) {
  const auto command_of = [&](const WayOptions& options) {
    std::vector<Setting> settings = request.settings;
    for (const auto& [name, value] : options) settings.push_back({&find_option(name), value});
    return make_render_command(settings);
  };
  const double begin_s = steady_seconds();
  WayMeasurer measurer;
  measurer.clock_s = steady_seconds;
  measurer.plan = [&](const WayOptions& options) { return session.plan(command_of(options)); };
  measurer.render = [&](const WayOptions& options, const WayWork& work, bool warms_up,
                        bool counts) -> std::optional<WayRun> {
    RenderCommand command = command_of(options);
    apply_defaults(session.scene().defaults, command.given, command.options);
    command.options.spp = work.samples;
    shrink(command.options, work.scale);
    for (const char* name : {"width", "height", "spp"}) command.given.insert(name);
    command.options.warmup = warms_up ? 1 : 0;
    command.options.counters = counts;
    if (request.says) request.says(way_text(options));
    MeasureHooks hooks;
    const double end_s = std::min(begin_s + request.limit_s, steady_seconds() + work.limit_s);
    hooks.stop = [&] { return request.stop() || steady_seconds() > end_s; };
    return way_run(session.render(command, hooks, {}));
  };
  RenderCommand user = command_of({});
  apply_defaults(session.scene().defaults, user.given, user.options);
  std::optional<Advice> advice = advise(measurer, user.options.spp, user.given, request.limit_s);
  if (request.stop()) return std::nullopt;
  return advice;
}

std::string way_text(const WayOptions& options) {
  std::string text;
  for (const auto& [name, value] : options)
    text += fmt::format("{}--{} {}", text.empty() ? "" : " ", name, value);
  return text.empty() ? "the default" : text;
}

std::string advice_text(const Advice& advice) {
  const AdvisedWay &best = advice.best(), &standard = advice.standard;
  std::string text = standard.run.device + ": use ";
  if (&best == &standard)
    text += fmt::format("the default; no way that was tried is faster than {}\n", standard.mode);
  else
    text += fmt::format("{}, {:.2f} times as fast as the default\n", way_text(best.options),
                        best.ratio);
  const auto row = [&](const std::string& name, double ms) {
    text += fmt::format("  {:<40} {:>8} ms", name,
                        ms < 1000 ? fmt::format("{:.4g}", ms) : fmt::format("{:.0f}", ms));
  };
  row("the default (" + standard.mode + ")", standard.total_ms);
  text += '\n';
  for (std::size_t i = 0; i < std::min<std::size_t>(advice.ways.size(), 3); ++i) {
    const AdvisedWay& way = advice.ways[i];
    row(way_text(way.options), way.total_ms);
    text += fmt::format(", {:.2f} times as fast", way.ratio);
    if (way.low > 0) text += fmt::format(" [{:.2f}, {:.2f}]", way.low, way.high);
    text += ": " + way.word + '\n';
  }
  text += fmt::format("Times of {} samples with the tree", advice.wanted_samples);
  if (advice.work.samples < advice.wanted_samples)
    text += fmt::format(", rendered with {}", advice.work.samples);
  if (advice.work.scale < 1)
    text += fmt::format(" at {:.0f} % of the size", 100 * advice.work.scale);
  text += fmt::format("; {} ways tried, {} in {} rounds; {:.0f} s; intervals of 95 %.\n",
                      advice.tried, advice.ways.size() + 1, advice.rounds, advice.seconds);
  if (!advice.why.empty())
    text += fmt::format("Why auto chose {}: {}.\n", standard.mode, advice.why);
  const PathCounts& counts = standard.run.counts;
  if (counts.paths > 0) {
    const double paths = static_cast<double>(counts.paths);
    text += fmt::format("{:.1f} rays and {:.1f} shadow rays per path. Time by kernel:\n",
                        static_cast<double>(counts.rays) / paths,
                        static_cast<double>(counts.shadow_rays) / paths);
  }
  return text + modes_text(advice);
}

}  // namespace pt
