// Builds trees over triangles on the CUDA device. Host-facing: no CUDA types.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/tree_statistics.h"
#include "common/accel/nodes.h"
#include "common/accel/triangle_tree.h"
#include "common/geometry/mesh.h"
#include "common/geometry/triangle.h"

namespace pt {

/// Triangles [first_triangle, the next range's first) belong to one mesh.
struct MeshRange {
  std::uint32_t first_triangle = 0;
  std::uint32_t first_vertex = 0;  ///< added to the indices
  std::uint32_t material = 0;
  std::uint32_t attributes = 0;  ///< see TriangleAttributes
  std::uint32_t first_id = 0;    ///< of the first triangle; the others' follow
};

/// Triangles in device memory: finished records by id, or vertices and indices of meshes.
struct TriangleSource {
  const Triangle* records = nullptr;
  const Vec3* positions = nullptr;
  const TriangleIndices* indices = nullptr;
  const MeshRange* ranges = nullptr;  ///< ascending, the first begins at 0; null: one, all zero
  std::uint32_t range_count = 0;
};

enum class DeviceBuilder {
  lbvh,            ///< Karras 2012, built bottom-up as Apetrei 2014
  hploc,           ///< Benthin et al. 2024
  hploc_reinsert,  ///< and then reinsertion (Meister and Bittner 2018)
  balanced,  ///< halves along the Morton curve: poor, but no deeper than log2 of the triangles
};
enum class TreeFormat { bvh2, cwbvh };

struct DeviceBuildOptions {
  DeviceBuilder builder = DeviceBuilder::hploc;
  TreeFormat format = TreeFormat::cwbvh;
  TreeCosts costs = default_cwbvh_costs;  ///< of the format: default_bvh2_costs for the other
  int depth_max = bvh_depth_max;
  std::uint32_t first_node = 0;  ///< added to node numbers: for trees that share arrays
  std::uint32_t first_slot = 0;  ///< added to slot numbers
};

/// Kernel times; the sum of all is the build's time without allocations.
struct DeviceBuildTimes {
  float bounds_ms = 0;       ///< boxes of the primitives and of the scene
  float morton_ms = 0;       ///< codes
  float sort_ms = 0;         ///< and the prefixes of neighbours
  float hierarchy_ms = 0;    ///< the binary tree
  float reinsertion_ms = 0;  ///< what makes it cheaper
  float collapse_ms = 0;     ///< the nodes for traversal
  float triangles_ms = 0;    ///< their records

  float total_ms() const {
    return bounds_ms + morton_ms + sort_ms + hierarchy_ms + reinsertion_ms + collapse_ms +
           triangles_ms;
  }
};

/// In device memory, which belongs to the allocator's owner.
struct DeviceTree {
  Bvh2Node* bvh2 = nullptr;
  CwbvhNode* cwbvh = nullptr;
  std::uint32_t* order = nullptr;  ///< [slot]: the primitive
  Triangle* triangles = nullptr;   ///< [slot]
  std::uint32_t node_count = 0;
  std::uint32_t slot_count = 0;  ///< as many as primitives
  int depth = 0;                 ///< nodes from the root to the deepest one
  Bounds bounds;
  DeviceBuilder builder = DeviceBuilder::hploc;  ///< another than asked for where that was too deep
  DeviceBuildTimes times;
  std::uint64_t scratch_bytes = 0;  ///< of temporary memory
};

/// The arrays of a tree.
enum class TreeArray { nodes, order, triangles };

/// Gives device memory for an array, aligned as its elements are, or throws Error. Each build asks
/// once for each, the triangles last.
using DeviceAllocator = std::function<void*(TreeArray array, std::uint64_t size_bytes)>;

/// Keeps its temporary memory (about 200 bytes per primitive) from one build to the next. All work
/// is in the default stream of the current device, and is done when a function returns.
class DeviceTreeBuilder {
 public:
  explicit DeviceTreeBuilder(DeviceAllocator allocate);
  ~DeviceTreeBuilder();

  /// The tree over `count` triangles, 0..tree_primitives_max; none has no nodes. Throws Error for
  /// more, for coordinates that are not finite or beyond 1e12, and for trees deeper than allowed.
  DeviceTree build(const TriangleSource& source, std::uint32_t count,
                   const DeviceBuildOptions& options);

  TreeQuality measure(const DeviceTree& tree);

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace pt
