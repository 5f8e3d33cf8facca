#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "app/options/option_list.h"
#include "app/render/calibration.h"
#include "app/render/rank_setup.h"
#include "app/render/render_session.h"
#include "app/report/report.h"
#include "common/error/error.h"
#include "common/plan/plan_steps.h"
#include "common/platform/steady_seconds.h"

namespace pt {
namespace {

constexpr double clearly = 0.02;    // faster, as a share of the time: less may be noise
constexpr double turn_loss = 0.03;  // mean share of the time that a turn may lose at most
constexpr int turns = 2;            // of each way, there and back

/// A measurement was stopped, by the clock or by the user.
struct OutOfTime {};

/// Mean share of the time that is lost by taking the first way up to `turn`.
double loss_of(std::span<const TurnPoint> points, double turn) {
  double sum = 0;
  for (const TurnPoint& p : points)
    sum += std::max(0.0, p.x <= turn ? std::log(p.ratio) : -std::log(p.ratio));
  return sum / static_cast<double>(points.size());
}

/// Between two points: where the ratio is 1, if it is there, else in the middle.
double turn_between(const TurnPoint& a, const TurnPoint& b) {
  const double at_a = std::log(a.ratio), at_b = std::log(b.ratio);
  const double share = at_a <= 0 && at_b > 0 ? -at_a / (at_b - at_a) : 0.5;
  return std::floor(a.x * std::pow(b.x / a.x, share));
}

WayOptions operator+(WayOptions options, const WayOptions& more) {
  options.insert(options.end(), more.begin(), more.end());
  return options;
}

WayOptions image(const std::string& scene, int size, int samples, int depth) {
  return {{"scene", scene},
          {"width", std::to_string(size)},
          {"height", std::to_string(size)},
          {"spp", std::to_string(samples)},
          {"max-depth", std::to_string(depth)}};
}

const WayOptions megakernel{{"mode", "megakernel"}}, wavefront{{"mode", "wavefront"}};
const WayOptions scan{{"accel", "brute"}}, tree{{"accel", "bvh2"}};

class Calibrator {
 public:
  using C = PlanConstants;

  Calibrator(const CalibrationTimer& timer, const CalibrationKey& key,
             const DeviceProperties& device)
      : timer_(timer), device_(device) {
    found_.key = key;
  }

  Calibration run() {
    device_.is_cuda ? measure_gpu() : measure_cpu();
    measure_host_builders();
    return std::move(found_);
  }

 private:
  /// The ways in turns; of each the run with the mean time.
  std::vector<WayRun> measure(const std::vector<WayOptions>& ways) {
    std::vector<WayRun> runs(ways.size());
    for (int turn = 0; turn < turns; ++turn) {
      for (std::size_t i = 0; i < ways.size(); ++i) {
        const std::size_t way = turn % 2 == 0 ? i : ways.size() - 1 - i;
        std::optional<WayRun> run;
        if (!timer_.is_over()) run = timer_.render(ways[way]);
        if (!run) throw OutOfTime();
        run->kernel_ms = runs[way].kernel_ms + run->kernel_ms / turns;
        run->build_ms = runs[way].build_ms + run->build_ms / turns;
        runs[way] = *run;
      }
    }
    return runs;
  }

  /// Of the first way's time by the second one's.
  double ratio_of(const WayOptions& common, const WayOptions& a, const WayOptions& b) {
    const std::vector<WayRun> runs = measure({common + a, common + b});
    return runs[0].kernel_ms / runs[1].kernel_ms;
  }

  void keep(PlanConstant constant, const std::string& why) {
    const auto info = std::ranges::find(plan_constant_table, constant, &PlanConstantInfo::value);
    found_.kept.push_back(fmt::format("{}: {}", info->name, why));
  }

  /// Calls fit(), which measures and returns the constant's value or nothing.
  template <class Fit>
  void probe(PlanConstant constant, const char* what, const Fit& fit) {
    if (timer_.says) timer_.says(what);
    try {
      if (const std::optional<double> value = fit())
        set_measured(found_.constants, constant, *value);
      else
        keep(constant, "the times do not tell");
    } catch (const OutOfTime&) {
      keep(constant, "no time was left");
    } catch (const Error& error) {
      keep(constant, error.what());
    }
  }

