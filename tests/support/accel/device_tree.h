// What the tests of the builders on CUDA share.
#pragma once

#include <cstring>

#include "accel/build_cases.h"
#include "accel/check_tree.h"
#include "common/accel/build_cuda/build_device.h"
#include "common/cuda/cuda_memory.cuh"
#include "cuda_test.h"

namespace pt {

inline const char* name_of(DeviceBuilder builder) {
  return builder == DeviceBuilder::lbvh             ? "lbvh"
         : builder == DeviceBuilder::hploc          ? "hploc"
         : builder == DeviceBuilder::hploc_reinsert ? "hploc-reinsert"
                                                    : "balanced";
}

inline std::string name_of(const DeviceBuildOptions& options) {
  return std::string(name_of(options.builder)) +
         (options.format == TreeFormat::cwbvh ? " cwbvh" : " bvh2");
}

inline DeviceBuildOptions binary_options() {
  DeviceBuildOptions options;
  options.format = TreeFormat::bvh2;
  options.costs = default_bvh2_costs;
  return options;
}

inline std::vector<DeviceBuildOptions> all_options() {
  std::vector<DeviceBuildOptions> all;
  for (const DeviceBuilder builder : {DeviceBuilder::lbvh, DeviceBuilder::hploc,
                                      DeviceBuilder::hploc_reinsert, DeviceBuilder::balanced}) {
    for (DeviceBuildOptions options : {binary_options(), DeviceBuildOptions{}}) {
      options.builder = builder;
      options.depth_max = 1000;  // some cases are deep; nothing is to be replaced here
      all.push_back(options);
    }
  }
  return all;
}

/// A tree in host memory, its nodes and slots at their absolute places.
struct HostTree {
  TriangleTreeData data;
  std::vector<std::uint32_t> order;  ///< [slot - first_slot]
  std::uint32_t first_slot = 0;

  TreeQuality quality() const {
    return data.bvh2.empty() ? measure_tree(std::span(data.cwbvh), data.root)
                             : measure_tree(std::span(data.bvh2), data.root);
  }
};

template <class T>
std::vector<T> download(const T* from, std::size_t count, std::size_t first = 0) {
  std::vector<T> values(from == nullptr ? 0 : first + count);
  if (from == nullptr) return values;
  check_cuda(cudaMemcpy(values.data() + first, from, count * sizeof(T), cudaMemcpyDeviceToHost),
             "download");
  return values;
}

inline HostTree download(const DeviceTree& tree, const DeviceBuildOptions& options) {
  HostTree host;
  host.data.bvh2 = download(tree.bvh2, tree.node_count, options.first_node);
  host.data.cwbvh = download(tree.cwbvh, tree.node_count, options.first_node);
  host.data.triangles = download(tree.triangles, tree.slot_count, options.first_slot);
  host.data.root = options.first_node;
  host.order = download(tree.order, tree.slot_count);
  host.first_slot = options.first_slot;
  return host;
}

/// Every node once, every slot in one leaf, every box around what is in it. `by_slot` counts from
/// the first slot.
inline void check_nodes(const HostTree& tree, const std::vector<Bounds>& by_slot) {
  TreeWalk walk(tree.data);
  walk.walk(tree.data.root);
  for (std::size_t i = 0; i < walk.node_visits.size(); ++i) {
    ASSERT_EQ(walk.node_visits[i], i < tree.data.root ? 0 : 1) << "node " << i;
  }
  std::vector<int> seen(by_slot.size());
  for (const LeafPlace& leaf : walk.leaves) {
    for (std::uint32_t i = 0; i < leaf.count; ++i) {
      const std::size_t slot = leaf.first + i - tree.first_slot;
      ASSERT_LT(slot, seen.size());
      ++seen[slot];
      EXPECT_TRUE(leaf.box.contains(by_slot[slot].min)) << "slot " << slot;
      EXPECT_TRUE(leaf.box.contains(by_slot[slot].max)) << "slot " << slot;
    }
  }
  EXPECT_EQ(seen, std::vector<int>(seen.size(), 1));
}

/// And every triangle in one slot, its record unchanged.
inline void check_triangles(const HostTree& tree, const std::vector<Triangle>& triangles) {
  ASSERT_EQ(tree.order.size(), triangles.size());
  std::vector<int> seen(triangles.size());
  std::vector<Bounds> bounds;
  for (std::size_t slot = 0; slot < tree.order.size(); ++slot) {
    const std::uint32_t i = tree.order[slot];
    ASSERT_LT(i, triangles.size());
    ++seen[i];
    const Triangle& record = tree.data.triangles.at(tree.first_slot + slot);
    ASSERT_EQ(std::memcmp(&record, &triangles[i], sizeof(Triangle)), 0);
    bounds.push_back(triangle_bounds(record.v0, record.v1, record.v2));
  }
  ASSERT_EQ(seen, std::vector<int>(triangles.size(), 1));
  check_nodes(tree, bounds);
}

class CudaBuild : public CudaTest {
 protected:
  void SetUp() override {
    CudaTest::SetUp();
    if (IsSkipped()) return;
    builder_ = std::make_unique<DeviceTreeBuilder>([this](TreeArray, std::uint64_t size_bytes) {
      return memory_->allocate<char>("tree", size_bytes);
    });
  }

  DeviceTree build(const std::vector<Triangle>& triangles, const DeviceBuildOptions& options) {
    source_ = std::make_unique<DeviceArray<Triangle>>(triangles);
    return builder_->build(source(), static_cast<std::uint32_t>(triangles.size()), options);
  }
  TriangleSource source() const {
    TriangleSource source;
    source.records = source_->data();
    return source;
  }
  void forget_outputs() { memory_ = std::make_unique<CudaMemory>(); }

  std::unique_ptr<CudaMemory> memory_ = std::make_unique<CudaMemory>();
  std::unique_ptr<DeviceTreeBuilder> builder_;
  std::unique_ptr<DeviceArray<Triangle>> source_;
};

}  // namespace pt
