// A renderer is one mode on one device, set up for one scene and one set of options.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "common/image/image.h"
#include "common/render/options.h"
#include "common/render/stats.h"

namespace pt {

struct RenderHooks {
  /// Called between batches with the samples done and wanted (pixels x spp). May be empty.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
  /// Polled between batches; true ends the render early with the samples that it has. May be empty.
  std::function<bool()> stop;
};

class Renderer {
 public:
  virtual ~Renderer() = default;

  /// Renders the image from its first sample, forgetting any earlier render. Throws Error.
  virtual RenderRun render(const RenderHooks& hooks) = 0;

  /// The mean of the samples of the last render.
  virtual Image image() = 0;

  /// Fills in all fields of `report` that the renderer knows (device, counts of the last render,
  /// memory, kernels, set-up and transfer times). Leaves `runs`, `scene_ms` and `image_write_ms`.
  virtual void describe(RenderReport& report) const = 0;
};

}  // namespace pt
