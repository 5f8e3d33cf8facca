#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "common/sampling/sampler_source.h"
#include "common/scene/load/files/default_lighting.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/transport/mask.h"
#include "common/transport/path_step.h"

namespace pt {
namespace {

constexpr int side = 32, samples = 32;
constexpr PathSettings settings{.max_depth = 5};
constexpr float visible_emission = 0.01f, visible_albedo = 0.01f;

Options options_of_estimate() {
  Options options;
  options.width = options.height = side;
  options.spp = samples;
  options.accel = AccelKind::bvh2;
  options.kernel_set = KernelSet::general;
  return options;
}

/// Sums over the samples of a pixel, of luminance but for `radiance`.
struct PixelSums {
  Color radiance = Color(0.0f);
  float emitted = 0, reflected = 0, albedo = 0;  ///< of what the camera rays hit

  bool reflects() const {
    return emitted < visible_emission * samples && albedo >= visible_albedo * samples;
  }
  float incident() const { return reflected / albedo; }
};

/// Tells emission that is seen from light that is reflected.
template <class Traits, class PathKey>
struct GlimpseSink : PathRegisters<Traits, PathKey> {
  using Registers = PathRegisters<Traits, PathKey>;
  PixelSums& sums;

  void emit(const PathState& path, const Color& emitted) {
    if (path.depth<Traits>() <= 1) {
      sums.emitted += luminance(emitted);
      sums.radiance += emitted;
    } else {
      Registers::emit(path, emitted);
    }
  }
  void continue_path_if(bool goes_on, const PathState& path, const Ray& next) {
    if (goes_on && path.depth<Traits>() == 1) sums.albedo += luminance(path.beta);
    Registers::continue_path_if(goes_on, path, next);
  }
};

template <class Traits>
void follow(const Scene& scene, const PathId& id, PixelSums& sums) {
  auto random = SamplerSource{1, make_sampler(SamplerKind::sobol, samples)}.open(id);
  PathState path;
  Color reflected(0.0f);
  Ray ray = begin_path(scene, id, random);
  const std::uint32_t mask = path_hash<Traits>(scene, id);
  const auto key = [&] { return mask; };
  GlimpseSink<Traits, decltype(key)> sink{{scene, key, reflected, ray}, sums};
  do {
    const Hit hit = next_hit<Traits>(scene, ray, mask, path);
    ++path.rays;
    if (hit.is_miss()) {
      shade_miss<Traits::lighting>(scene, ray.direction, path, settings, sink);
    } else {
      shade_vertex<Traits>(scene, ray, hit, path, settings, eager_shading<Traits>(random, path),
                           sink);
    }
  } while (sink.alive);
  sums.radiance += reflected;
  sums.reflected += luminance(reflected);
}

template <class Traits>
void trace(const Scene& scene, std::vector<PixelSums>& pixels) {
  tbb::parallel_for(0u, static_cast<std::uint32_t>(side * side), [&](std::uint32_t i) {
    for (std::uint32_t sample = 0; sample < samples; ++sample)
      follow<Traits>(scene, {pack_pixel(i % side, i / side), sample, i}, pixels[i]);
  });
}

template <class... Kinds>
void trace_any(TypeList<Kinds...>, SceneTraits traits, const Scene& scene,
               std::vector<PixelSums>& pixels) {
  traits.accel = Accel::any, traits.geometry = Geometry::mixed;
  ((Kinds::value() == traits ? trace<Kinds>(scene, pixels) : void()), ...);
}

using GlimpseKinds = TypeList<Traits<Accel::any, Geometry::mixed, Lighting::full>,
                              Traits<Accel::any, Geometry::mixed, Lighting::full, true>,
                              Traits<Accel::any, Geometry::mixed, Lighting::full, true, true>>;

}  // namespace

LightEstimate::LightEstimate(const SceneData& scene) : scene_(scene) {
  hold_still(scene_);
  prepare_scene(scene_, options_of_estimate());
}

Glimpse LightEstimate::look(const CameraParameters& camera, const LitRule& rule) {
  scene_.camera = camera;
  std::vector<PixelSums> pixels(side * side);
  trace_any(GlimpseKinds{}, scene_.traits, host_view(scene_, side, side), pixels);
  Glimpse glimpse;
  glimpse.picture = {side, side, std::vector<float>(3 * pixels.size())};
  std::vector<float> incident;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const PixelSums& sums = pixels[i];
    for (int k = 0; k < 3; ++k)
      glimpse.picture.rgb[3 * i + static_cast<std::size_t>(k)] = sums.radiance[k] / samples;
    if (sums.reflects()) incident.push_back(sums.incident());
  }
  glimpse.is_luminous = incident.empty();
  if (glimpse.is_luminous) return glimpse;
  const double mean =
      std::accumulate(incident.begin(), incident.end(), 0.0) / static_cast<double>(incident.size());
  const double least = std::max(double{rule.least}, rule.part_of_mean * mean);
  const auto lit = std::ranges::count_if(incident, [&](float x) { return x >= least; });
  glimpse.lit_share = static_cast<double>(lit) / static_cast<double>(incident.size());
  return glimpse;
}

}  // namespace pt