  /// Megakernel by wavefront.
  void probe_modes(PlanConstant constant, const char* what, const std::vector<WayOptions>& images) {
    probe(constant, what, [&] {
      std::vector<double> ratios;
      for (const WayOptions& one : images) ratios.push_back(ratio_of(one, megakernel, wavefront));
      return fit_ratio(ratios);
    });
  }

  /// `image_of` a size, of which a small one suits the way `a`.
  template <class ImageOf>
  void probe_turn(PlanConstant constant, const char* what, std::initializer_list<int> sizes,
                  const ImageOf& image_of, const WayOptions& a, const WayOptions& b) {
    probe(constant, what, [&] {
      std::vector<TurnPoint> points;
      for (const int size : sizes) points.push_back({double(size), ratio_of(image_of(size), a, b)});
      return fit_turn(points, C().*constant);
    });
  }

  /// The best value of an option; `unit`: of which the constant counts them.
  void probe_size(PlanConstant constant, const char* what, const char* option, double unit,
                  std::initializer_list<double> factors, const std::vector<WayOptions>& images) {
    probe(constant, what, [&]() -> std::optional<double> {
      std::vector<SizePoint> points;
      const double standard = C().*constant;
      for (const double factor : factors) points.push_back({factor * standard, 0});
      for (const WayOptions& one : images) {
        std::vector<WayOptions> ways;
        for (const SizePoint& point : points)
          ways.push_back(one + WayOptions{{option, fmt::format("{:.0f}", point.x * unit)}});
        const std::vector<WayRun> runs = measure(ways);
        double all_ms = 0;  // each image counts as much as another
        for (const WayRun& run : runs) all_ms += run.kernel_ms;
        for (std::size_t i = 0; i < runs.size(); ++i) points[i].ms += runs[i].kernel_ms / all_ms;
      }
      return fit_size(points, standard);
    });
  }

  /// Of the spheres, the ground is one.
  static WayOptions spheres(int count, int size, int samples) {
    return image("spheres", size, samples, 16) + WayOptions{{"spheres", std::to_string(count - 1)}};
  }

  /// Time of a ray by what a device of one unit (a thread, a multiprocessor) would take.
  void probe_rays(PlanConstant constant, int units, const std::vector<WayOptions>& images) {
    probe(constant, "time of a ray", [&]() -> std::optional<double> {
      std::vector<double> seconds;
      for (const WayRun& run : measure(images)) {
        const auto rays = static_cast<double>(run.counts.rays + run.counts.shadow_rays);
        if (rays > 0) seconds.push_back(1e-3 * run.kernel_ms * units / rays);
      }
      if (seconds.empty()) return std::nullopt;
      return spread(std::move(seconds)).median;
    });
  }

  void measure_cpu() {
    const int samples = std::max(device_.threads / 2, 1);
    const auto small = [&](const char* scene) { return image(scene, 128, samples, 8); };
    probe_modes(&C::megakernel_cpu, "megakernel against wavefront",
                {small("spheres"), small("cornell"), small("statue:20K")});
    probe_turn(
        &C::scan_primitives, "scan against tree", {6, 12, 24, 48, 96, 192, 384},
        [&](int count) { return spheres(count, 128, samples); }, scan, tree);
    probe_rays(&C::ray_s_thread, device_.threads, {small("statue:20K"), small("terrain:20K")});
    const int many = 2 * device_.threads;  // larger than the largest pool
    probe_size(&C::pool_thread, "pool", "pool-size", device_.threads, {0.25, 0.5, 1, 2, 4},
               {image("cornell", 128, many, 8) + wavefront,
                image("statue:20K", 128, many, 8) + wavefront});
  }

