#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/accel/build_cuda/build_device.h"
#include "common/accel/build_cuda/kernels.cuh"
#include "common/accel/build_cuda/scratch.cuh"
#include "common/error/error.h"

namespace pt {

using namespace device_build;

namespace {

template <class T>
T download(const T* from, const char* what) {
  T value;
  check_cuda(cudaMemcpy(&value, from, sizeof value, cudaMemcpyDeviceToHost), what);
  return value;
}

void check_options(std::uint32_t count, const DeviceBuildOptions& options) {
  const auto expect = [](bool ok, const char* what, auto value, int low, auto high) {
    if (ok) return;
    throw Error(
        fmt::format("building a tree: {} is {}; expected {} to {}", what, value, low, high));
  };
  expect(count <= tree_primitives_max, "the number of primitives", count, 0, tree_primitives_max);
  expect(options.costs.leaf_max >= 1 && options.costs.leaf_max <= leaf_size_max, "leaf_max",
         options.costs.leaf_max, 1, leaf_size_max);
}

/// The builder to try when a tree is too deep.
DeviceBuilder next_builder(DeviceBuilder builder) {
  switch (builder) {
    case DeviceBuilder::hploc_reinsert:
      return DeviceBuilder::hploc;
    case DeviceBuilder::hploc:
      return DeviceBuilder::lbvh;
    default:
      return DeviceBuilder::balanced;
  }
}

/// For a tree that will change: its costs are computed afterwards.
HierarchyJob without_costs(HierarchyJob job) {
  job.tables = nullptr, job.binary_costs = nullptr;
  return job;
}

}  // namespace

/// One build after the other; the members are the present one's.
class DeviceTreeBuilder::Work {
 public:
  explicit Work(DeviceAllocator allocate) : allocate_(std::move(allocate)) {}

  DeviceTree build(const TriangleSource& source, std::uint32_t count,
                   const DeviceBuildOptions& options) {
    check_options(count, options);
    if (count == 0) return {};
    options_ = options;
    job_ = {};
    job_.count = count;
    job_.costs = options.costs;
    divide_scratch();
    // Wide nodes are far fewer than triangles but for strange scenes.
    node_capacity_ = is_wide() ? count / 2 + 64 : count;
    divide_collapse_scratch();

    DeviceTree tree;
    watch_.start();
    sort_primitives(source, tree.times);
    const CollapseCounters counters = build_nodes(tree);
    const SharedBounds shared = download(bounds_, "reading the scene's bounds");
    if (shared.is_bad == 0) {
      throw Error("building a tree: coordinates must be finite and within 1e12");
    }
    tree.bounds = read_bounds(shared, 6);
    tree.depth = static_cast<int>(counters.depth);
    tree.node_count = static_cast<std::uint32_t>(counters.allocated >> 32);
    tree.slot_count = count;
    tree.scratch_bytes = scratch_.size_bytes() + collapse_scratch_.size_bytes();
    write_outputs(tree, source);
    return tree;
  }

  TreeQuality measure(const DeviceTree& tree) {
    TreeQuality quality;
    if (tree.node_count == 0) return quality;
    QualitySums* sums = nullptr;
    scratch_.divide([&](Scratch& s) { sums = s.take<QualitySums>(1); });
    tree.bvh2 != nullptr ? enqueue_quality(tree.bvh2, tree.node_count, sums)
                         : enqueue_quality(tree.cwbvh, tree.node_count, sums);
    const QualitySums sum = download(sums, "measuring a tree");
    const double area = std::max(tree.bounds.half_area(), 1e-37f);  // of a root without area
    quality.nodes_per_ray = 1 + sum.node_area / area;
    quality.triangles_per_ray = sum.triangle_area / area;
    quality.nodes = tree.node_count;
    quality.leaves = sum.leaves;
    quality.slots = sum.slots;
    quality.depth = tree.depth;
    return quality;
  }

 private:
  bool is_wide() const { return options_.format == TreeFormat::cwbvh; }

