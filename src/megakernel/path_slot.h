// A path between two of its rays, in the memory of the block that follows it.
#pragma once

#include "common/transport/intersect.h"
#include "common/transport/path.h"

namespace pt {

/// One cache line, for a block's paths are read in any order. What is needed together shares the 32
/// bytes that the memory moves at once.
struct alignas(128) PathSlot {
  struct alignas(16) Record {
    float x, y, z;
    std::uint32_t w;
  };
  struct alignas(16) StoredHit {
    float t;
    std::uint32_t primitive;
    std::uint32_t unused[2];
  };

  Record origin;            ///< of the ray; density of the BSDF
  Record direction;         ///< of the ray; number of the path
  Record throughput;        ///< beta; rays and shadow rays
  Record radiance;          ///< so far; the receiver
  Record shadow_origin;     ///< of the shadow ray; distance
  Record shadow_direction;  ///< of the shadow ray
  Record shadow_radiance;   ///< what arrives if the ray is free
  StoredHit hit;            ///< of the ray

  PT_HD static Record pack(const Vec3& v, std::uint32_t w) { return {v.x, v.y, v.z, w}; }
  PT_HD static Vec3 vec(const Record& r) { return {r.x, r.y, r.z}; }

  PT_HD void store_path(const PathState& path, const Color& sum, const Ray& ray) {
    store_wide(&origin, pack(ray.origin, float_to_bits(path.bsdf_pdf)));
    store_wide(&direction, pack(ray.direction, path.number));
    store_wide(&throughput, pack(path.beta, path.packed_rays()));
    store_wide(&radiance, pack(sum, path.receiver.bits));
  }
  PT_HD PathState load_path(Color& sum, Ray& ray) const {
    const Record o = load_wide(&origin), d = load_wide(&direction);
    const Record b = load_wide(&throughput), r = load_wide(&radiance);
    ray.origin = vec(o), ray.direction = vec(d);
    sum = vec(r);
    PathState path;
    path.beta = vec(b);
    path.number = d.w;
    path.rays = static_cast<std::uint16_t>(b.w);
    path.shadow_rays = static_cast<std::uint16_t>(b.w >> 16);
    path.bsdf_pdf = bits_to_float(o.w);
    path.receiver = {r.w};
    return path;
  }
  PT_HD std::uint32_t load_number() const { return direction.w; }
  /// Of the path, those traced so far.
  PT_HD std::uint32_t load_rays() const { return throughput.w & 0xffffu; }

  PT_HD Ray load_ray() const { return {vec(load_wide(&origin)), vec(load_wide(&direction))}; }

  PT_HD void store_hit(const Hit& h) { store_wide(&hit, StoredHit{h.t, h.primitive, {}}); }
  PT_HD Hit load_hit() const {
    const StoredHit h = load_wide(&hit);
    return {h.t, h.primitive};
  }

  PT_HD void store_shadow(const ShadowRay& shadow) {
    store_wide(&shadow_origin, pack(shadow.ray.origin, float_to_bits(shadow.distance)));
    store_wide(&shadow_direction, pack(shadow.ray.direction, 0));
    store_wide(&shadow_radiance, pack(shadow.radiance, 0));
  }
  PT_HD Ray load_shadow_ray(float& distance) const {
    const Record o = load_wide(&shadow_origin);
    distance = bits_to_float(o.w);
    return {vec(o), vec(load_wide(&shadow_direction))};
  }

  /// What a free shadow ray brings.
  PT_HD void add_shadow_radiance() {
    const Record sum = load_wide(&radiance);
    store_wide(&radiance, pack(add_rounded(vec(sum), vec(load_wide(&shadow_radiance))), sum.w));
  }
};
static_assert(sizeof(PathSlot) == 128);

}  // namespace pt
