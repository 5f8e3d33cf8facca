// The paths in flight, as a structure of arrays: records of 16 bytes, one array per record, so that
// a warp that reads one record of 32 neighbouring slots makes coalesced 128-bit loads. Nothing
// outside this file knows the layout.
#pragma once

#include "common/film/film.h"
#include "common/transport/intersect.h"
#include "common/transport/path.h"

namespace pt {

/// The stage that a slot waits for.
enum class PathTag : std::uint8_t { free, intersect, miss, surface };

struct alignas(16) Record {
  float x, y, z;
  std::uint32_t w;
};

struct alignas(8) HitRecord {
  float t;
  std::uint32_t primitive;
};

struct PathPool {
  std::uint32_t slot_count = 0;
  PathTag* tag = nullptr;
  Record* origin = nullptr;      ///< ray origin, sample
  Record* direction = nullptr;   ///< ray direction, rays | shadow rays << 16
  Record* throughput = nullptr;  ///< beta, pixel
  HitRecord* hit = nullptr;
  // Only in scenes with lights:
  float* bsdf_pdf = nullptr;
  PathTag* shadow_tag = nullptr;       ///< surface: a shadow ray waits; free: none
  Record* shadow_origin = nullptr;     ///< ray origin, distance
  Record* shadow_direction = nullptr;  ///< ray direction, number of the sample
  Record* shadow_radiance = nullptr;   ///< what arrives if the ray is free

  static constexpr std::uint64_t bytes_per_slot(bool has_lights) {
    return sizeof(PathTag) + 3 * sizeof(Record) + sizeof(HitRecord) +
           (has_lights ? sizeof(float) + sizeof(PathTag) + 3 * sizeof(Record) : 0);
  }

  PT_HD static Record pack(const Vec3& v, std::uint32_t w) { return {v.x, v.y, v.z, w}; }
  PT_HD static Vec3 vec(const Record& r) { return {r.x, r.y, r.z}; }

  PT_HD Ray load_ray(std::uint32_t slot) const {
    return {vec(load_wide(&origin[slot])), vec(load_wide(&direction[slot]))};
  }

  /// The ray and the state of its path; `with_pdf` in scenes with lights.
  template <bool with_pdf>
  PT_HD PathState load_path(std::uint32_t slot, Ray& ray) const {
    const Record o = load_wide(&origin[slot]);
    const Record d = load_wide(&direction[slot]);
    const Record b = load_wide(&throughput[slot]);
    ray = {vec(o), vec(d)};
    PathState path;
    path.sample = o.w;
    path.rays = static_cast<std::uint16_t>(d.w);
    path.shadow_rays = static_cast<std::uint16_t>(d.w >> 16);
    path.beta = vec(b);
    path.pixel = b.w;
    if constexpr (with_pdf) path.bsdf_pdf = bsdf_pdf[slot];
    return path;
  }

  template <bool with_pdf>
  PT_HD void store_path(std::uint32_t slot, const Ray& ray, const PathState& path) const {
    store_wide(&origin[slot], pack(ray.origin, path.sample));
    store_wide(&direction[slot],
               pack(ray.direction, path.rays | std::uint32_t{path.shadow_rays} << 16));
    store_wide(&throughput[slot], pack(path.beta, path.pixel));
    if constexpr (with_pdf) bsdf_pdf[slot] = path.bsdf_pdf;
  }

  PT_HD Hit load_hit(std::uint32_t slot) const {
    const HitRecord record = hit[slot];
    return {record.t, record.primitive};
  }
  PT_HD void store_hit(std::uint32_t slot, const Hit& h) const { hit[slot] = {h.t, h.primitive}; }

  PT_HD void store_shadow(std::uint32_t slot, const ShadowRay& shadow, std::uint32_t number) const {
    store_wide(&shadow_origin[slot], pack(shadow.ray.origin, float_to_bits(shadow.distance)));
    store_wide(&shadow_direction[slot], pack(shadow.ray.direction, number));
    store_wide(&shadow_radiance[slot], pack(shadow.radiance, 0));
  }
  PT_HD ShadowRay load_shadow(std::uint32_t slot, std::uint32_t& number) const {
    const Record o = load_wide(&shadow_origin[slot]);
    const Record d = load_wide(&shadow_direction[slot]);
    number = d.w;
    return {{vec(o), vec(d)}, bits_to_float(o.w), vec(load_wide(&shadow_radiance[slot]))};
  }
};

}  // namespace pt
