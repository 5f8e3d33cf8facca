// The paths in flight, as a structure of arrays: records of 16 bytes, one array per record, so that
// a warp that reads one record of 32 neighbouring slots makes coalesced 128-bit loads. Nothing
// outside this file knows the layout.
#pragma once

#include "common/film/film.h"
#include "common/render/stage_info.h"
#include "common/transport/intersect.h"
#include "common/transport/path.h"

namespace pt {

/// The tag of a slot is the stage in whose queue it waits. A free one waits for a new path; what is
/// filled with zeros is free.
inline constexpr StageId free_slot = StageId::generate;
static_assert(static_cast<int>(free_slot) == 0);

struct alignas(16) Record {
  float x, y, z;
  std::uint32_t w;
};

struct alignas(8) StoredHit {
  float t;
  std::uint32_t primitive;
};

/// What has happened to a path and where it goes is all in three records. A miss needs only two,
/// and to a new path nothing has happened: its throughput is 1 and is neither stored nor loaded.
struct PathPool {
  std::uint32_t slot_count = 0;
  Record* origin = nullptr;      ///< ray origin, density of the BSDF
  Record* direction = nullptr;   ///< ray direction, number of the path | new_path
  Record* throughput = nullptr;  ///< beta, rays | shadow rays << 16
  StoredHit* hit = nullptr;
  std::uint32_t* hit_instance = nullptr;  ///< only in scenes with instances
  Receiver* receiver = nullptr;           ///< only where a tree of lights asks for it
  // Only with compaction over tags:
  StageId* tag = nullptr;
  StageId* shadow_tag = nullptr;  ///< shadow, or free_slot: no shadow ray waits
  // Only in scenes with lights:
  Record* shadow_origin = nullptr;     ///< ray origin, distance
  Record* shadow_direction = nullptr;  ///< ray direction, number of the path
  Record* shadow_radiance = nullptr;   ///< what arrives if the ray is free, rays of the path

  static constexpr std::uint32_t new_path = 0x80000000u;  ///< numbers are below 2^31

  /// What a pool for these scenes has: `tags` for compaction over tags.
  struct Parts {
    bool lights, instances, tags, receivers;
  };

  /// Sets each array that a pool of `slot_count` slots needs to allocate(T*{}, bytes of a T): the
  /// only list of them.
  template <class Allocate>
  void allocate_arrays(const Parts& parts, Allocate&& allocate) {
    const auto make = [&](auto*& array, bool needed) {
      if (needed) array = allocate(array);
    };
    make(origin, true), make(direction, true), make(throughput, true), make(hit, true);
    make(hit_instance, parts.instances);
    make(receiver, parts.receivers);
    make(tag, parts.tags);
    make(shadow_tag, parts.tags && parts.lights);
    make(shadow_origin, parts.lights), make(shadow_direction, parts.lights);
    make(shadow_radiance, parts.lights);
  }

  static std::uint64_t bytes_per_slot(const Parts& parts) {
    std::uint64_t sum = 0;
    PathPool().allocate_arrays(parts, [&](auto* array) {
      sum += sizeof *array;
      return array;
    });
    return sum;
  }

  PT_HD static Record pack(const Vec3& v, std::uint32_t w) { return {v.x, v.y, v.z, w}; }
  PT_HD static Vec3 vec(const Record& r) { return {r.x, r.y, r.z}; }

  PT_HD Ray load_ray(std::uint32_t slot) const {
    return {vec(load_wide(&origin[slot])), vec(load_wide(&direction[slot]))};
  }

  /// The path and its ray, of which a miss needs the direction only.
  PT_HD PathState load_path(std::uint32_t slot, Vec3& ray_direction) const {
    const Record d = load_wide(&direction[slot]);
    ray_direction = vec(d);
    PathState path;
    path.number = d.w & ~new_path;
    if ((d.w & new_path) == 0) {
      const Record b = load_wide(&throughput[slot]);
      path.beta = vec(b);
      path.rays = static_cast<std::uint16_t>(b.w);
      path.shadow_rays = static_cast<std::uint16_t>(b.w >> 16);
    }
    return path;
  }

  PT_HD PathState load_path(std::uint32_t slot, Ray& ray) const {
    const Record o = load_wide(&origin[slot]);
    PathState path = load_path(slot, ray.direction);
    ray.origin = vec(o);
    path.bsdf_pdf = bits_to_float(o.w);
    if (receiver != nullptr) path.receiver = receiver[slot];
    return path;
  }

  PT_HD void store_new_path(std::uint32_t slot, const Ray& ray, std::uint32_t number) const {
    store_wide(&origin[slot], pack(ray.origin, float_to_bits(PathState::delta_distribution)));
    store_wide(&direction[slot], pack(ray.direction, number | new_path));
  }

  PT_HD void store_path(std::uint32_t slot, const Ray& ray, const PathState& path) const {
    store_wide(&origin[slot], pack(ray.origin, float_to_bits(path.bsdf_pdf)));
    store_wide(&direction[slot], pack(ray.direction, path.number));
    store_wide(&throughput[slot], pack(path.beta, path.packed_rays()));
    if (receiver != nullptr) receiver[slot] = path.receiver;
  }

  /// The path's number and rays alone.
  PT_HD PathState load_name(std::uint32_t slot) const {
    PathState path;
    path.number = direction[slot].w;
    if ((path.number & new_path) == 0) path.rays = static_cast<std::uint16_t>(throughput[slot].w);
    path.number &= ~new_path;
    return path;
  }

  PT_HD Hit load_hit(std::uint32_t slot) const {
    const StoredHit record = hit[slot];
    return {record.t, record.primitive, hit_instance != nullptr ? hit_instance[slot] : 0};
  }
  PT_HD void store_hit(std::uint32_t slot, const Hit& h) const {
    hit[slot] = {h.t, h.primitive};
    if (hit_instance != nullptr) hit_instance[slot] = h.instance;
  }

  PT_HD void store_shadow(std::uint32_t slot, const ShadowRay& shadow,
                          const PathState& path) const {
    store_wide(&shadow_origin[slot], pack(shadow.ray.origin, float_to_bits(shadow.distance)));
    store_wide(&shadow_direction[slot], pack(shadow.ray.direction, path.number));
    store_wide(&shadow_radiance[slot], pack(shadow.radiance, path.rays));
  }
  /// Of the path when it asked.
  PT_HD std::uint32_t load_shadow_rays(std::uint32_t slot) const { return shadow_radiance[slot].w; }
  PT_HD ShadowRay load_shadow(std::uint32_t slot, std::uint32_t& number) const {
    const Record o = load_wide(&shadow_origin[slot]);
    const Record d = load_wide(&shadow_direction[slot]);
    number = d.w;
    return {{vec(o), vec(d)}, bits_to_float(o.w), vec(load_wide(&shadow_radiance[slot]))};
  }
};

}  // namespace pt
