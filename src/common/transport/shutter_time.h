// The time of a path in the shutter's interval: a function of seed, pixel and sample, so that no
// schedule has to store it.
#pragma once

#include "common/sampling/sampler_source.h"
#include "common/scene/data/scene.h"
#include "common/transport/path.h"

namespace pt {

/// In [0, 1), uniform. With --sampler stratified each of a pixel's samples has a stratum of its
/// own, in random order; with sobol they are a scrambled van der Corput sequence.
PT_HD float shutter_time(const ShutterTimes& times, std::uint32_t seed, const PathId& id) {
  constexpr std::uint32_t purpose = 0x74696d65u;  // not that of masks and media
  const std::uint32_t of_pixel = combine_hash(combine_hash(seed, purpose), id.pixel);
  if (times.sampler == SamplerKind::sobol) {
    const std::uint32_t index = reverse_bits(permute_upwards(reverse_bits(id.sample), of_pixel));
    return to_unit_float(reverse_bits(permute_upwards(index, remix(of_pixel))));
  }
  const float u = to_unit_float(combine_hash(of_pixel, id.sample));
  if (times.sampler == SamplerKind::independent) return u;
  const std::uint32_t round = id.sample / times.samples;
  const std::uint32_t stratum =
      permute(id.sample - round * times.samples, times.samples, of_pixel + 0x9e3779b9u * round);
  return fminf((static_cast<float>(stratum) + u) / static_cast<float>(times.samples),
               one_minus_ulp);
}

PT_HD float shutter_time(const Scene& scene, const PathId& id) {
  return shutter_time(scene.shutter_times, scene.mask_seed, id);
}

/// Gives a path its time, in scenes that move.
template <class Traits>
PT_HD void set_time(const Scene& scene, const PathId& id, PathState& path) {
  if constexpr (Traits::has_motion) path.time = shutter_time(scene, id);
}

/// The camera at a time.
PT_HD Camera camera_at(const Scene& scene, float time) {
  const Motion& motion = *scene.motion;
  if (!motion.camera.moves()) return scene.camera;
  return moved(moved(scene.camera, motion.to_camera),
               pose_at(motion.segments, motion.camera, time));
}

}  // namespace pt
