// The triangles of a scene's groups in device memory, for the builders.
#pragma once

#include <span>
#include <vector>

#include "common/accel/build_cuda/build_device.h"
#include "common/cuda/cuda_memory.cuh"
#include "common/geometry/instance.h"

namespace pt {

struct GroupSource {
  std::uint32_t group = 0;
  std::uint32_t triangle_count = 0;
  TriangleSource triangles;
};

/// Uploads the meshes of group 0 and of the instances' groups into `memory`. Triangles have the
/// numbers that they have among all meshes. Groups without triangles are left out.
std::vector<GroupSource> upload_groups(std::span<const Mesh> meshes,
                                       std::span<const Instance> instances, CudaMemory& memory);

}  // namespace pt