  void divide_scratch() {
    const std::uint64_t count = job_.count;
    sort_bytes_ = sort_scratch_bytes(job_.count);
    scratch_.divide([&](Scratch& s) {
      bounds_ = s.take<SharedBounds>(1);
      counters_ = s.take<CollapseCounters>(1);
      job_.root = s.take<TreeRef>(1);
      primitives_ = s.take<BuildNode>(count);
      for (int i = 0; i < 2; ++i) {
        sorted_.keys[i] = s.take<std::uint64_t>(count);
        sorted_.values[i] = s.take<std::uint32_t>(count);
      }
      sort_scratch_ = s.take<char>(sort_bytes_);
      prefixes_ = s.take<std::uint8_t>(count + 1);
      job_.nodes = s.take<BuildNode>(count);
      job_.tables = is_wide() ? s.take<CollapseTable>(count) : nullptr;
      job_.binary_costs = is_wide() ? nullptr : s.take<float>(count);
      job_.pairs = s.take<std::uint64_t>(count);
      job_.ranges = s.take<std::uint32_t>(count);
    });
  }

  void divide_collapse_scratch() {
    const std::uint64_t node_bytes = is_wide() ? sizeof(CwbvhNode) : sizeof(Bvh2Node);
    collapse_scratch_.divide([&](Scratch& s) {
      queue_ = s.take<std::uint64_t>(node_capacity_);
      order_ = s.take<std::uint32_t>(job_.count);
      nodes_ = s.take<char>(node_capacity_ * node_bytes);
    });
  }

  void sort_primitives(const TriangleSource& source, DeviceBuildTimes& times) {
    enqueue_bounds(source, job_.count, primitives_, bounds_);
    watch_.mark(&times.bounds_ms);
    enqueue_morton(primitives_, job_.count, bounds_, sorted_);
    watch_.mark(&times.morton_ms);
    enqueue_sort(sorted_, job_.count, sort_scratch_, sort_bytes_);
    watch_.mark(&times.sort_ms);
  }

  /// The nodes, in temporary memory, by the first builder whose tree is not too deep.
  CollapseCounters build_nodes(DeviceTree& tree) {
    tree.builder = options_.builder;
    while (true) {
      build_hierarchy(tree.builder, tree.times);
      CollapseCounters counters = collapse(tree.times);
      if (counters.overflowed != 0) {
        node_capacity_ = job_.count;
        divide_collapse_scratch();
        counters = collapse(tree.times);
      }
      if (static_cast<int>(counters.depth) <= options_.depth_max) return counters;
      if (tree.builder == DeviceBuilder::balanced) {
        throw Error(fmt::format("the tree is {} nodes deep; expected at most {}", counters.depth,
                                options_.depth_max));
      }
      tree.builder = next_builder(tree.builder);
    }
  }

  void build_hierarchy(DeviceBuilder builder, DeviceBuildTimes& times) {
    enqueue_prefixes(sorted_.keys[0], job_.count, builder != DeviceBuilder::balanced, prefixes_);
    job_.order = sorted_.values[0];
    job_.prefixes = prefixes_;
    job_.primitives = primitives_;
    const bool reinserts = builder == DeviceBuilder::hploc_reinsert && job_.count > 2;
    if (reinserts) {
      enqueue_hploc(without_costs(job_));
    } else if (builder == DeviceBuilder::lbvh || builder == DeviceBuilder::balanced) {
      enqueue_lbvh(job_);
    } else {
      enqueue_hploc(job_);
    }
    watch_.mark(&times.hierarchy_ms);
    if (!reinserts) return;
    reinsert();
    watch_.mark(&times.reinsertion_ms);
  }

