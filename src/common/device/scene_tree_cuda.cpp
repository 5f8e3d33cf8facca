#include "common/accel/build_device.h"
#include "common/accel/build_triangle_tree.h"
#include "common/accel/mesh_triangles.h"
#include "common/device/cuda_check.cuh"
#include "common/device/scene_tree.cuh"

namespace pt {
namespace {

/// The meshes one after the other in device memory, which `memory` frees.
TriangleSource upload_meshes(const std::vector<Mesh>& meshes, CudaMemory& memory) {
  std::vector<MeshRange> ranges;
  MeshRange next;
  for (const Mesh& mesh : meshes) {
    next.material = mesh.material;
    next.attributes = triangle_attributes(mesh);
    ranges.push_back(next);
    next.first_triangle += static_cast<std::uint32_t>(mesh.triangles.size());
    next.first_vertex += static_cast<std::uint32_t>(mesh.positions.size());
  }
  Vec3* positions = memory.allocate<Vec3>("vertices", next.first_vertex);
  auto* indices = memory.allocate<TriangleIndices>("vertices", next.first_triangle);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const auto copy = [](auto* device, const auto& values) {
      check_cuda(cudaMemcpy(device, values.data(), values.size() * sizeof(values[0]),
                            cudaMemcpyHostToDevice),
                 "uploading a mesh");
    };
    copy(positions + ranges[i].first_vertex, meshes[i].positions);
    copy(indices + ranges[i].first_triangle, meshes[i].triangles);
  }
  TriangleSource source;
  source.positions = positions;
  source.indices = indices;
  source.ranges = memory.upload("vertices", ranges);
  source.range_count = static_cast<std::uint32_t>(ranges.size());
  return source;
}

DeviceBuildOptions build_options(const SceneTraits& traits, TreeBuilder builder) {
  DeviceBuildOptions options;
  options.builder = builder == TreeBuilder::lbvh ? DeviceBuilder::lbvh : DeviceBuilder::hploc;
  if (traits.accel == Accel::bvh2) {
    options.format = TreeFormat::bvh2;
    options.costs = default_bvh2_costs;
  }
  return options;
}

void describe(const DeviceTree& tree, const TreeQuality& quality, const DeviceBuildOptions& options,
              TreeFacts& facts) {
  constexpr const char* names[] = {"lbvh", "hploc", "balanced"};
  facts.builder = names[static_cast<int>(tree.builder)];
  facts.nodes = tree.node_count;
  facts.references = tree.slot_count;
  facts.depth = tree.depth;
  facts.sah_cost = quality.sah_cost(1.0);
  const std::size_t node_bytes =
      options.format == TreeFormat::bvh2 ? sizeof(Bvh2Node) : sizeof(CwbvhNode);
  facts.bytes_per_triangle =
      sizeof(Triangle) + static_cast<double>(tree.node_count * node_bytes) / tree.slot_count;
  facts.build_ms = tree.times.total_ms();
}

}  // namespace

TriangleTree build_scene_tree(const SceneData& scene, const Options& options, CudaMemory& memory,
                              TreeFacts& facts) {
  CudaMemory temporary;
  const TriangleSource source = upload_meshes(scene.meshes, temporary);
  const auto count = static_cast<std::uint32_t>(scene.triangle_count());
  const DeviceBuildOptions build = build_options(scene.traits, options.builder);
  DeviceTreeBuilder builder([&](const std::string& name, std::uint64_t size_bytes) -> void* {
    return memory.allocate<char>(name, size_bytes);
  });
  const DeviceTree tree = builder.build(source, count, build);
  describe(tree, builder.measure(tree), build, facts);
  TriangleTree view;
  view.bvh2 = tree.bvh2;
  view.cwbvh = tree.cwbvh;
  view.triangles = tree.triangles;
  view.triangle_count = tree.slot_count;
  return view;
}

}  // namespace pt
