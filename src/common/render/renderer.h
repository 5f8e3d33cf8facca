// A renderer is one mode on one device, set up for one scene and one set of options.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "common/error/error.h"
#include "common/film/film_data.h"
#include "common/image/image.h"
#include "common/options/options.h"
#include "common/options/stats.h"
#include "common/plan/execution_plan.h"
#include "common/scene/data/camera.h"

namespace pt {

struct SceneChanges;
struct SceneData;

/// Ends a render before all of its samples are taken. 0: no such limit.
struct StopRule {
  double seconds = 0;         ///< of rendering
  double relative_error = 0;  ///< see relative_error()
  /// The steady clock in seconds, or a test's. May be empty.
  std::function<double()> clock;
};

struct RenderHooks {
  /// Called between batches with the samples done and wanted (pixels x spp, and the bootstrap's
  /// paths) of this render. May be empty.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
  /// Polled between batches; true ends the render early with the samples that it has. May be empty.
  std::function<bool()> stop;
  StopRule stops{};
  /// Polled while a batch is traced, by any thread; true, which must last, abandons it: the render
  /// ends with the samples that it had before. May be empty. CUDA finishes its batch.
  std::function<bool()> cancel{};
};

class Renderer {
 public:
  virtual ~Renderer() = default;

  /// Renders the image from its first sample, forgetting any earlier render. Throws Error.
  virtual RenderRun render(const RenderHooks& hooks) = 0;

  /// Adds the next `samples` samples of each of its pixels to `film`, which may be blank or come
  /// from another renderer of the same scene and options. The bits do not depend on how an image's
  /// pixels are divided into films, nor on how the samples of a film are divided into renders; on
  /// CUDA, between devices of one kind. Throws Error for a window that is no part of the image and
  /// for a film that lacks some of its pixels.
  virtual RenderRun render(Film& film, int samples, const RenderHooks& hooks) = 0;

  /// Adds the next `samples` samples of each pixel to the film of the last render, of which the
  /// device still has the sums; to none at first. Many of them give the bits of one render. Throws
  /// Error, also for Markov chains, which end with their render.
  virtual RenderRun add(int samples, const RenderHooks& hooks) = 0;

  /// Looks at the same scene through another camera of its kind (move_camera), and forgets the last
  /// render. False: it cannot, and has to be made anew.
  virtual bool set_camera(const Camera&) { return false; }
  /// Takes over what has changed of its scene (prepare_changes), which a plan that differs in
  /// nothing still fits, and forgets the last render. False: it cannot, and has to be made anew.
  virtual bool set_scene(const SceneData&, const SceneChanges&) { return false; }

  /// The mean of all samples of the film of the last render.
  virtual Image image() = 0;
  /// The same, its pixels left in the memory of the GPU that has rendered them. Null: the host has
  /// them, since CPUs or several devices have rendered them. Throws Error.
  virtual std::unique_ptr<DeviceImage> device_image() { return nullptr; }

  /// Fills in all fields of `report` that the renderer knows (device, counts of the film of the
  /// last render, memory, kernels, set-up and transfer times). Leaves `runs`, `scene_ms` and
  /// `image_write_ms`.
  virtual void describe(RenderReport& report) const = 0;

  /// Renders the first batch of the image again, several times, and says what the hardware counts
  /// meanwhile. Forgets the last render: to be called after image() and describe(). Throws Error,
  /// also where nothing can be counted.
  virtual HardwareCounters count_hardware() { throw Error("no counters of this device are known"); }
};

}  // namespace pt