  /// In the memory that the collapse uses afterwards.
  void reinsert() {
    ReinsertionJob job;
    job.count = job_.count;
    job.primitives = primitives_, job.nodes = job_.nodes, job.root = job_.root;
    const std::uint64_t count = job_.count;
    collapse_scratch_.divide([&](Scratch& s) {
      job.parents = s.take<std::uint32_t>(2 * count);
      job.locks = s.take<std::uint64_t>(2 * count);
      job.arrivals = s.take<std::uint32_t>(count);
      job.moves = s.take<Move>(job.candidates());
    });
    enqueue_reinsertion(job, job_);
    divide_collapse_scratch();
  }

  CollapseCounters collapse(DeviceBuildTimes& times) {
    CollapseJob job;
    job.tree = {primitives_, job_.nodes, job_.tables, job_.binary_costs};
    job.root = job_.root;
    job.count = job_.count;
    job.capacity = node_capacity_;
    job.costs = options_.costs;
    job.first_node = options_.first_node, job.first_slot = options_.first_slot;
    job.queue = queue_;
    job.order = order_;
    job.counters = counters_;
    is_wide() ? enqueue_collapse(job, reinterpret_cast<CwbvhNode*>(nodes_))
              : enqueue_collapse(job, reinterpret_cast<Bvh2Node*>(nodes_));
    watch_.mark(&times.collapse_ms);
    watch_.read();
    return download(counters_, "collapsing a tree");
  }

  /// Moves the nodes and the order to memory of their own size, and writes the triangles.
  void write_outputs(DeviceTree& tree, const TriangleSource& source) {
    const std::uint64_t slots = tree.slot_count;
    const std::uint64_t node_size = is_wide() ? sizeof(CwbvhNode) : sizeof(Bvh2Node);
    void* nodes = allocate_(TreeArray::nodes, tree.node_count * node_size);
    tree.bvh2 = is_wide() ? nullptr : static_cast<Bvh2Node*>(nodes);
    tree.cwbvh = is_wide() ? static_cast<CwbvhNode*>(nodes) : nullptr;
    tree.order =
        static_cast<std::uint32_t*>(allocate_(TreeArray::order, slots * sizeof *tree.order));
    tree.triangles =
        static_cast<Triangle*>(allocate_(TreeArray::triangles, slots * sizeof(Triangle)));
    watch_.start();
    copy(nodes, nodes_, tree.node_count * node_size);
    copy(tree.order, order_, slots * sizeof *tree.order);
    watch_.mark(&tree.times.collapse_ms);
    enqueue_triangles(source, tree.order, tree.slot_count, tree.triangles);
    watch_.mark(&tree.times.triangles_ms);
    watch_.read();
  }

  static void copy(void* to, const void* from, std::uint64_t size_bytes) {
    check_cuda(cudaMemcpyAsync(to, from, size_bytes, cudaMemcpyDeviceToDevice), "copying a tree");
  }

  DeviceAllocator allocate_;
  Stopwatch watch_;
  DeviceBuildOptions options_;
  Scratch scratch_, collapse_scratch_;
  std::uint32_t node_capacity_ = 0;
  std::uint64_t sort_bytes_ = 0;
  SharedBounds* bounds_ = nullptr;
  CollapseCounters* counters_ = nullptr;
  BuildNode* primitives_ = nullptr;
  SortBuffers sorted_{};
  void* sort_scratch_ = nullptr;
  std::uint8_t* prefixes_ = nullptr;
  HierarchyJob job_;
  std::uint64_t* queue_ = nullptr;
  std::uint32_t* order_ = nullptr;
  char* nodes_ = nullptr;
};

DeviceTreeBuilder::DeviceTreeBuilder(DeviceAllocator allocate)
    : work_(std::make_unique<Work>(std::move(allocate))) {}
DeviceTreeBuilder::~DeviceTreeBuilder() = default;

DeviceTree DeviceTreeBuilder::build(const TriangleSource& source, std::uint32_t count,
                                    const DeviceBuildOptions& options) {
  return work_->build(source, count, options);
}

TreeQuality DeviceTreeBuilder::measure(const DeviceTree& tree) { return work_->measure(tree); }

}  // namespace pt
