// Filter, sampler and integrator.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/scene/load/pbrt/view/view.h"
#include "common/scene/prepare/prepare_filter.h"

namespace pt::pbrt {
namespace {

constexpr int most_rays = 65535;

/// Ways to compute the light of all paths, which is what we compute: how is not the scene's affair.
const std::set<std::string_view> light_transport = {"bdpt",          "lightpath",  "mlt",
                                                    "path",          "randomwalk", "simplepath",
                                                    "simplevolpath", "sppm",       "volpath"};

}  // namespace

/// Ours have the radius that their other parameters give them.
void read_filter(Context& context, const Entity& filter) {
  const Parameters& p = filter.parameters;
  const std::map<std::string_view, FilterKind> kinds = {{"box", FilterKind::box},
                                                        {"triangle", FilterKind::tent},
                                                        {"gaussian", FilterKind::gaussian},
                                                        {"mitchell", FilterKind::mitchell},
                                                        {"sinc", FilterKind::lanczos}};
  const auto kind = kinds.find(filter.type);
  if (kind == kinds.end()) {
    p.ignore_all();
    return context.reporter.warn_once("filter " + filter.type, p.place(),
                                      fmt::format("filter '{}' is not known: box is used; expected "
                                                  "box, triangle, gaussian, mitchell or sinc",
                                                  filter.type));
  }
  FilterChoice choice = default_filter(kind->second);
  // pbrt-v3 calls them widths.
  const auto along = [&](const char* name, const char* earlier, float fallback) {
    return p.number(name, p.number(earlier, fallback));
  };
  const auto x_radius = [&](float fallback) { return along("xradius", "xwidth", fallback); };
  float radius = 2.0f;
  switch (choice.kind) {
    case FilterKind::box:
      choice.a = radius = x_radius(0.5f);
      break;
    case FilterKind::tent:
      choice.a = radius = x_radius(2.0f);
      break;
    case FilterKind::gaussian:
      // pbrt-v3's alpha is that of exp(-alpha x^2), 2 by default, which is the same.
      choice.a = p.number("sigma", std::sqrt(0.5f / p.number("alpha", 2.0f)));
      radius = x_radius(1.5f);
      break;
    case FilterKind::mitchell:
      choice.a = p.number("B", 1.0f / 3.0f), choice.b = p.number("C", 1.0f / 3.0f);
      radius = x_radius(2.0f);
      break;
    case FilterKind::lanczos:
      choice.a = p.number("tau", 3.0f);
      radius = x_radius(4.0f);
      break;
  }
  if (!(radius > 0.0f) || (choice.kind != FilterKind::mitchell && !(choice.a > 0.0f))) {
    fail(p.place(), fmt::format("{}: expected sizes above 0", p.what()));
  }
  const bool other_shape = choice.kind == FilterKind::mitchell && radius != 2.0f;
  const bool differs = along("yradius", "ywidth", radius) != radius;
  if (other_shape || differs) {
    context.reporter.warn_once("filter radius", p.place(),
                               fmt::format("{}: a radius of our own is used, the same along x and "
                                           "y",
                                           p.what()));
  }
  context.scene.defaults.filter = choice;
  p.report_unused(context.reporter);
}

void read_sampler(Context& context, const Entity& sampler) {
  const Parameters& p = sampler.parameters;
  int count = p.integer("pixelsamples", 16);
  if (sampler.type == "stratified") {
    const std::int64_t product = std::int64_t{p.integer("xsamples", 4)} * p.integer("ysamples", 4);
    count = static_cast<int>(std::clamp<std::int64_t>(product, -1, 1 << 30));
  }
  p.ignore({"seed", "randomization", "jitter", "dimensions"});
  if (count < 1) fail(p.place(), fmt::format("{} samples a pixel; expected 1 or more", count));
  context.scene.defaults.spp = count;
  p.report_unused(context.reporter);
}

/// pbrt counts where paths are scattered; we count rays, the camera's included.
void read_integrator(Context& context, const Entity& integrator) {
  const Parameters& p = integrator.parameters;
  if (!light_transport.contains(integrator.type) && integrator.type != "directlighting") {
    context.reporter.warn_once("integrator " + integrator.type, p.place(),
                               fmt::format("integrator '{}' is not supported: the scene is "
                                           "rendered by path tracing",
                                           integrator.type));
  }
  // pbrt-v3's is path tracing of one bounce.
  const int depth = integrator.type == "directlighting" ? 1 : p.integer("maxdepth", 5);
  if (depth < 0) fail(p.place(), fmt::format("maxdepth {}; expected 0 or more", depth));
  context.scene.defaults.max_depth = std::min(depth, most_rays - 1) + 1;
  p.ignore_all();  // the rest is about the method
}

}  // namespace pt::pbrt
