// One step of a path, written once for every schedule: its ray has ended, in the scene or outside
// of it, and a *sink* is told what follows. A sink is where a schedule keeps a path between its
// steps: registers, a lane's or a slot's memory in a block, a slot of the wavefront's pool.
//
//   void emit(const PathState&, const Color&)         adds radiance to the path's sample
//   void cast(const PathState&, const ShadowRay&)     adds its radiance if it is not occluded
//   void continue_path(const PathState&, const Ray&)  the path's next ray
//   void end(const PathState&)                        there is none
// or, instead of both,
//   void continue_path_if(bool, const PathState&, const Ray&)
//
// shade_miss: emit, end. shade_surface and shade_medium: emit, perhaps cast, then continue_path or
// end. `path.rays` counts the ray that has ended.
#pragma once

#include "common/transport/generate_camera_path.h"
#include "common/transport/shade_miss.h"
#include "common/transport/shade_surface.h"
#include "common/transport/travel.h"

namespace pt {

/// The first step: the camera ray of a path, by block 0 of its numbers. `time`: see
/// generate_camera_path().
template <bool has_motion = false, class Stream>
PT_HD Ray begin_path(const Scene& scene, const PathId& id, Stream& random, float time = 0.0f) {
  const Vec4 u = random.draw(scatter_block(0));
  return generate_camera_path<has_motion>(scene, random, id.pixel, u, time);
}

/// The ray has left the scene.
template <Lighting lighting, class Sink>
PT_HD void shade_miss(const Scene& scene, const Vec3& direction, const PathState& path,
                      const PathSettings& settings, Sink& sink) {
  sink.emit(path, miss_radiance<lighting>(scene, direction, path, settings.mis));
  sink.end(path);
}

/// Tells the sink what a surface or a medium does with a path.
template <class Traits, class Sink>
PT_HD_IN_KERNEL void follow_scattering(const Scattering& scattering, const PathState& path,
                                       Sink& sink) {
  sink.emit(path, scattering.emitted);
  if (Traits::has_lights && !is_black(scattering.shadow.radiance)) {
    sink.cast(path, scattering.shadow);
  }
  if constexpr (requires { sink.continue_path_if(scattering.alive, path, scattering.ray); }) {
    sink.continue_path_if(scattering.alive, path, scattering.ray);
  } else if (scattering.alive) {
    sink.continue_path(path, scattering.ray);
  } else {
    sink.end(path);
  }
}

/// The ray has hit a surface. `policy`: see shading_policy.h.
template <class Traits, class Policy, class Sink>
PT_HD_IN_KERNEL void shade_surface(const Scene& scene, const Ray& ray, const Hit& hit,
                                   PathState& path, const PathSettings& settings,
                                   const Policy& policy, Sink& sink) {
  follow_scattering<Traits>(scatter_at_surface<Traits>(scene, ray, hit, path, settings, policy),
                            path, sink);
}

/// The ray has collided in a medium.
template <class Traits, class Policy, class Sink>
PT_HD_IN_KERNEL void shade_medium(const Scene& scene, const Ray& ray, float distance,
                                  PathState& path, const PathSettings& settings,
                                  const Policy& policy, Sink& sink) {
  follow_scattering<Traits>(medium_scattering<Traits>(scene, ray, distance, path, settings, policy),
                            path, sink);
}

/// Shades a surface hit or a medium collision.
template <class Traits, class Policy, class Sink>
PT_HD_IN_KERNEL void shade_vertex(const Scene& scene, const Ray& ray, const Hit& hit,
                                  PathState& path, const PathSettings& settings,
                                  const Policy& policy, Sink& sink) {
  if constexpr (Traits::has_media) {
    if (hit.is_collision()) {
      return shade_medium<Traits>(scene, ray, hit.t, path, settings, policy, sink);
    }
  }
  shade_surface<Traits>(scene, ray, hit, path, settings, policy, sink);
}

/// Shades a surface hit or a miss without a branch, the paper's 'reduced branching': a miss is a
/// surface that emits the sky and reflects nothing, so that all threads of a warp take the same way
/// through the code. The scene must have a primitive, whose data a miss loads and then discards.
template <class Traits, class Sink>
PT_HD_IN_KERNEL void shade_without_branches(const Scene& scene, const Ray& ray, const Hit& hit,
                                            PathState& path, const PathSettings& settings,
                                            const EagerShading& policy, Sink& sink) {
  const bool miss = hit.is_miss();
  const std::uint16_t shadow_rays = path.shadow_rays;
  const Color sky = miss_radiance<Traits::lighting>(scene, ray.direction, path, settings.mis);
  Scattering result =
      scatter_at_surface<Traits>(scene, ray, miss ? Hit{1.0f, 0} : hit, path, settings, policy);
  result.alive = result.alive && !miss;
  result.emitted = miss ? sky : result.emitted;
  result.shadow.radiance = miss ? Color(0.0f) : result.shadow.radiance;
  path.shadow_rays = miss ? shadow_rays : path.shadow_rays;
  follow_scattering<Traits>(result, path, sink);
}

/// The numbers that decide what the ray's surface does, of which `scatter` are drawn already.
template <class Traits, class Stream>
PT_HD EagerShading eager_shading(const Vec4& scatter, Stream& random, const PathState& path) {
  return {scatter, Traits::has_lights ? random.draw(light_block(path.rays)) : Vec4(0.0f)};
}
template <class Traits, class Stream>
PT_HD EagerShading eager_shading(Stream& random, const PathState& path) {
  const Vec4 scatter = random.draw(scatter_block(path.rays));
  return eager_shading<Traits>(scatter, random, path);
}

/// The sink of a thread that follows a path alone: its shadow rays are traced at once. `PathKey` is
/// a function that returns path_hash().
template <class Traits, class PathKey>
struct PathRegisters {
  const Scene& scene;
  const PathKey& path_key;
  Color& radiance;
  Ray& ray;            ///< the path's next one
  bool alive = false;  ///< whether there is one

  PT_HD void emit(const PathState&, const Color& emitted) { radiance += emitted; }
  PT_HD void cast(const PathState& path, const ShadowRay& shadow) {
    const std::uint32_t key = shadow_ray_key(scene, path_key(), path.rays);
    if constexpr (Traits::has_media) {
      const Color transmittance = shadow_transmittance<Traits>(scene, shadow, key, path.time);
      radiance = radiance + shadow.radiance * transmittance;
      return;
    }
    if (!intersect_shadow<Traits>(scene, shadow, key, path.time)) {
      radiance += shadow.radiance;
    }
  }
  /// Without a branch: else the old ray would have to live until the end of shading, which takes
  /// ten registers and 2.5 % of the paper's image.
  PT_HD void continue_path_if(bool goes_on, const PathState&, const Ray& next) {
    ray = next, alive = goes_on;
  }
  PT_HD void end(const PathState&) { alive = false; }
};

}  // namespace pt
