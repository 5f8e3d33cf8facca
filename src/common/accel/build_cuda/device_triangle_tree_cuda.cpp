#include <algorithm>
#include <chrono>
#include <set>

#include "common/accel/build/instance_tree.h"
#include "common/accel/build_cuda/device_triangle_tree.cuh"
#include "common/accel/build_cuda/group_arrays.cuh"

namespace pt {
namespace {

DeviceBuilder device_builder(TreeBuilder builder) {
  switch (builder) {
    case TreeBuilder::lbvh:
      return DeviceBuilder::lbvh;
    case TreeBuilder::hploc_reinsert:
      return DeviceBuilder::hploc_reinsert;
    default:
      return DeviceBuilder::hploc;
  }
}

DeviceBuildOptions device_options(const TreeOptions& options) {
  DeviceBuildOptions build;
  build.builder = device_builder(options.builder);
  const bool is_wide = options.accel != AccelKind::bvh2;
  build.format = is_wide ? TreeFormat::cwbvh : TreeFormat::bvh2;
  build.costs = is_wide ? options.cwbvh_costs : options.bvh2_costs;
  return build;
}

/// The groups' trees in shared arrays.
struct BuiltGroups {
  std::vector<GroupTree> groups;  ///< ascending
  QualityByRoot qualities;
  std::uint32_t node_count = 0, slot_count = 0;
  double kernel_ms = 0;
  std::set<DeviceBuilder> builders;

  void add(std::uint32_t group, const DeviceTree& tree, const TreeQuality& quality) {
    groups.push_back(
        {group, node_count, node_count, tree.node_count, slot_count, tree.slot_count, tree.bounds});
    qualities[node_count] = quality;
    node_count += tree.node_count;
    slot_count += tree.slot_count;
    kernel_ms += static_cast<double>(tree.times.total_ms());
    builders.insert(tree.builder);
  }
};

BuiltGroups build_groups(std::span<const Mesh> meshes, std::span<const Instance> instances,
                         DeviceBuildOptions options, TreeArrays& arrays) {
  CudaMemory temporary;
  std::vector<GroupSource> sources = upload_groups(meshes, instances, temporary);
  // The largest first, so that temporary memory is large enough for all others.
  std::stable_sort(sources.begin(), sources.end(), [](const GroupSource& a, const GroupSource& b) {
    return a.triangle_count > b.triangle_count;
  });
  std::uint64_t triangles = 0;
  for (const GroupSource& source : sources) triangles += source.triangle_count;
  arrays.reserve_triangles(triangles);
  DeviceTreeBuilder builder(
      [&](TreeArray array, std::uint64_t size_bytes) { return arrays.take(array, size_bytes); });
  BuiltGroups built;
  for (const GroupSource& source : sources) {
    options.first_node = built.node_count;
    options.first_slot = built.slot_count;
    const DeviceTree tree = builder.build(source.triangles, source.triangle_count, options);
    built.add(source.group, tree, builder.measure(tree));
  }
  std::sort(built.groups.begin(), built.groups.end(),
            [](const GroupTree& a, const GroupTree& b) { return a.group < b.group; });
  return built;
}

/// Where some tree got too deep, others have built it.
std::string names_of(const std::set<DeviceBuilder>& builders) {
  constexpr const char* names[] = {"lbvh", "hploc", "hploc-reinsert", "balanced"};
  std::string text;
  for (const DeviceBuilder builder : builders) {
    text += (text.empty() ? "" : "+") + std::string(names[static_cast<int>(builder)]);
  }
  return text;
}

template <class Node>
const Node* finish(TreeArrays& arrays, const BuiltGroups& built, const std::vector<Node>& top,
                   const std::vector<InstanceRecord>& instances, TreeSummary& summary) {
  const Node* nodes = arrays.join_nodes(top);
  summary.builder = names_of(built.builders);
  summary.quality = instances.empty() ? built.qualities.begin()->second
                                      : measure_instances(std::span(top), built.node_count,
                                                          instances, built.qualities);
  summary.size_bytes = (built.node_count + top.size()) * sizeof(Node) +
                       std::uint64_t{built.slot_count} * sizeof(Triangle) +
                       instances.size() * sizeof(InstanceRecord);
  return nodes;
}

}  // namespace

DeviceTriangleTree build_device_triangle_tree(std::span<const Mesh> meshes,
                                              std::span<const Instance> instances,
                                              const TreeOptions& options, CudaMemory& memory) {
  TreeArrays arrays(memory);
  const BuiltGroups built = build_groups(meshes, instances, device_options(options), arrays);
  DeviceTriangleTree tree;
  if (built.groups.empty()) return tree;
  InstanceTree top;
  const auto begin = std::chrono::steady_clock::now();
  if (!instances.empty()) {
    top = build_instance_tree(built.groups, instances, options.accel, built.node_count);
  }
  const std::chrono::duration<double, std::milli> host = std::chrono::steady_clock::now() - begin;
  tree.summary.build_ms = built.kernel_ms + (instances.empty() ? 0.0 : host.count());
  if (options.accel == AccelKind::bvh2) {
    tree.view.bvh2 = finish(arrays, built, top.bvh2, top.instances, tree.summary);
  } else {
    tree.view.cwbvh = finish(arrays, built, top.cwbvh, top.instances, tree.summary);
  }
  tree.view.triangles = arrays.triangles();
  tree.view.triangle_count = built.slot_count;
  tree.view.instances = memory.upload("instances", top.instances);
  tree.view.instance_count = static_cast<std::uint32_t>(top.instances.size());
  tree.view.root = instances.empty() ? 0 : built.node_count;
  return tree;
}

}  // namespace pt
