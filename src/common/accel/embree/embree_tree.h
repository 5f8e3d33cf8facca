// Intel's Embree over the same triangles and instances: an independent reference for hits.
#pragma once

#include <memory>
#include <string>

#include "common/accel/build/triangle_tree_data.h"
#include "common/geometry/ray.h"

namespace pt {

/// "3.13.5", or empty where ptexp was built without Embree.
std::string embree_version();

/// Embree's own tree in its robust mode. Hits name slots and indices of instances as those of the
/// traversals do, but any of several hits at one distance may be reported, and distances differ by
/// rounding. Queries may come from several threads at once.
class EmbreeTree {
 public:
  /// Keeps pointers into `tree`, whose nodes do not matter. Throws Error where ptexp was built
  /// without Embree, or Embree has failed.
  explicit EmbreeTree(const TriangleTreeData& tree);
  ~EmbreeTree();
  EmbreeTree(EmbreeTree&&) noexcept;
  EmbreeTree& operator=(EmbreeTree&&) noexcept;

  /// With t_min < t < t_max; t_min >= 0. Rays that are not finite meet nothing.
  friend Hit closest_triangle_embree(const EmbreeTree& tree, const Ray& ray, float t_min,
                                     float t_max);
  friend bool any_triangle_embree(const EmbreeTree& tree, const Ray& ray, float t_min, float t_max);

 private:
  struct Scenes;
  std::unique_ptr<Scenes> scenes_;
};

}  // namespace pt
