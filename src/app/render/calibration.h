// What `ptexp calibrate` finds out: which of the plan's constants (plan/plan_constants.h) are other
// ones on this device. Measuring and fitting are calibrate.cpp, the file in the user's cache folder
// that later runs read is calibration_file.cpp.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/render/advise.h"
#include "app/render/make_renderer.h"
#include "common/device/devices.h"
#include "common/plan/plan_constants.h"

namespace pt {

class Ranks;

/// What a calibration belongs to.
struct CalibrationKey {
  std::string device;       ///< "NVIDIA H200"; of a CPU its model
  int multiprocessors = 0;  ///< as the plan sees them; 0: a CPU
  int threads = 1;          ///< of the host, which build, and on a CPU also render
  std::string driver;       ///< DeviceInfo::driver
  std::string version;      ///< of this program

  bool operator==(const CalibrationKey&) const = default;
};

/// By --threads and --sms of the options.
CalibrationKey calibration_key(const DeviceInfo& device, const Options& options);

/// $XDG_CACHE_HOME/ptexp/calibration-KEY.json, or below ~/.cache; empty: there is no such folder.
std::string calibration_path(const CalibrationKey& key);

struct Calibration {
  CalibrationKey key;
  PlanConstants constants;
  std::vector<std::string> kept{};  ///< why constants keep their defaults, a line each
  double seconds = 0;               ///< that measuring took
};

/// The same, made ready: its folder is there. Throws Error where nothing can be written.
std::string writable_calibration_path(const CalibrationKey& key);

/// Replaces the file in the cache folder at once; returns its name. Throws Error.
std::string store_calibration(const Calibration& calibration);

/// The constants have the file's hash. Throws Error that names the file, for one that is broken.
Calibration read_calibration(const std::string& file);

/// Gives the devices the constants that the options name. A file in the cache folder that is broken
/// or of something else is ignored, and `warn` told so once in a process. Throws Error for a file
/// that the options name.
void apply_calibration(const Options& options, std::vector<DeviceInfo>& devices, const Warn& warn);

/// Finds the devices of a render and gives them these constants: choose_render_devices
/// (rank_setup.h), then apply_calibration.
std::vector<DeviceInfo> calibrated_devices(Options& options, const GivenOptions& given,
                                           const Warn& warn, const Ranks* ranks = nullptr);

// Fitting. Each returns nothing where the times do not tell.

/// Two ways for one size of work.
struct TurnPoint {
  double x;      ///< the size
  double ratio;  ///< time of the way for small sizes by that of the other one
};

/// The largest size for which the first way is the faster one, of points in order: the turn that
/// loses least. `standard` where that loses as little. Nothing: a wrong side would be taken
/// wherever the turn is.
std::optional<double> fit_turn(std::span<const TurnPoint> points, double standard);

/// The mean ratio of several scenes. Nothing: scenes differ in which way is the faster one, or the
/// ways are as fast.
std::optional<double> fit_ratio(std::span<const double> ratios);

struct SizePoint {
  double x;
  double ms;
};

/// The size with the least time; `standard`, one of the points, unless another is clearly faster.
double fit_size(std::span<const SizePoint> points, double standard);

// Measuring.

/// How renders are timed: with a warm-up, the median of repeats. Tests have planted times. The
/// options name the scene, too. Throws Error for ways that do not exist.
struct CalibrationTimer {
  /// Empty: interrupted, or out of time.
  std::function<std::optional<WayRun>(const WayOptions& options)> render;
  std::function<bool()> is_over;                      ///< no time is left
  std::function<void(const std::string& what)> says;  ///< told what is measured; may be empty
};

/// Measures what it has time for, the most important constants first.
Calibration calibrate(const CalibrationTimer& timer, const CalibrationKey& key,
                      const DeviceProperties& device);

struct CalibrationRequest {
  std::vector<Setting> settings;  ///< which device, how many threads
  double limit_s = 30;
  std::function<bool()> stop;  ///< true ends it
  std::function<void(const std::string& what)> says;
};

/// The same by rendering. Empty if `stop` ended it. Throws Error, also, before it begins, where the
/// result could not be stored.
std::optional<Calibration> calibrate(const CalibrationRequest& request);

/// A line for each constant: its value here and by default, or why it keeps that.
std::string calibration_text(const Calibration& calibration);

}  // namespace pt
