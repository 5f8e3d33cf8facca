// A path between two of its rays, in the memory of the block that follows it.
#pragma once

#include "common/transport/path_records.h"

namespace pt {

/// One cache line, for a block's paths are read in any order. What is needed together shares the 32
/// bytes that the memory moves at once.
struct alignas(128) PathSlot {
  struct alignas(16) StoredHit {
    float t;
    std::uint32_t primitive, instance;
    std::uint32_t unused;
  };

  PathRecord origin;            ///< of the ray; density of the BSDF
  PathRecord direction;         ///< of the ray; index of the path
  PathRecord throughput;        ///< beta; rays and shadow rays
  PathRecord radiance;          ///< so far; the receiver
  PathRecord shadow_origin;     ///< of the shadow ray; distance
  PathRecord shadow_direction;  ///< of the shadow ray
  PathRecord shadow_radiance;   ///< contribution if the ray is not occluded; its medium
  StoredHit hit;                ///< of the ray

  /// All but its radiance.
  PT_HD void store_path(const PathState& path, const Ray& ray) {
    store_wide(&origin, pack_origin(ray, path));
    store_wide(&direction, pack_direction(ray, path));
    store_wide(&throughput, pack_throughput(path));
    radiance.w = path.receiver.bits;
  }
  PT_HD PathState load_path(Color& sum, Ray& ray) const {
    const PathRecord o = load_wide(&origin), d = load_wide(&direction);
    const PathRecord b = load_wide(&throughput), r = load_wide(&radiance);
    ray.origin = vec(o), ray.direction = vec(d);
    sum = vec(r);
    PathState path;
    unpack_throughput(b, path);
    path.index = d.w;
    path.bsdf_pdf = bits_to_float(o.w);
    path.receiver = {r.w};
    return path;
  }
  PT_HD std::uint32_t load_path_index() const { return direction.w; }
  /// The rays of the path that have been traced.
  PT_HD std::uint32_t load_rays() const { return throughput.w & 0xffffu; }

  PT_HD Ray load_ray() const { return {vec(load_wide(&origin)), vec(load_wide(&direction))}; }

  PT_HD void store_hit(const Hit& h) {
    store_wide(&hit, StoredHit{h.t, h.primitive, h.instance, 0});
  }
  PT_HD Hit load_hit() const {
    const StoredHit h = load_wide(&hit);
    return {h.t, h.primitive, h.instance};
  }

  PT_HD void store_radiance(const Color& sum, const PathState& path) {
    store_wide(&radiance, pack(sum, path.receiver.bits));
  }
  PT_HD Color load_radiance() const { return vec(load_wide(&radiance)); }
  PT_HD void add_radiance(const Color& more) {
    const PathRecord sum = load_wide(&radiance);
    store_wide(&radiance, pack(vec(sum) + more, sum.w));
  }

  PT_HD void store_shadow_ray(const ShadowRay& shadow) {
    store_wide(&shadow_origin, pack_shadow_origin(shadow));
    store_wide(&shadow_direction, pack(shadow.ray.direction, 0));
  }
  PT_HD Ray load_shadow_ray(float& distance) const {
    const PathRecord o = load_wide(&shadow_origin);
    distance = bits_to_float(o.w);
    return {vec(o), vec(load_wide(&shadow_direction))};
  }
  /// `medium_id`: where it begins, in scenes with media.
  PT_HD void store_shadow_radiance(const Color& c, std::uint16_t medium_id) {
    store_wide(&shadow_radiance, pack(c, medium_id));
  }
  PT_HD Color load_shadow_radiance() const { return vec(load_wide(&shadow_radiance)); }
  PT_HD Color load_shadow_radiance(std::uint16_t& medium_id) const {
    const PathRecord r = load_wide(&shadow_radiance);
    medium_id = static_cast<std::uint16_t>(r.w);
    return vec(r);
  }
};
static_assert(sizeof(PathSlot) == 128);

}  // namespace pt
