// A scene in memory that is rendered again and again, by other options or after a change. A render
// reuses what the one before has prepared.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/options/command_line.h"
#include "app/render/rendering.h"
#include "common/image/codecs/image_io.h"

namespace pt {

/// The result of a render.
struct RenderResult {
  bool has_image = false;  ///< else it was interrupted before its first sample
  bool interrupted = false;
  Image image;  ///< if device_image is not null, without rgb
  std::shared_ptr<const DeviceImage> device_image;
  Options options;  ///< completed by the scene and the device
  RenderReport report;
  ImageMetadata header;
  bool measures_exposure = false;  ///< see exposure_for
};

/// Some samples of a progressive render.
struct RenderPass {
  RenderRun run;
  int samples = 0;  ///< per pixel, of all passes
  Image image;
};

class RenderSession {
 public:
  using Warn = std::function<void(const std::string&)>;

  /// Loads the scene that the options name. Throws Error.
  RenderSession(const RenderCommand& command, const Warn& warn);
  /// Takes a scene that is not loaded from a file.
  explicit RenderSession(SceneData scene);
  ~RenderSession();

  /// As loaded, not prepared.
  const SceneData& scene() const { return source_; }
  /// Calls edit(scene), which changes no more than `changes` says; the next render prepares again
  /// what depends on that. Throws what `edit` throws, which has changed nothing then.
  void change_scene(const SceneChanges& changes, const std::function<void(SceneData&)>& edit);
  /// For changes of the camera, which keep the acceleration structure.
  CameraParameters& change_camera();

  /// Shows what moves as it stands at a time, in seconds; none: as it moves.
  void show_instant(std::optional<float> time);

  /// Renders by these options, which name the same scene. Writes no image. `stays_on_device`: a
  /// GPU's image stays there, which several devices cannot do. Throws Error and leaves the session
  /// as it was.
  RenderResult render(const RenderCommand& command, const MeasureHooks& hooks, const Warn& warn,
                      bool stays_on_device = false);
  /// Adds samples to those of the last pass, or starts again after a change of the scene, its
  /// camera or the options. Throws Error.
  RenderPass add_pass(const RenderCommand& command, int samples, const RenderHooks& hooks,
                      const Warn& warn);
  /// How the scene would be rendered, and why.
  std::vector<Decision> plan(const RenderCommand& command);

 private:
  struct Prepared;

  /// A copy of the scene, resolved; held still if it is to be.
  SceneData resolved_scene(const Options& options, const DeviceInfo& device,
                           const Warn& warn) const;
  Prepared& prepare(const RenderCommand& command, const Warn& warn, ProcessClock& clock);
  bool update(Prepared& ready, const Options& options, const std::vector<DeviceInfo>& devices,
              SceneChanges changes) const;

  SceneData source_;
  std::optional<float> instant_;
  SceneChanges changes_;  ///< since the last preparation
  std::unique_ptr<Prepared> prepared_;
};

}  // namespace pt
