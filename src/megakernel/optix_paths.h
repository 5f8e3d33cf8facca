// The megakernel inside OptiX's ray generation program: what optix_path_programs.cu is launched
// with, and how its paths' rays are traced.
#pragma once

#include <bit>

#include "common/accel/trace_optix/optix_pipeline.h"
#include "common/accel/trace_optix/optix_programs.h"
#include "common/options/options.h"
#include "megakernel/trace_path.h"

namespace pt {

class OptixTracer;

struct OptixPathChoices {
  OptixHits hits = OptixHits::custom;
  std::uint32_t reorders = 0;  ///< --reorder
};

struct OptixPathParams {
  OptixPathChoices choices;  ///< first: OptixModule::constants
  OptixScene scene{};
  Scene world;
  SamplerSource source;
  SampleBuffer samples;
  PathSettings settings;
};

/// optix_path_programs.cu for these choices, which must live until it is compiled.
OptixModule optix_path_module(const OptixPathChoices& choices);

/// Enqueues what traces a batch. The tracer fills in `params.scene`.
void launch_paths(OptixTracer& tracer, Work work, OptixPathParams params);

/// By what threads are reordered before they shade: the BSDF of what their rays hit.
inline constexpr unsigned surface_key_bits = std::bit_width(unsigned{Bsdfs::size} + 1);
PT_HD std::uint32_t surface_key(const Scene& scene, const Hit& hit) {
  if (hit.is_miss()) return 0;
  return 1u + static_cast<std::uint32_t>(scene.material(material_index_at(scene, hit)).kind);
}

/// OptiX's functions for rays after which a thread shades: what was met is known, threads are
/// reordered, and closest-hit programs run. `Api` has params(), besides what optix_programs.h says.
template <class Api, OptixHits hits>
struct ReorderingApi : Api {
  static PT_OPTIX_FUNCTION void trace(optix::TraversableHandle handle, const Ray& ray, float t_min,
                                      float t_max, unsigned flags, unsigned record,
                                      OptixPayload& payload) {
    if (record == optix_record_ties)
      return Api::trace(handle, ray, t_min, t_max, flags, record, payload);
    Api::traverse(handle, ray, t_min, t_max, flags, record, payload);
    if constexpr (hits == OptixHits::built_in) {
      Api::reorder(0, 0);
      Api::invoke(payload);
    } else {
      ClosestJudge<Api> query(0.0f, 0.0f);
      from_payload(payload, query);
      const OptixPathParams& p = Api::params();
      Api::reorder(surface_key(p.world, numbered(p.scene, query.result())), surface_key_bits);
    }
  }
};

/// Traits::Tracer (transport/intersect.h). The choices, which are constants for OptiX's compiler,
/// leave one trace of each kind of rays.
template <class Api>
struct OptixPathRays {
  static PT_OPTIX_FUNCTION Hit closest(const Scene&, const Ray& ray, std::uint32_t key) {
    const OptixPathParams& p = Api::params();
    const ClosestJudge<Api> query(0.0f, ray_length(p.world, ray.direction, key), key);
    return optix::trace_any_distance<Api>(optix::has_far_rays(p.choices.hits), p.scene, ray, query,
                                          [&] {
                                            switch (p.choices.hits) {
                                              case OptixHits::custom:
                                                return closest_of<OptixHits::custom>(ray, query);
                                              case OptixHits::any_hit:
                                                return closest_of<OptixHits::any_hit>(ray, query);
                                              default:
                                                return closest_of<OptixHits::built_in>(ray, query);
                                            }
                                          });
  }

  static PT_OPTIX_FUNCTION bool any(const ShadowRay& shadow, std::uint32_t key) {
    const OptixPathParams& p = Api::params();
    const AnyJudge<Api> query(0.0f, shadow.distance, key);
    return optix::trace_any_distance<Api>(
        optix::has_far_rays(p.choices.hits), p.scene, shadow.ray, query, [&] {
          switch (p.choices.hits) {
            case OptixHits::custom:
              return optix::trace_near_any<Api, OptixHits::custom>(p.scene, shadow.ray, query);
            case OptixHits::any_hit:
              return optix::trace_near_any<Api, OptixHits::any_hit>(p.scene, shadow.ray, query);
            default:
              return optix::trace_near_any<Api, OptixHits::built_in>(p.scene, shadow.ray, query);
          }
        });
  }

 private:
  template <OptixHits hits>
  static PT_OPTIX_FUNCTION Hit closest_of(const Ray& ray, const ClosestJudge<Api>& query) {
    const OptixPathParams& p = Api::params();
    return p.choices.reorders != 0
               ? optix::trace_near_closest<ReorderingApi<Api, hits>, hits>(p.scene, ray, query)
               : optix::trace_near_closest<Api, hits>(p.scene, ray, query);
  }
};

/// One for all scenes without media: what has no masks never asks for them, nor for its primitives.
template <class Api>
struct OptixPathTraits : Traits<Accel::cwbvh, Geometry::mixed, Lighting::full, true> {
  using Tracer = OptixPathRays<Api>;
};

/// Every so many paths from a thread's first on; a thread knows of no warp, which reordering would
/// take apart.
class LaunchedPaths {
 public:
  PT_HD LaunchedPaths(std::uint32_t first, std::uint32_t step, std::uint32_t end)
      : next_(first), step_(step), end_(end) {}

  PT_HD bool any(bool value) const { return value; }

  PT_HD bool next(std::uint32_t& path_index, bool wanted) {
    if (!wanted) return true;
    if (next_ >= end_) return false;
    path_index = next_;
    next_ += step_;
    return true;
  }

 private:
  std::uint32_t next_, step_, end_;
};

/// Ray generation.
template <class Api>
PT_OPTIX_FUNCTION void trace_launched_paths() {
  const OptixPathParams& p = Api::params();
  LaunchedPaths work(Api::launch_index(), Api::launch_width(), p.samples.path_count);
  trace_paths<OptixPathTraits<Api>, Branching::divergent>(p.world, p.source, p.samples, p.settings,
                                                          work);
}

}  // namespace pt
