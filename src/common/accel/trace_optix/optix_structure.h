// The structures that OptiX builds over a scene's triangles and spheres: one for each group, and
// one over the instances.
#pragma once

#include <vector>

#include "common/accel/trace_optix/optix_library.h"
#include "common/accel/trace_optix/optix_memory.h"
#include "common/accel/trace_optix/optix_scene.h"
#include "common/accel/triangle_tree.h"
#include "common/choices/optix_hits.h"

namespace pt {

/// What the structure's margins allow of rays.
struct OptixReach {
  Vec3 centre{0.0f};
  float distance = 0;  ///< how far from the centre, along each axis, a ray may begin
  /// How much farther than the best hit one in an instance may seem to lie, for directions of
  /// length 1.
  float cull_margin = 0;
};

class OptixStructure {
 public:
  /// Over the triangles of `tree`, in the device's memory; their slots are OptiX's numbers of
  /// primitives, counted from the group's first one. And over the spheres of `primitives`, also
  /// there, which is an instance, as then all triangles without instances are. `memory` must
  /// outlive the structure.
  OptixStructure(const OptixContext& context, OptixMemory& memory, const TriangleTree& tree,
                 OptixHits hits, const Primitives& primitives = {});

  optix::TraversableHandle handle() const { return handle_; }
  const OptixReach& reach() const { return reach_; }
  const OptixContent& content() const { return content_; }
  /// Wall time of building and compaction.
  double build_ms() const { return build_ms_; }
  std::size_t bytes_built() const { return bytes_built_; }
  std::size_t bytes_compacted() const { return bytes_; }

 private:
  struct Group {
    std::uint32_t first_slot, slot_count;
    optix::TraversableHandle handle;
  };

  void build_triangles(const TriangleTree& tree, OptixHits hits);
  void build_scene(const TriangleTree& tree, OptixHits hits, const std::vector<Sphere>& spheres);
  optix::TraversableHandle build_spheres(const std::vector<Sphere>& spheres, const Bounds& reached);
  optix::TraversableHandle build_boxes(const OptixBuffer& boxes, std::uint32_t count);
  optix::TraversableHandle build_group(const Triangle* triangles, std::uint32_t count,
                                       OptixHits hits, const OptixBoxMargin& margin);
  optix::TraversableHandle build_instances(const std::vector<InstanceRecord>& records,
                                           const std::vector<Group>& groups,
                                           optix::TraversableHandle spheres);
  Bounds bounds_of_triangles(const TriangleTree& tree) const;
  void check_count(const char* what, std::size_t count, int property) const;
  optix::TraversableHandle build(const optix::BuildInput& input);

  const OptixContext& context_;
  OptixMemory& memory_;
  std::vector<OptixBuffer> buffers_;
  optix::TraversableHandle handle_ = 0;
  OptixReach reach_;
  OptixContent content_;
  double build_ms_ = 0;
  std::size_t bytes_built_ = 0, bytes_ = 0;
};

/// What the programs are told of the structure over both, and of our tree over spheres.
inline OptixScene optix_scene(const TriangleTree& tree, const OptixStructure& structure,
                              const Primitives& primitives = {}, const Bvh2Node* nodes = nullptr) {
  const OptixReach& reach = structure.reach();
  return {tree, structure.handle(), reach.cull_margin, reach.centre, reach.distance, primitives,
          nodes};
}

}  // namespace pt
