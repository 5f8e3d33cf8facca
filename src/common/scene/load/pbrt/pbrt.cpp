#include "common/scene/load/pbrt/pbrt.h"

#include <fmt/format.h>

#include <cmath>

#include "common/scene/data/frame_scene.h"
#include "common/scene/load/files/studio.h"
#include "common/scene/load/pbrt/colors/white_balance.h"
#include "common/scene/load/pbrt/description/read_description.h"
#include "common/scene/load/pbrt/lights/lights.h"
#include "common/scene/load/pbrt/media/media.h"
#include "common/scene/load/pbrt/shapes/shapes.h"
#include "common/scene/load/pbrt/view/view.h"

namespace pt {
namespace {

using pbrt::Context;
using pbrt::Description;
using pbrt::Reporter;

/// What a viewer needs and the file does not bring.
void complete(Context& context, const LoadOptions& options) {
  SceneData& scene = context.scene;
  const Description& description = context.description;
  if (!description.camera) {
    const Bounds bounds = scene_bounds(scene);
    if (std::isfinite(glm::length(bounds.max - bounds.min)) && !bounds.is_empty()) {
      scene.camera = frame_scene(scene);
    }
    context.reporter.note(description.place, "no Camera: one that frames the scene is used");
  }
  if (context.lit || options.default_lighting == DefaultLighting::off) return;
  add_studio(scene);
  const std::string text = fmt::format("no light that is supported: {} is used", studio_text);
  if (description.lights.empty()) return context.reporter.note(description.place, text);
  context.reporter.warn_once("dark", description.place, text);
}

}  // namespace

SceneData load_pbrt(const std::filesystem::path& path, const LoadOptions& options) {
  Reporter reporter(options);
  const Description description = pbrt::read_description(path, reporter);
  SceneData scene;
  scene.name = path.stem().string();
  Context context(scene, description, reporter);
  pbrt::read_view(context);
  if (description.camera) {
    scene.camera_medium = pbrt::medium_named(context, description.camera_medium,
                                             description.camera->parameters.place());
  }
  pbrt::add_lights(context);
  pbrt::add_shapes(context);
  if (context.white_kelvins > 0.0f) pbrt::balance_lights(scene, double{context.white_kelvins});
  complete(context, options);
  return scene;
}

}  // namespace pt
