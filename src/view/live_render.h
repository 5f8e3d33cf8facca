// A render in a thread of its own. It goes on while somebody watches, and starts again when its
// camera, its modes, its size or the scene's parameters change.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "app/render/render_session.h"
#include "common/scene/edit/scene_parameters.h"
#include "view/change_settings.h"

namespace pt {

/// What is rendered. A change starts the render again.
struct LiveSettings {
  std::vector<Mode> modes;  ///< several take turns at the same image
  Orbit orbit;
  ImageSize size{};              ///< before `scale`; {0, 0}: the first one
  double scale = 1;              ///< scale_min to scale_max
  std::optional<float> time{};   ///< seconds: what moves stands as it is then
  ParameterValues parameters{};  ///< those that are not as the scene has them

  bool operator==(const LiveSettings&) const = default;
};

/// What one mode has rendered.
struct LiveView {
  Mode mode{};
  int samples = 0;       ///< per pixel, by the present settings; the image may be of earlier ones
  int pass_samples = 0;  ///< of the last pass
  double pass_ms = 0;    ///< its kernel time
  double msamples_per_s = 0;
  // Of all passes by the present settings:
  double kernel_ms = 0, wall_ms = 0;
  std::vector<StageTime> stages{};
  std::optional<double> relative_error{};  ///< (pixel_statistics.h); none before two samples

  Decision decision{};                   ///< the mode that `mode` means, and why
  std::uint64_t image_number = 0;        ///< changes with the image; 0: none
  std::shared_ptr<const Image> image{};  ///< linear; null: none
  LiveSettings image_settings{};
  int image_samples = 0;
};

/// How many times as long as the second of two modes the first one takes for the same samples.
struct TimeRatio {
  double value = 0;
  double low = 0, high = 0;  ///< an interval of 95 %, by bootstrap over the rounds
  std::size_t rounds = 0;
};

/// Milliseconds of each mode for the samples of one round.
using Round = std::array<double, 2>;

/// The ratio of the sums. None for fewer than `rounds_min` rounds.
std::optional<TimeRatio> time_ratio(std::span<const Round> rounds);
inline constexpr std::size_t rounds_min = 5;

enum class LiveStatus { rendering, idle, paused, done, failed };

struct LiveState {
  std::uint64_t version = 1;  ///< changes with the state
  LiveSettings settings;
  int spp = 0;      ///< samples that are wanted
  Display display;  ///< its exposure is 0 until a first image was measured, if that was asked for
  bool is_paused = false;
  std::optional<TimeRatio> ratio{};  ///< of two modes
  LiveStatus status = LiveStatus::idle;
  std::string error;            ///< of LiveStatus::failed
  std::vector<LiveView> views;  ///< one for each of settings.modes
};

/// A parameter of a material or a light.
struct LiveParameter {
  SceneParameter parameter;
  std::vector<float> value;  ///< in the scene as it was loaded
};

/// A scene of more materials can be edited in its sky alone: no page could list them.
inline constexpr std::size_t editable_materials_max = 4096;

/// The render of these settings in `mode`, seen by the scene's own camera. Leaves out what has no
/// effect in that mode. Throws Error for settings that go together in no mode.
RenderCommand mode_command(const std::vector<Setting>& settings, Mode mode);

/// Samples of the next pass: it doubles the samples, but takes at most about 0.2 s and at least one
/// sample. `ms_per_sample` is that of the slowest mode's last pass; 0: unknown.
int next_pass(int done, int wanted, double ms_per_sample);

/// The width of an image of a scene that sets none: `size`'s, or less where the scene ends at both
/// sides of it and nothing is behind, but not less than the height.
int width_without_bars(const SceneData& scene, const CameraParameters& camera,
                       const ImageSize& size);

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

  /// Throws Error for parameters that the scene does not have, or values that it cannot have.
  void change(LiveSettings settings);
  /// Takes the change's layer, exposure and curve; renders only what the layer lacks.
  void change_display(const SettingsChange& change);
  /// The samples that are there already stay, unless they depend on that number.
  void change_samples(int spp);
  void set_paused(bool is_paused);
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
  const CameraParameters& camera() const { return camera_; }          ///< at rest
  const std::optional<Shutter>& shutter() const { return shutter_; }  ///< none: nothing moves
  const std::vector<LiveParameter>& parameters() const { return parameters_; }

  /// The header of a file of the view's image: its options, by which ptexp renders it again; or
  /// what the page has changed beyond them.
  ImageMetadata header_of(const LiveView& view) const;

 private:
  /// A mode at work. Used by the render's thread alone.
  struct Worker {
    RenderCommand command;
    std::unique_ptr<RenderSession> session;
    Decision decision;
  };
  struct Task;
  struct Result;

  void run();
  bool has_work() const;
  void begin_anew();
  void check_parameters(ParameterValues& values);
  RenderCommand command_of(const LiveSettings& settings, Mode mode) const;
  Task next_task();
  void arrange_workers(const Task& task);
  void edit_scenes(const ParameterValues& values);
  Result do_pass(const Task& task);
  void record(const Task& task, Result result);
  void add_round(const Task& task, double pass_ms);
  void record(const Task& task, const std::string& error);

  const std::vector<Setting> options_;
  const Warn warn_;
  RenderCommand command_;    ///< of the first mode, with the scene's defaults
  CameraParameters camera_;  ///< at rest
  std::optional<Shutter> shutter_;
  std::string device_, source_hash_;
  DeviceChoice device_choice_;
  SceneDefaults defaults_;
  ImageSize size_;                  ///< the first one
  std::optional<CropWindow> crop_;  ///< of an image of that size
  bool measures_exposure_ = false;
  std::vector<LiveParameter> parameters_;

  // Of the render's thread:
  std::vector<Worker> workers_;
  std::uint64_t arranged_ = 0;  ///< number of the settings that they follow
  ParameterValues edited_;      ///< those that their scenes have

  mutable std::mutex mutex_;                 ///< of all below
  mutable std::condition_variable changed_;  ///< for wait()
  std::condition_variable wake_;             ///< for the render's thread
  LiveState state_;
  SceneData tried_;  ///< has the parameters of the scene alone: what can be set is tried here
  bool has_exposure_ = false;
  std::uint32_t aovs_ = 0;  ///< that are rendered
  Round round_{};           ///< the times so far of the round that is not complete
  std::vector<Round> rounds_;
  int target_ = 0;        ///< samples that each view gets before the next pass is planned
  std::size_t last_ = 0;  ///< the view that had its turn
  // Written under the mutex, but read while a batch is traced as well.
  std::atomic<std::uint64_t> number_{1};  ///< of the settings
  std::atomic<bool> is_watched_{false}, is_paused_{false}, ends_{false};

  std::thread thread_;  // last: it uses all others
};

}  // namespace pt
