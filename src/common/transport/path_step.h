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
// A ray that leaves the scene: emit, end. One that meets a surface or collides in a medium: emit,
// perhaps cast, then continue_path or end. `path.rays` counts the ray that has ended.
#pragma once

#include "common/transport/generate_camera_path.h"
#include "common/transport/shade_any.h"

namespace pt {

/// The first step: the camera ray of a path, by block 0 of its numbers.
template <class Stream>
PT_HD Ray begin_path(const Scene& scene, const PathId& id, Stream& random) {
  const Vec4 u = random.draw(scatter_block(0));
  return generate_camera_path(scene, random, id.pixel, u);
}

/// The ray has left the scene.
template <class Integrator, Lighting lighting, class Sink>
PT_HD void leave_scene(const Scene& scene, const Vec3& direction, const PathState& path,
                       const PathLimits& limits, Sink& sink) {
  sink.emit(path, Integrator::template miss<lighting>(scene, direction, path, limits));
  sink.end(path);
}

/// Tells the sink what a surface does with a path.
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

/// The ray has met a surface. `steps`: see surface_steps.h.
template <class Traits, class Steps, class Sink>
PT_HD_IN_KERNEL void meet_surface(const Scene& scene, const Ray& ray, const Hit& hit,
                                  PathState& path, const PathLimits& limits, const Steps& steps,
                                  Sink& sink) {
  follow_scattering<Traits>(
      Traits::Integrator::template surface<Traits>(scene, ray, hit, path, limits, steps), path,
      sink);
}

/// The ray has collided in a medium.
template <class Traits, class Steps, class Sink>
PT_HD_IN_KERNEL void collide(const Scene& scene, const Ray& ray, float distance, PathState& path,
                             const PathLimits& limits, const Steps& steps, Sink& sink) {
  follow_scattering<Traits>(
      Traits::Integrator::template medium<Traits>(scene, ray, distance, path, limits, steps), path,
      sink);
}

/// One or the other.
template <class Traits, class Steps, class Sink>
PT_HD_IN_KERNEL void meet(const Scene& scene, const Ray& ray, const Hit& hit, PathState& path,
                          const PathLimits& limits, const Steps& steps, Sink& sink) {
  if constexpr (Traits::has_media) {
    if (hit.is_collision()) {
      return collide<Traits>(scene, ray, hit.t, path, limits, steps, sink);
    }
  }
  meet_surface<Traits>(scene, ray, hit, path, limits, steps, sink);
}

/// Both by one way through the code (shade_any.h).
template <class Traits, class Sink>
PT_HD_IN_KERNEL void meet_anything(const Scene& scene, const Ray& ray, const Hit& hit,
                                   PathState& path, const PathLimits& limits,
                                   const DrawnSteps& steps, Sink& sink) {
  follow_scattering<Traits>(shade_any<Traits>(scene, ray, hit, path, limits, steps), path, sink);
}

/// The numbers that decide what the ray's surface does, of which `scatter` are drawn already.
template <class Traits, class Stream>
PT_HD DrawnSteps draw_steps(const Vec4& scatter, Stream& random, const PathState& path) {
  return {scatter, Traits::has_lights ? random.draw(light_block(path.rays)) : Vec4(0.0f)};
}
template <class Traits, class Stream>
PT_HD DrawnSteps draw_steps(Stream& random, const PathState& path) {
  const Vec4 scatter = random.draw(scatter_block(path.rays));
  return draw_steps<Traits>(scatter, random, path);
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

  PT_HD void emit(const PathState&, const Color& emitted) {
    radiance = add_rounded(radiance, emitted);
  }
  PT_HD void cast(const PathState& path, const ShadowRay& shadow) {
    const std::uint32_t key = shadow_ray_key(scene, path_key(), path.rays);
    if constexpr (Traits::has_media) {
      const Color passed = shadow_transmittance<Traits>(scene, shadow, key);
      radiance = add_rounded(radiance, multiply_rounded(shadow.radiance, passed));
      return;
    }
    if (!intersect_shadow<Traits>(scene, shadow, key)) {
      radiance = add_rounded(radiance, shadow.radiance);
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
