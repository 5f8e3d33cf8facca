// <integrator>: how long paths are.
#include <fmt/format.h>

#include <set>

#include "common/scene/load/mitsuba/sensor.h"

namespace pt::mitsuba {
namespace {

// For -1, a path of any length. Without Russian roulette a path must end somewhere: what is left
// after 64 rays is less than a part in 1000 unless surfaces reflect more than 90 %.
constexpr int unlimited_depth = 64;
constexpr int max_depth_limit = 65535;

/// Ways to compute the light of all paths, which is what we compute: how is not the scene's affair.
const std::set<std::string_view> light_transport = {
    "bdpt",   "erpt",      "mlt",       "path",    "photonmapper",   "ppm",
    "pssmlt", "ptracer",   "sppm",      "volpath", "volpath_simple", "volpathmis",
    "prb",    "prb_basic", "prbvolpath"};

/// Ways to run the integrator inside of one.
const std::set<std::string_view> ways_to_run = {"adaptive", "irrcache"};

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

/// In its integrators for media thin glass lets shadow rays through, and what passes it costs no
/// depth.
void let_panes_pass(SceneData& scene) {
  for (MaterialDescription& m : scene.materials) {
    const bool is_pane = m.node == MaterialNode::none && m.kind == kind_of<ThinDielectric>;
    if (is_pane && is_black(m.emission.radiance)) m.passes = true;
  }
}

void read_around(Context& context, const Object& integrator, const Object& nested) {
  if (!ways_to_run.contains(integrator.type())) {
    context.warn_once(
        "integrator " + integrator.type(), integrator.element(),
        fmt::format("integrator '{}' is not supported: the one inside is used", integrator.type()));
  }
  integrator.ignore_all();
  read_integrator(context, nested);
}

}  // namespace

void read_integrator(Context& context, const Object& integrator) {
  const std::string type = integrator.type();
  if (const Object* nested = integrator.child("integrator")) {
    return read_around(context, integrator, *nested);
  }
  const bool direct = type == "direct";
  if (!direct && !light_transport.contains(type)) {
    context.warn_once("integrator " + type, integrator.element(),
                      fmt::format("integrator '{}' is not supported: the scene is rendered by path "
                                  "tracing",
                                  type));
  }
  context.scene.camera.hides_emitters = integrator.boolean("hide_emitters", false);
  read_max_depth(context, integrator, integrator.integer("max_depth").value_or(-1));
  if (direct) context.scene.defaults.max_depth = 2;
  context.scene.defaults.rr_depth = integrator.integer("rr_depth");
  if (type.find("volpath") != std::string::npos) let_panes_pass(context.scene);
  // The rest is about the method.
  if (!direct && type != "path" && type != "volpath") return integrator.ignore_all();
  integrator.ignore({"strict_normals", "emitter_samples", "bsdf_samples", "shading_samples",
                     "samples_per_pass", "block_size", "timeout"});
}

}  // namespace pt::mitsuba
