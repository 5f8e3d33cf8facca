// A path between two stages as records of 16 bytes: how they are packed, wherever they lie.
#pragma once

#include "common/transport/intersect.h"
#include "common/transport/path.h"

namespace pt {

struct alignas(16) PathRecord {
  float x, y, z;
  std::uint32_t w;
};

PT_HD PathRecord pack(const Vec3& v, std::uint32_t w) { return {v.x, v.y, v.z, w}; }
PT_HD Vec3 vec(const PathRecord& r) { return {r.x, r.y, r.z}; }

PT_HD PathRecord pack_origin(const Ray& ray, const PathState& path) {
  return pack(ray.origin, float_to_bits(path.bsdf_pdf));
}
PT_HD PathRecord pack_direction(const Ray& ray, const PathState& path) {
  return pack(ray.direction, path.index);
}
PT_HD PathRecord pack_throughput(const PathState& path) {
  return pack(path.beta, path.packed_rays());
}
PT_HD PathRecord pack_shadow_origin(const ShadowRay& shadow) {
  return pack(shadow.ray.origin, float_to_bits(shadow.distance));
}

PT_HD PathRecord pack_medium(const PathMedium& m) {
  return pack({m.travelled, m.densities.red, m.densities.green},
              m.id | std::uint32_t{m.interface_crossings} << 16);
}
PT_HD PathMedium unpack_medium(const PathRecord& r) {
  return {static_cast<std::uint16_t>(r.w), static_cast<std::uint16_t>(r.w >> 16), r.x, {r.y, r.z}};
}

PT_HD void unpack_throughput(const PathRecord& record, PathState& path) {
  path.beta = vec(record);
  path.rays = static_cast<std::uint16_t>(record.w);
  path.shadow_rays = static_cast<std::uint16_t>(record.w >> 16);
}

}  // namespace pt
