// The paths in flight, in records of 16 bytes. As a structure of arrays (--layout soa) each record
// has an array of its own, so that a warp that reads one record of 32 neighbouring slots makes
// coalesced 128-bit loads; as an array of structures (aos) all that a slot has lies side by side.
// In between (sectors) the two records of a ray, which are always needed together, share a sector
// of the memory, so that slots that are not neighbours waste nothing. Nothing outside this file
// knows the layout.
#pragma once

#include <cstddef>

#include "common/film/film.h"
#include "common/medium/free_flight.h"
#include "common/options/options.h"
#include "common/options/stage_info.h"
#include "common/transport/extra_state.h"
#include "common/transport/path_records.h"

namespace pt {

/// The tag of a slot is the stage in whose queue it waits. A free one waits for a new path; what is
/// filled with zeros is free.
inline constexpr StageId free_slot = StageId::generate;
static_assert(static_cast<int>(free_slot) == 0);

struct alignas(8) StoredHit {
  float t;
  std::uint32_t primitive;
};

/// What has happened to a path and where it goes is all in three records. A miss needs only two,
/// and to a new path nothing has happened: its throughput is 1 and is neither stored nor loaded.
struct PathPool {
  /// Bytes from a slot's element to the next slot's, by the size of the elements: that size where
  /// each has its array, the size of all that a slot has where that lies side by side. Run-time
  /// values, so both layouts are one code: the address of an element is a product and a sum anyway.
  struct Strides {
    std::uint32_t ray = sizeof(PathRecord);  ///< of a record that is half of a ray
    std::uint32_t record = sizeof(PathRecord), hit = sizeof(StoredHit), flight = sizeof(FreeFlight),
                  word = sizeof(std::uint32_t);
  };

  std::uint32_t slot_count = 0;
  Strides strides;
  // The records of slot 0; at(field, slot) and, for a ray's two, half_at(field, slot) find others.
  PathRecord* origin = nullptr;      ///< ray origin, density of the BSDF
  PathRecord* direction = nullptr;   ///< ray direction, index of the path | new_path
  PathRecord* throughput = nullptr;  ///< beta, rays | shadow rays << 16
  StoredHit* hit = nullptr;
  std::uint32_t* hit_instance = nullptr;  ///< only in scenes with instances
  Receiver* receiver = nullptr;           ///< only for a light tree
  PathRecord* medium = nullptr;           ///< only in scenes with media: pack_medium
  FreeFlight* flight = nullptr;           ///< only where flights take several waves
  // Only in scenes with lights:
  PathRecord* shadow_origin = nullptr;     ///< ray origin, distance
  PathRecord* shadow_direction = nullptr;  ///< ray direction, index of the path
  PathRecord* shadow_radiance = nullptr;   ///< contribution if not occluded, rays of the path
  // Only with compaction over tags; arrays in both layouts, since a pass reads them alone:
  StageId* tag = nullptr;
  StageId* shadow_tag = nullptr;  ///< shadow, or free_slot: no shadow ray waits
  ExtraState extra;               ///< only with --path-bytes

  static constexpr std::uint32_t new_path = 0x80000000u;  ///< indices are below 2^31

  /// What a pool for these scenes has: `tags` for compaction over tags.
  struct Fields {
    bool lights = false, instances = false, tags = false, receivers = false;
    PoolLayout layout = PoolLayout::soa;
    bool hits = true;  ///< false: none is stored
    bool media = false;
    bool flights = false;
    std::uint32_t extra_records = 0;
  };

  /// Sets what a pool of `slot_count` slots needs to allocate(T*{}, count), room for `count` of T,
  /// aligned to 16 bytes: the only list of it.
  template <class Allocate>
  void allocate_arrays(const Fields& fields, Allocate&& allocate) {
    const std::uint64_t n = slot_count;
    if (fields.layout == PoolLayout::aos) {
      const std::uint32_t slot_bytes = fields_bytes(fields);
      strides = {slot_bytes, slot_bytes, slot_bytes, slot_bytes, slot_bytes};
      std::byte* const slot_0 = allocate(static_cast<std::byte*>(nullptr), n * slot_bytes);
      std::uint32_t end = 0;
      for_each_field(fields, [&]<class T>(T*& field) {
        field = reinterpret_cast<T*>(slot_0 + next_offset<T>(end));
      });
      extra = {reinterpret_cast<char*>(slot_0) + next_offset<PathRecord>(end), fields.extra_records,
               slot_bytes, 4, 0};
    } else {
      if (fields.layout == PoolLayout::sectors) {
        strides.ray = 2 * sizeof(PathRecord);
        for_each_ray(fields, [&](PathRecord*& first, PathRecord*& second) {
          first = allocate(first, 2 * n), second = first + 1;
        });
      }
      for_each_field(fields, [&](auto*& field) {
        if (field == nullptr) field = allocate(field, n);
      });
      if (fields.extra_records > 0) {
        const std::uint32_t row_bytes = extra_row(fields) * extra_record_bytes;
        std::byte* const all = allocate(static_cast<std::byte*>(nullptr), n * extra_bytes(fields));
        extra = {reinterpret_cast<char*>(all), fields.extra_records, row_bytes,
                 extra_row(fields) - 1, n * row_bytes};
      }
    }
    for_each_tag(fields, [&](StageId*& tags) { tags = allocate(tags, n); });
  }

