// The steps of a build on the device, as functions that launch kernels in the default stream.
#pragma once

#include "common/accel/build/binary/build_tree.h"
#include "common/accel/build/morton_order.h"
#include "common/accel/build_cuda/build_device.h"
#include "common/accel/build_cuda/reinsertion.h"

namespace pt::device_build {

/// Bounds while many threads grow them: floats as integers in the same order, the maxima inverted,
/// so that all begin as ones and only shrink. [0..2] of centers' minima, [3..5] of their maxima,
/// then the same of the boxes.
struct SharedBounds {
  std::uint32_t bits[12];
  std::uint32_t is_bad;  ///< starts as ones; 0: some box is not finite or too large
};

PT_HD std::uint32_t ordered_bits(float x) {
  const std::uint32_t bits = float_to_bits(x);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}
PT_HD float from_ordered_bits(std::uint32_t bits) {
  return bits_to_float((bits & 0x80000000u) != 0 ? bits & 0x7fffffffu : ~bits);
}
PT_HD Bounds read_bounds(const SharedBounds& shared, int first) {
  Bounds box;
  for (int i = 0; i < 3; ++i) {
    box.min[i] = from_ordered_bits(shared.bits[first + i]);
    box.max[i] = from_ordered_bits(~shared.bits[first + 3 + i]);
  }
  return box;
}

void enqueue_bounds(const TriangleSource& source, std::uint32_t count, BuildNode* primitives,
                    SharedBounds* bounds);

/// Two buffers of keys and of values; sorting may swap them.
struct SortBuffers {
  std::uint64_t* keys[2];
  std::uint32_t* values[2];
};

void enqueue_morton(const BuildNode* primitives, std::uint32_t count, const SharedBounds* bounds,
                    const SortBuffers& buffers);

std::uint64_t sort_scratch_bytes(std::uint32_t count);
/// The sorted arrays are the first ones afterwards. Stable.
void enqueue_sort(SortBuffers& buffers, std::uint32_t count, void* scratch,
                  std::uint64_t scratch_bytes);

/// prefixes[0..count]: of i - 1 and i; the ends are 0. Without `by_code` indices alone count.
void enqueue_prefixes(const std::uint64_t* keys, std::uint32_t count, bool by_code,
                      std::uint8_t* prefixes);

/// The input and output of the hierarchy builders.
struct HierarchyJob {
  std::uint32_t count = 0;  ///< at least 1
  const std::uint32_t* order = nullptr;
  const std::uint8_t* prefixes = nullptr;
  const BuildNode* primitives = nullptr;
  BuildNode* nodes = nullptr;       ///< [count]; H-PLOC's unused one has no_node for its children
  CollapseTable* tables = nullptr;  ///< [count] or null: not needed
  float* binary_costs = nullptr;    ///< likewise
  TreeCosts costs;
  std::uint64_t* pairs = nullptr;   ///< [count], for the builder's use
  std::uint32_t* ranges = nullptr;  ///< [count], likewise, for H-PLOC
  TreeRef* root = nullptr;
};

void enqueue_lbvh(const HierarchyJob& job);
void enqueue_hploc(const HierarchyJob& job);

/// Makes H-PLOC's tree cheaper, and then finds the costs that `hierarchy` asks for.
void enqueue_reinsertion(ReinsertionJob job, const HierarchyJob& hierarchy);

/// Counters of a collapse, which start as zeros. Allocation is one atomic operation for both.
struct CollapseCounters {
  unsigned long long allocated;  ///< nodes in the upper half, slots in the lower
  std::uint32_t depth;
  std::uint32_t overflowed;  ///< more nodes than allocated
};

struct CollapseJob {
  BuildTree tree;
  const TreeRef* root = nullptr;
  std::uint32_t count = 0;     ///< primitives
  std::uint32_t capacity = 0;  ///< nodes
  TreeCosts costs;
  std::uint32_t first_node = 0, first_slot = 0;
  std::uint64_t* queue = nullptr;  ///< [capacity], starts as ones
  std::uint32_t* order = nullptr;  ///< [count]: slot -> primitive
  CollapseCounters* counters = nullptr;
};

void enqueue_collapse(const CollapseJob& job, Bvh2Node* nodes);
void enqueue_collapse(const CollapseJob& job, CwbvhNode* nodes);

void enqueue_triangles(const TriangleSource& source, const std::uint32_t* order,
                       std::uint32_t count, Triangle* triangles);

/// Sums over the nodes of a tree; starts as zeros. Areas are halves, of the children's boxes.
struct QualitySums {
  double node_area, triangle_area;
  unsigned long long leaves, slots;
};

void enqueue_quality(const Bvh2Node* nodes, std::uint32_t count, QualitySums* sums);
void enqueue_quality(const CwbvhNode* nodes, std::uint32_t count, QualitySums* sums);

}  // namespace pt::device_build