  void measure_gpu() {
    probe_modes(&C::megakernel_spheres, "megakernel against wavefront: spheres",
                {image("spheres", 512, 4, 16), image("rtow", 512, 4, 16)});
    probe_turn(
        &C::short_depth, "quads, length of paths", {2, 4, 6, 8, 12, 16, 32},
        [](int depth) { return image("cornell", 1024, 4, depth); }, wavefront, megakernel);
    probe_turn(
        &C::few_paths_multiprocessor, "quads, number of paths", {128, 512, 2048, 8192, 32768},
        [&](int paths) {
          return image("cornell", int(std::sqrt(double(paths) * device_.multiprocessors)), 1, 50);
        },
        wavefront, megakernel);
    probe_modes(&C::megakernel_sorting, "many kinds of BSDFs",
                {image("dial:16:0:closed", 1024, 4, 32), image("dial:16:1:closed", 1024, 4, 32)});
    probe_modes(&C::megakernel_mesh, "megakernel against wavefront: triangles",
                {image("statue:100K", 1024, 4, 8), image("boxes", 1024, 4, 8),
                 image("instances:1K", 1024, 1, 8), image("fog", 512, 4, 8)});
    probe_rays(&C::ray_s_multiprocessor, device_.multiprocessors,
               {image("statue:100K", 1024, 4, 8), image("boxes", 1024, 4, 8)});
    probe_turn(
        &C::scan_spheres_wavefront, "scan against tree, waves", {96, 192, 256, 384, 512, 768},
        [](int count) { return spheres(count, 512, 4) + wavefront; }, scan, tree);
    probe_turn(
        &C::scan_spheres_megakernel, "scan against tree, megakernel", {96, 160, 224, 320, 448, 640},
        [](int count) { return spheres(count, 512, 4) + megakernel; }, scan, tree);
    probe_turn(&C::constant_spheres, "constant memory", {24, 48, 64, 96, 128, 256},
               [](int count) { return spheres(count, 512, 4) + megakernel + scan; },
               {{"scene-memory", "constant"}}, {{"scene-memory", "global"}});
    probe_size(&C::finish_lean, "last paths among quads", "finish-paths", 1,
               {1.0 / 16, 0.25, 1, 4, 16}, {image("cornell", 1024, 2, 32) + wavefront});
    probe_size(
        &C::finish_blocks, "last paths by blocks", "finish-paths", 1,
        {1.0 / 64, 1.0 / 16, 0.25, 1, 4},
        {image("statue:100K", 1024, 4, 16) + wavefront, image("boxes", 1024, 4, 16) + wavefront});
  }

  /// The host's threads also build for a GPU. Each render needs another tree than the one before.
  void measure_host_builders() {
    constexpr double triangles = 100'000;
    if (timer_.says) timer_.says("builders");
    const PlanConstant constants[] = {&C::sah_s, &C::reinsert_s, &C::splits_s};
    try {
      const WayOptions one = image("statue:100K", 16, 1, 1);
      const std::vector<WayRun> runs = measure({one + WayOptions{{"builder", "sah"}},
                                                one + WayOptions{{"builder", "sah-reinsert"}},
                                                one + WayOptions{{"builder", "sbvh"}}});
      fit_builders(found_.constants, triangles, device_.host_threads,
                   {1e-3 * runs[0].build_ms, 1e-3 * runs[1].build_ms, 1e-3 * runs[2].build_ms});
      for (const PlanConstant constant : constants)
        if (!is_measured(found_.constants, constant)) keep(constant, "the times do not tell");
    } catch (const OutOfTime&) {
      for (const PlanConstant constant : constants) keep(constant, "no time was left");
    } catch (const Error& error) {
      for (const PlanConstant constant : constants) keep(constant, error.what());
    }
  }

  const CalibrationTimer& timer_;
  const DeviceProperties& device_;
  Calibration found_;
};

/// Renders scene after scene, each loaded once as long as its turns follow each other.
class SessionTimer {
 public:
  explicit SessionTimer(const CalibrationRequest& request)
      : request_(request), end_s_(steady_seconds() + request.limit_s) {}

  bool is_over() const { return request_.stop() || steady_seconds() > end_s_; }

