// A render in a thread of its own. It goes on while somebody watches, and starts again when its
// camera or its modes change.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "app/render/render_session.h"
#include "view/change_settings.h"

namespace pt {

/// What is rendered. A change starts the render again.
struct LiveSettings {
  std::vector<Mode> modes;  ///< several take turns at the same image
  Orbit orbit;

  bool operator==(const LiveSettings&) const = default;
};

/// What one mode has rendered.
struct LiveView {
  Mode mode{};
  int samples = 0;       ///< per pixel, by the present settings; the image may be of earlier ones
  int pass_samples = 0;  ///< of the last pass
  double pass_ms = 0;    ///< its kernel time
  double msamples_per_s = 0;
  std::uint64_t image_number = 0;      ///< changes with the image; 0: none
  std::shared_ptr<const Image> image;  ///< linear; null: none
};

enum class LiveStatus { rendering, idle, done, failed };

struct LiveState {
  std::uint64_t version = 1;  ///< changes with the state
  LiveSettings settings;
  float exposure = 0;  ///< stops; 0 until a first image was measured, if that was asked for
  LiveStatus status = LiveStatus::idle;
  std::string error;            ///< of LiveStatus::failed
  std::vector<LiveView> views;  ///< one for each of settings.modes
};

/// The render of these settings in `mode`, seen by the scene's own camera. Leaves out what has no
/// effect in that mode. Throws Error for settings that go together in no mode.
RenderCommand mode_command(const std::vector<Setting>& settings, Mode mode);

/// Samples of the next pass: it doubles the samples, but takes at most about 0.2 s and at least one
/// sample. `ms_per_sample` is that of the slowest mode's last pass; 0: unknown.
int next_pass(int done, int wanted, double ms_per_sample);

/// All members but the destructor may be called by any thread.
class LiveRender {
 public:
  using Warn = RenderSession::Warn;

  /// Loads the scene and prepares it for the mode that the settings (of `ptexp view`) name. Renders
  /// nothing before it is watched. Throws Error. `warn` is called by the render's thread, too.
  LiveRender(std::vector<Setting> settings, const Warn& warn);
  LiveRender(const LiveRender&) = delete;
  LiveRender& operator=(const LiveRender&) = delete;
  ~LiveRender();

  void change(const LiveSettings& settings);
  void change_exposure(float stops);  ///< renders nothing
  /// While nobody watches, the render waits; the current pass is abandoned.
  void set_watched(bool is_watched);

  LiveState state() const;
  /// The state as soon as its version is not `version`, or after `seconds`, or when all ends.
  LiveState wait(std::uint64_t version, double seconds) const;
  /// Ends the render for good, and all waits.
  void end();

  // These do not change.
  const std::string& scene() const { return command_.options.scene; }
  const std::string& device() const { return device_; }
  const CameraParameters& camera() const { return camera_; }  ///< at rest
  int samples_wanted() const { return command_.options.spp; }

 private:
  /// A mode at work. Used by the render's thread alone.
  struct Worker {
    RenderCommand command;
    std::unique_ptr<RenderSession> session;
  };
  struct Task;

  void run();
  bool has_work() const;
  Task next_task();
  void arrange_workers(const Task& task);
  RenderPass do_pass(const Task& task);
  void record(const Task& task, RenderPass pass);
  void record(const Task& task, const std::string& error);

  const std::vector<Setting> options_;
  const Warn warn_;
  RenderCommand command_;    ///< of the first mode, with the scene's defaults
  CameraParameters camera_;  ///< at rest
  std::string device_;
  bool measures_exposure_ = false;

  std::vector<Worker> workers_;
  std::uint64_t arranged_ = 0;  ///< number of the settings that they follow

  mutable std::mutex mutex_;                 ///< of all below
  mutable std::condition_variable changed_;  ///< for wait()
  std::condition_variable wake_;             ///< for the render's thread
  LiveState state_;
  bool has_exposure_ = false;
  int target_ = 0;        ///< samples that each view gets before the next pass is planned
  std::size_t last_ = 0;  ///< the view that had its turn
  // Written under the mutex, but read while a batch is traced as well.
  std::atomic<std::uint64_t> number_{1};  ///< of the settings
  std::atomic<bool> is_watched_{false}, ends_{false};

  std::thread thread_;  // last: it uses all others
};

}  // namespace pt
