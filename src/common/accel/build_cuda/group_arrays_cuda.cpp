#include <algorithm>

#include "common/accel/build/instance_tree.h"
#include "common/accel/build/mesh_triangles.h"
#include "common/accel/build_cuda/group_arrays.cuh"
#include "common/cuda/cuda_check.cuh"

namespace pt {
namespace {

/// A mesh and where it comes among all.
struct NumberedMesh {
  const Mesh* mesh;
  std::uint32_t first_id;
};

/// The meshes of the groups in use, group by group.
std::vector<NumberedMesh> meshes_in_use(std::span<const Mesh> meshes,
                                        std::span<const Instance> instances) {
  const std::vector<std::uint32_t> groups = groups_in_use(instances);
  std::vector<NumberedMesh> used;
  std::uint32_t id = 0;
  for (const Mesh& mesh : meshes) {
    const bool is_used = std::binary_search(groups.begin(), groups.end(), mesh.group);
    if (is_used && !mesh.triangles.empty()) used.push_back({&mesh, id});
    id += static_cast<std::uint32_t>(mesh.triangles.size());
  }
  std::stable_sort(used.begin(), used.end(), [](const NumberedMesh& a, const NumberedMesh& b) {
    return a.mesh->group < b.mesh->group;
  });
  return used;
}

/// Groups follow each other in these arrays.
struct SharedArrays {
  Vec3* positions;
  TriangleIndices* indices;
  const MeshRange* ranges;
};

/// The ranges count triangles from their group's first one, and vertices through all.
std::vector<MeshRange> make_ranges(const std::vector<NumberedMesh>& meshes,
                                   std::vector<GroupSource>& groups) {
  std::vector<MeshRange> ranges;
  std::uint32_t first_vertex = 0;
  for (const auto& [mesh, first_id] : meshes) {
    if (groups.empty() || groups.back().group != mesh->group)
      groups.push_back({mesh->group, 0, {}});
    GroupSource& group = groups.back();
    ranges.push_back(
        {group.triangle_count, first_vertex, mesh->material, triangle_attributes(*mesh), first_id});
    group.triangle_count += static_cast<std::uint32_t>(mesh->triangles.size());
    ++group.triangles.range_count;
    first_vertex += static_cast<std::uint32_t>(mesh->positions.size());
  }
  return ranges;
}

template <class T>
T* append(T* device, const std::vector<T>& values) {
  check_cuda(cudaMemcpy(device, values.data(), values.size() * sizeof(T), cudaMemcpyHostToDevice),
             "uploading a mesh");
  return device + values.size();
}

SharedArrays upload(const std::vector<NumberedMesh>& meshes, const std::vector<MeshRange>& ranges,
                    CudaMemory& memory) {
  std::uint64_t vertices = 0, triangles = 0;
  for (const NumberedMesh& m : meshes) {
    vertices += m.mesh->positions.size(), triangles += m.mesh->triangles.size();
  }
  const SharedArrays arrays = {memory.allocate<Vec3>("vertices", vertices),
                               memory.allocate<TriangleIndices>("vertices", triangles),
                               memory.upload("vertices", ranges)};
  Vec3* positions = arrays.positions;
  TriangleIndices* indices = arrays.indices;
  for (const NumberedMesh& m : meshes) {
    positions = append(positions, m.mesh->positions);
    indices = append(indices, m.mesh->triangles);
  }
  return arrays;
}

}  // namespace

std::vector<GroupSource> upload_groups(std::span<const Mesh> meshes,
                                       std::span<const Instance> instances, CudaMemory& memory) {
  const std::vector<NumberedMesh> used = meshes_in_use(meshes, instances);
  std::vector<GroupSource> groups;
  const std::vector<MeshRange> ranges = make_ranges(used, groups);
  const SharedArrays arrays = upload(used, ranges, memory);
  std::uint32_t first_triangle = 0, first_range = 0;
  for (GroupSource& group : groups) {
    group.triangles.positions = arrays.positions;
    group.triangles.indices = arrays.indices + first_triangle;
    group.triangles.ranges = arrays.ranges + first_range;
    first_triangle += group.triangle_count;
    first_range += group.triangles.range_count;
  }
  return groups;
}

void TreeArrays::reserve_triangles(std::uint64_t count) {
  triangles_ = memory_.allocate<Triangle>("triangles", count);
}

void* TreeArrays::take(TreeArray array, std::uint64_t size_bytes) {
  if (array == TreeArray::nodes) return take_nodes(size_bytes);
  if (array == TreeArray::order) return take_order(size_bytes);
  Triangle* place = triangles_ + triangles_used_;
  triangles_used_ += size_bytes / sizeof(Triangle);
  return place;
}

void* TreeArrays::take_nodes(std::uint64_t size_bytes) {
  if (blocks_.empty() || blocks_.back().used + size_bytes > blocks_.back().capacity) {
    constexpr std::uint64_t least = 1 << 20;
    // In proportion to what there is: the number of blocks grows with its logarithm.
    const std::uint64_t capacity = std::max({size_bytes, node_bytes_ / 4, least});
    blocks_.push_back({temporary_.allocate<char>("nodes", capacity), 0, capacity});
  }
  Block& block = blocks_.back();
  char* place = block.begin + block.used;
  block.used += size_bytes;
  node_bytes_ += size_bytes;
  return place;
}

void* TreeArrays::take_order(std::uint64_t size_bytes) {
  if (size_bytes > order_bytes_) {
    order_ = temporary_.allocate<char>("order", size_bytes);
    order_bytes_ = size_bytes;
  }
  return order_;
}

const void* TreeArrays::join_bytes(const void* last, std::uint64_t last_bytes) {
  char* nodes = memory_.allocate<char>("acceleration structure", node_bytes_ + last_bytes);
  char* next = nodes;
  for (const Block& block : blocks_) {
    check_cuda(cudaMemcpyAsync(next, block.begin, block.used, cudaMemcpyDeviceToDevice),
               "moving nodes");
    next += block.used;
  }
  if (last_bytes > 0) {
    check_cuda(cudaMemcpy(next, last, last_bytes, cudaMemcpyHostToDevice), "uploading nodes");
  }
  // The kernels that read them run in streams that do not wait for the default one.
  check_cuda(cudaStreamSynchronize(nullptr), "moving nodes");
  return nodes;
}

}  // namespace pt
