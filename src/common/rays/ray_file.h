// Files of meshes, rays and hits for measuring traversal. Little endian, without padding:
//   mesh  "TRBMESH1" u32 vertices, u32 triangles, f32 xyz[vertices], u32 ijk[triangles]
//   rays  "TRBRAYS1" u64 count, u32 type, u32 reserved[3], then RayRecords
//   hits  "TRBHITS1" u64 count, u32 type, u32 reserved[3], then HitRecords
#pragma once

#include <string>
#include <vector>

#include "common/accel/ray_record.h"
#include "common/geometry/mesh.h"

namespace pt {

struct RaySet {
  RayType type = RayType::closest;
  std::vector<RayRecord> rays;
};

struct HitSet {
  RayType type = RayType::closest;
  std::vector<HitRecord> hits;
};

/// All of them throw Error naming the file and what is wrong: it cannot be read or written, has
/// another kind, type or size than its header says, or holds what is not a mesh (positions that are
/// not finite, indices of no vertex) or a ray (not finite, no direction, t_min < 0).
Mesh read_trace_mesh(const std::string& path);
/// The checks of read_trace_mesh and read_rays, for data in memory.
void check_trace_mesh(const Mesh& mesh, const std::string& name);
void check_rays(const RaySet& rays, const std::string& name);
RaySet read_rays(const std::string& path);
HitSet read_hits(const std::string& path);
void write_trace_mesh(const std::string& path, const Mesh& mesh);
void write_rays(const std::string& path, const RaySet& rays);
void write_hits(const std::string& path, const HitSet& hits);

}  // namespace pt