  std::optional<WayRun> render(const WayOptions& options) {
    std::vector<Setting> settings = request_.settings;
    const WayOptions own{{"calibration", "none"}, {"warmup", "1"}, {"repeat", "3"}};
    std::string scene;
    for (const auto& [name, value] : options + own) {
      settings.push_back({&find_option(name), value});
      if (name == "scene" || name == "spheres") scene += value + ' ';
    }
    const RenderCommand command = make_render_command(settings);
    if (!session_ || scene != scene_) {
      session_ = std::make_unique<RenderSession>(command, RenderSession::Warn());
      scene_ = scene;
    }
    MeasureHooks hooks;
    hooks.stop = [this] { return is_over(); };
    return way_run(session_->render(command, hooks, {}));
  }

 private:
  const CalibrationRequest& request_;
  const double end_s_;
  std::unique_ptr<RenderSession> session_;
  std::string scene_;
};

}  // namespace

std::optional<double> fit_turn(std::span<const TurnPoint> points, double standard) {
  std::vector<double> candidates{std::floor(points.front().x / 2)};
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    candidates.push_back(turn_between(points[i], points[i + 1]));
  candidates.push_back(points.back().x);
  const auto loss = [&](double turn) { return loss_of(points, turn); };
  const double best = *std::ranges::min_element(candidates, {}, loss);
  if (loss(best) > turn_loss) return std::nullopt;
  return loss(standard) < loss(best) + clearly / static_cast<double>(points.size()) ? standard
                                                                                    : best;
}

std::optional<double> fit_ratio(std::span<const double> ratios) {
  double sum = 0, lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const double ratio : ratios) {
    const double log = std::log(ratio);
    sum += log, lowest = std::min(lowest, log), highest = std::max(highest, log);
  }
  const double mean = sum / static_cast<double>(ratios.size());
  const bool agree = lowest > -clearly || highest < clearly;
  if (!agree || std::abs(mean) < clearly) return std::nullopt;
  return std::exp(mean);
}

double fit_size(std::span<const SizePoint> points, double standard) {
  const SizePoint best = *std::ranges::min_element(points, {}, &SizePoint::ms);
  const auto usual = std::ranges::find(points, standard, &SizePoint::x);
  const bool is_clear = usual == points.end() || best.ms < (1 - clearly) * usual->ms;
  return is_clear ? best.x : standard;
}

Calibration calibrate(const CalibrationTimer& timer, const CalibrationKey& key,
                      const DeviceProperties& device) {
  return Calibrator(timer, key, device).run();
}

std::optional<Calibration> calibrate(const CalibrationRequest& request) {
  const double begin_s = steady_seconds();
  const RenderCommand command = make_render_command(request.settings);
  Options options = command.options;
  const std::vector<DeviceInfo> devices = choose_render_devices(options, command.given);
  if (devices.size() > 1)
    throw Error(fmt::format("--device {}: a calibration is of one device",
                            find_option("device").text(options)));
  const CalibrationKey key = calibration_key(devices.front(), options);
  (void)writable_calibration_path(key);
  DeviceProperties device = limit_device(devices.front().properties, options.limits);
  device.host_threads = key.threads;
  SessionTimer session(request);
  const CalibrationTimer timer{[&](const WayOptions& way) { return session.render(way); },
                               [&] { return session.is_over(); }, request.says};
  Calibration calibration = calibrate(timer, key, device);
  if (request.stop()) return std::nullopt;
  calibration.seconds = steady_seconds() - begin_s;
  return calibration;
}

std::string calibration_text(const Calibration& calibration) {
  std::string text;
  for (const PlanConstantInfo& info : plan_constant_table) {
    if (!is_measured(calibration.constants, info.value)) continue;
    text += fmt::format("{:<24} {:>9.4g} {:<10} an H200: {:.4g}\n", info.name,
                        calibration.constants.*info.value, info.unit, PlanConstants().*info.value);
  }
  for (const std::string& kept : calibration.kept) text += fmt::format("kept: {}\n", kept);
  return text + fmt::format("measured in {:.1f} s; all other numbers are an H200's\n",
                            calibration.seconds);
}

}  // namespace pt
