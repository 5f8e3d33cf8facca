// A render with all that its options ask for: one device's renderer, or a group of several, whose
// film may be kept in a checkpoint.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/render/checkpoint_keeper.h"
#include "common/device/devices.h"
#include "common/distribute/group_renderer.h"
#include "common/film/checkpoint.h"
#include "common/mpi/ranks.h"
#include "common/plan/execution_plan.h"
#include "common/platform/steady_seconds.h"
#include "common/render/renderer.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Whether the options ask for what one device's renderer alone cannot do.
bool needs_group(const Options& options, const std::vector<DeviceInfo>& devices);

/// A worker for each device and its plan, set up at the same time. `scene` must live as long and is
/// prepared. Throws what a device's renderer throws.
std::vector<std::unique_ptr<Worker>> make_workers(const std::vector<ExecutionPlan>& plans,
                                                  const SceneData& scene,
                                                  const std::vector<DeviceInfo>& devices,
                                                  ResultBell& bell);

/// The pixels of the options' part of the image: rows, every so many of them, so that parts take
/// about the same time. Throws Error where the image has too few rows.
std::vector<Window> part_windows(const Options& options);

/// Divides the wall time of a process, or of one of its renders.
class ProcessClock {
 public:
  /// `age_s`: of the process, where all of it is divided.
  explicit ProcessClock(double age_s = 0) : last_s_(steady_seconds()) {
    times_.start = 1e3 * age_s;
  }

  /// What has passed since the last call belongs to `part`.
  void end(double ProcessTimes::*part) {
    const double now_s = steady_seconds();
    times_.*part += 1e3 * (now_s - last_s_);
    last_s_ = now_s;
  }
  const ProcessTimes& times() const { return times_; }

 private:
  ProcessTimes times_;
  double last_s_;
};

struct Measurement {
  /// The measured repeats; if a render was cut short, only that one, which the renderer's image and
  /// counts belong to. Empty: no render was begun.
  std::vector<RenderRun> runs;
  bool interrupted = false;
};

/// What a measurement reports and asks meanwhile. `stop` must not be empty.
struct MeasureHooks {
  /// A render begins: "rendering", "warm-up 1 of 2".
  std::function<void(const std::string& label)> begin;
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;  ///< as RenderHooks
  /// Asked between batches and between renders, and while a batch is traced, by any thread.
  std::function<bool()> stop;
};

Measurement measure(Renderer& renderer, const Options& options, const MeasureHooks& hooks);

/// A film that a render goes on with, and the file that it was in.
struct Resumption {
  std::string file;
  Checkpoint checkpoint;
};

class Rendering {
 public:
  /// What may come from elsewhere. All may be absent.
  struct Surroundings {
    Ranks* ranks = nullptr;  ///< of the job; the others' devices work, too
    const Resumption* resumption = nullptr;
    std::function<void(const std::string&)> warn{};
  };

  /// `plans`: one for each device, see plan_render. `scene` is prepared for them, and must outlive
  /// the rendering. Throws Error.
  Rendering(const Options& options, const std::vector<ExecutionPlan>& plans, const SceneData& scene,
            const std::vector<DeviceInfo>& devices, const Surroundings& surroundings);

  Renderer& renderer() { return group_ ? *group_ : *single_; }

  /// Renders as often as the options say. What was rendered is in the checkpoint then, whatever
  /// ended the render, unless there is a checkpoint_problem(). Throws Error.
  Measurement measure(const MeasureHooks& hooks);

  /// Why the last checkpoint could not be written, which is no reason to lose the image; or empty.
  const std::string& checkpoint_problem() const { return checkpoint_problem_; }

 private:
  void make_group(const std::vector<ExecutionPlan>& plans, const SceneData& scene,
                  const std::vector<DeviceInfo>& devices, const Surroundings& surroundings);
  void save(const ImageFilm& film) const;
  void keep();

  const Options options_;
  PixelFilter filter_{};
  ImageMetadata header_;
  std::unique_ptr<Renderer> single_;
  std::shared_ptr<ResultBell> bell_;
  std::unique_ptr<CheckpointKeeper> keeper_;
  std::unique_ptr<GroupRenderer> group_;
  std::string checkpoint_problem_;
};

/// Their names, for Ranks::announce.
std::vector<std::string> names_of(const std::vector<std::unique_ptr<Worker>>& workers);

}  // namespace pt
