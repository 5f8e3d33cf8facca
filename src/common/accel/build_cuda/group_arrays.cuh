// Device memory of a scene's groups: their triangles for the builders, and the trees that are built
// of them one by one.
#pragma once

#include <span>
#include <vector>

#include "common/accel/build_cuda/build_device.h"
#include "common/cuda/cuda_memory.cuh"
#include "common/geometry/mesh.h"

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

/// The memory that the trees of several groups share while they are built. Triangles go straight to
/// their final position, since their count is known. How many nodes a tree has is not: they are
/// collected in blocks, of which there are few however many groups there are, and moved once.
class TreeArrays {
 public:
  /// `memory` keeps the final arrays.
  explicit TreeArrays(CudaMemory& memory) : memory_(memory) {}

  /// Room for the triangles of all trees; comes first.
  void reserve_triangles(std::uint64_t count);
  /// As a DeviceAllocator. An order is valid until the next one is asked for.
  void* take(TreeArray array, std::uint64_t size_bytes);

  /// Moves all nodes to one array and writes `last` behind them. Done when it returns.
  template <class Node>
  const Node* join_nodes(const std::vector<Node>& last) {
    return static_cast<const Node*>(join_bytes(last.data(), last.size() * sizeof(Node)));
  }

  const Triangle* triangles() const { return triangles_; }

 private:
  struct Block {
    char* begin;
    std::uint64_t used, capacity;
  };

  void* take_nodes(std::uint64_t size_bytes);
  void* take_order(std::uint64_t size_bytes);
  const void* join_bytes(const void* last, std::uint64_t last_bytes);

  CudaMemory& memory_;
  CudaMemory temporary_;
  Triangle* triangles_ = nullptr;
  std::uint64_t triangles_used_ = 0;
  std::vector<Block> blocks_;
  std::uint64_t node_bytes_ = 0;
  void* order_ = nullptr;
  std::uint64_t order_bytes_ = 0;
};

}  // namespace pt