  /// What allocate_arrays takes for each slot.
  static std::uint64_t bytes_per_slot(const Fields& fields) {
    std::uint64_t sum = 0;
    const auto add = [&](auto* field) { sum += sizeof *field; };
    PathPool pool;
    pool.for_each_tag(fields, add);
    if (fields.layout == PoolLayout::aos) return sum + fields_bytes(fields);
    pool.for_each_field(fields, add);
    return sum + extra_bytes(fields);
  }

  /// Where the slot's element of a field is: at(throughput, slot).
  PT_HD PathRecord* at(PathRecord* field, std::uint32_t slot) const {
    return step(field, slot, strides.record);
  }
  /// Likewise of origin, direction and those of the shadow ray.
  PT_HD PathRecord* half_at(PathRecord* field, std::uint32_t slot) const {
    return step(field, slot, strides.ray);
  }
  PT_HD StoredHit* at(StoredHit* field, std::uint32_t slot) const {
    return step(field, slot, strides.hit);
  }
  PT_HD FreeFlight* at(FreeFlight* field, std::uint32_t slot) const {
    return step(field, slot, strides.flight);
  }
  template <class Word>
  PT_HD Word* at(Word* field, std::uint32_t slot) const {
    static_assert(sizeof(Word) == sizeof(std::uint32_t));
    return step(field, slot, strides.word);
  }

  PT_HD Ray load_ray(std::uint32_t slot) const {
    return {vec(load_wide(half_at(origin, slot))), vec(load_wide(half_at(direction, slot)))};
  }

  /// The path and its ray, of which a miss needs the direction only.
  PT_HD PathState load_path(std::uint32_t slot, Vec3& ray_direction) const {
    const PathRecord d = load_wide(half_at(direction, slot));
    ray_direction = vec(d);
    PathState path;
    path.index = d.w & ~new_path;
    if ((d.w & new_path) == 0) unpack_throughput(load_wide(at(throughput, slot)), path);
    return path;
  }

  PT_HD PathState load_path(std::uint32_t slot, Ray& ray) const {
    const PathRecord o = load_wide(half_at(origin, slot));
    PathState path = load_path(slot, ray.direction);
    ray.origin = vec(o);
    path.bsdf_pdf = bits_to_float(o.w);
    if (receiver != nullptr) path.receiver = *at(receiver, slot);
    return path;
  }

  // In scenes with media:
  PT_HD void load_medium(std::uint32_t slot, PathState& path) const {
    path.medium = unpack_medium(load_wide(at(medium, slot)));
  }
  PT_HD void store_medium(std::uint32_t slot, const PathState& path) const {
    store_wide(at(medium, slot), pack_medium(path.medium));
  }
  PT_HD bool is_in_medium(std::uint32_t slot) const {
    PathState path;
    load_medium(slot, path);
    return path.medium.id != no_medium;
  }
  /// Where the flight of the path's next ray has got in earlier waves.
  PT_HD FreeFlight load_flight(std::uint32_t slot) const {
    return flight != nullptr ? *at(flight, slot) : FreeFlight();
  }
  PT_HD void store_flight(std::uint32_t slot, const FreeFlight& f) const {
    if (flight != nullptr) *at(flight, slot) = f;
  }

  PT_HD void store_new_path(std::uint32_t slot, const Ray& ray, std::uint32_t path_index) const {
    store_wide(half_at(origin, slot), pack_origin(ray, PathState()));
    store_wide(half_at(direction, slot), pack(ray.direction, path_index | new_path));
  }

  PT_HD void store_path(std::uint32_t slot, const Ray& ray, const PathState& path) const {
    store_wide(half_at(origin, slot), pack_origin(ray, path));
    store_wide(half_at(direction, slot), pack_direction(ray, path));
    store_wide(at(throughput, slot), pack_throughput(path));
    if (receiver != nullptr) *at(receiver, slot) = path.receiver;
  }

  /// `lanes` for the next ray of the path.
  PT_HD LaneCounter path_lanes(const LaneCounter& lanes, std::uint32_t slot) const {
    if constexpr (counts_lanes) return lanes.at(load_path_id(slot).rays);
    return lanes;
  }
  /// `lanes` for its shadow ray.
  PT_HD LaneCounter shadow_lanes(const LaneCounter& lanes, std::uint32_t slot) const {
    if constexpr (counts_lanes) return lanes.at(load_shadow_rays(slot) - 1).of_shadow_ray();
    return lanes;
  }

  /// The path's index and its count of rays alone.
  PT_HD PathState load_path_id(std::uint32_t slot) const {
    PathState path;
    path.index = half_at(direction, slot)->w;
    if ((path.index & new_path) == 0)
      path.rays = static_cast<std::uint16_t>(at(throughput, slot)->w);
    path.index &= ~new_path;
    return path;
  }

