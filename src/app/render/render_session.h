// A scene that stays in memory, to be rendered again and again: by other options, or after
// something of it was changed. What can be kept from the render before is kept.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/options/command_line.h"
#include "app/render/rendering.h"
#include "common/image/codecs/image_io.h"

namespace pt {

/// What a render gave.
struct RenderResult {
  bool has_image = false;  ///< else it was interrupted before its first sample
  bool interrupted = false;
  Image image;  ///< where device_image is not null, its layers alone, and no rgb
  std::shared_ptr<const DeviceImage> device_image;
  Options options;  ///< with what the scene and the device decided
  RenderReport report;
  ImageMetadata header;
  bool measures_exposure = false;  ///< see exposure_for
};

/// Some samples of a progressive render.
struct RenderPass {
  RenderRun run;
  int samples = 0;  ///< per pixel, in all that the image has
  Image image;
};

class RenderSession {
 public:
  using Warn = std::function<void(const std::string&)>;

  /// Loads the scene that the options name. Throws Error.
  RenderSession(const RenderCommand& command, const Warn& warn);
  /// Of a scene that somebody has made.
  explicit RenderSession(SceneData scene);
  ~RenderSession();

  /// As loaded: not prepared.
  const SceneData& scene() const { return source_; }
  /// To be changed. The next render prepares it again.
  SceneData& change_scene();
  /// The same of its camera alone, after which its acceleration structure is kept.
  CameraParameters& change_camera();

  /// Renders by these options, which name the same scene. Writes no image. `stays_on_device`: a
  /// GPU's image stays there; Error for that of several. Throws Error; the session is as it was
  /// then.
  RenderResult render(const RenderCommand& command, const MeasureHooks& hooks, const Warn& warn,
                      bool stays_on_device = false);
  /// Adds samples to what the last pass has left, or to none after a change: of the scene, of its
  /// camera, of the options. Throws Error.
  RenderPass add_pass(const RenderCommand& command, int samples, const RenderHooks& hooks,
                      const Warn& warn);
  /// How it would be rendered, and why.
  std::vector<Decision> plan(const RenderCommand& command);

 private:
  struct Prepared;

  Prepared& prepare(const RenderCommand& command, const Warn& warn);

  SceneData source_;
  bool camera_changed_ = false;
  std::unique_ptr<Prepared> prepared_;
};

}  // namespace pt
