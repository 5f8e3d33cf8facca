// <integrator>: how long paths are.
#include <fmt/format.h>

#include "common/scene/mitsuba/sensor.h"

namespace pt::mitsuba {
namespace {

// For -1, a path of any length. Without Russian roulette a path must end somewhere: what is left
// after 64 rays is less than a part in 1000 unless surfaces reflect more than 90 %.
constexpr int unlimited_depth = 64;
constexpr int max_depth_limit = 65535;

void read_max_depth(Context& context, const Object& integrator, int depth) {
  if (depth < -1) {
    fail(integrator.element(), fmt::format("max_depth {}; expected -1 (any) or more", depth));
  }
  if (depth == 0 || depth > max_depth_limit) {
    const int used = depth == 0 ? 1 : max_depth_limit;
    context.warn_once("max_depth", integrator.element(),
                      fmt::format("max_depth {}: {} is used", depth, used));
    depth = used;
  }
  // Mitsuba counts the edges of a path, the last one to the emitter included; ours counts its rays,
  // the camera's included. That is the same.
  context.scene.defaults.max_depth = depth == -1 ? unlimited_depth : depth;
}

}  // namespace

void read_integrator(Context& context, const Object& integrator) {
  const std::string type = integrator.type();
  // Integrators that stand around another one, such as `aov` or `adaptive`.
  if (const Object* nested = integrator.child("integrator")) {
    context.warn_once(
        "integrator " + type, integrator.element(),
        fmt::format("integrator '{}' is not supported: the one inside is used", type));
    integrator.ignore_all();
    return read_integrator(context, *nested);
  }
  if (type != "path" && type != "volpath" && type != "direct") {
    context.warn_once("integrator " + type, integrator.element(),
                      fmt::format("integrator '{}' is not supported: the scene is rendered by path "
                                  "tracing",
                                  type));
    const std::optional<int> depth = integrator.integer("max_depth");
    integrator.ignore_all();
    return read_max_depth(context, integrator, depth.value_or(-1));
  }
  integrator.ignore({"strict_normals", "emitter_samples", "bsdf_samples", "shading_samples"});
  if (integrator.boolean("hide_emitters", false)) {
    context.warn_once("hide_emitters", integrator.element(),
                      "hide_emitters is not supported: emitters are visible");
  }
  read_max_depth(context, integrator, integrator.integer("max_depth").value_or(-1));
  if (type == "direct") context.scene.defaults.max_depth = 2;
  context.scene.defaults.rr_depth = integrator.integer("rr_depth");
}

}  // namespace pt::mitsuba