  PT_HD Hit load_hit(std::uint32_t slot) const {
    const StoredHit record = *at(hit, slot);
    return {record.t, record.primitive, hit_instance != nullptr ? *at(hit_instance, slot) : 0};
  }
  PT_HD void store_hit(std::uint32_t slot, const Hit& h) const {
    *at(hit, slot) = {h.t, h.primitive};
    if (hit_instance != nullptr) *at(hit_instance, slot) = h.instance;
  }

  PT_HD void store_shadow_ray(std::uint32_t slot, const ShadowRay& shadow,
                              const PathState& path) const {
    store_wide(half_at(shadow_origin, slot), pack_shadow_origin(shadow));
    store_wide(half_at(shadow_direction, slot), pack(shadow.ray.direction, path.index));
  }
  PT_HD void store_shadow_radiance(std::uint32_t slot, const Color& radiance,
                                   const PathState& path) const {
    store_wide(at(shadow_radiance, slot), pack(radiance, path.rays));
  }
  /// In scenes with media also stores the medium in which the shadow ray begins.
  PT_HD void store_shadow_radiance(std::uint32_t slot, const ShadowRay& shadow,
                                   const PathState& path) const {
    store_wide(at(shadow_radiance, slot),
               pack(shadow.radiance, path.rays | std::uint32_t{shadow.medium_id} << 16));
  }
  PT_HD void dim_shadow(std::uint32_t slot, const Color& transmittance) const {
    const PathRecord r = load_wide(at(shadow_radiance, slot));
    store_wide(at(shadow_radiance, slot), pack(vec(r) * transmittance, r.w));
  }
  /// The rays that the path had traced when it cast the shadow ray.
  PT_HD std::uint32_t load_shadow_rays(std::uint32_t slot) const {
    return at(shadow_radiance, slot)->w & 0xffffu;
  }
  PT_HD std::uint16_t load_shadow_medium_id(std::uint32_t slot) const {
    return static_cast<std::uint16_t>(at(shadow_radiance, slot)->w >> 16);
  }
  PT_HD ShadowRay load_shadow(std::uint32_t slot, std::uint32_t& path_index) const {
    const PathRecord o = load_wide(half_at(shadow_origin, slot));
    const PathRecord d = load_wide(half_at(shadow_direction, slot));
    path_index = d.w;
    return {{vec(o), vec(d)}, bits_to_float(o.w), vec(load_wide(at(shadow_radiance, slot)))};
  }

 private:
  /// Records side by side where they have arrays: two share a sector as a ray's do.
  static constexpr std::uint32_t extra_row(const Fields& fields) {
    return fields.layout == PoolLayout::sectors ? 2 : 1;
  }
  /// Of a slot; whole rows.
  static constexpr std::uint32_t extra_bytes(const Fields& fields) {
    const std::uint32_t row = fields.layout == PoolLayout::aos ? 1 : extra_row(fields);
    return (fields.extra_records + row - 1) / row * row * extra_record_bytes;
  }

  // All that a slot has, in the order in which it lies side by side, but for its extra records.
  template <class Function>
  void for_each_field(const Fields& fields, Function&& function) {
    function(origin), function(direction), function(throughput);
    if (fields.hits) function(hit);
    if (fields.hits && fields.instances) function(hit_instance);
    if (fields.receivers) function(receiver);
    if (fields.media) function(medium);
    if (fields.flights) function(flight);
    if (!fields.lights) return;
    function(shadow_origin), function(shadow_direction), function(shadow_radiance);
  }
  template <class Function>
  void for_each_ray(const Fields& fields, Function&& function) {
    function(origin, direction);
    if (fields.lights) function(shadow_origin, shadow_direction);
  }
  template <class Function>
  void for_each_tag(const Fields& fields, Function&& function) {
    if (fields.tags) function(tag);
    if (fields.tags && fields.lights) function(shadow_tag);
  }

  /// The offset of a T behind `end` bytes; `end` then includes it.
  template <class T>
  static std::uint32_t next_offset(std::uint32_t& end) {
    constexpr std::uint32_t alignment = alignof(T);
    const std::uint32_t offset = (end + alignment - 1) / alignment * alignment;
    end = offset + sizeof(T);
    return offset;
  }

  /// The size of all fields side by side, padded so that the next slot has the same alignment.
  static std::uint32_t fields_bytes(const Fields& fields) {
    std::uint32_t end = 0;
    PathPool().for_each_field(fields, [&]<class T>(T*) { next_offset<T>(end); });
    return next_offset<PathRecord>(end) + extra_bytes(fields);
  }

  template <class T>
  PT_HD static T* step(T* field, std::uint32_t slot, std::uint32_t stride_bytes) {
    // 64 bits: a large pool has more than 4 GiB.
    const std::uint64_t distance = std::uint64_t{slot} * stride_bytes;
    return reinterpret_cast<T*>(reinterpret_cast<char*>(field) + distance);
  }
};

/// Adds to the path's sample.
PT_HD void add_radiance(const SampleBuffer& samples, std::uint32_t path_index,
                        const Color& radiance) {
  if (is_black(radiance)) return;
  Color& sum = samples.samples[path_index].radiance;
  sum += radiance;
}

}  // namespace pt
