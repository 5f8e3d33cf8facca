#include "common/accel/embree/embree_tree.h"
#include "common/accel/traverse_triangles.h"

namespace pt {

Hit closest_triangle_embree(const EmbreeTree& tree, const Ray& ray, float t_min, float t_max) {
  return tree.closest_hit(ray, t_min, t_max);
}

bool any_triangle_embree(const EmbreeTree& tree, const Ray& ray, float t_min, float t_max) {
  return tree.any_hit(ray, t_min, t_max);
}

}  // namespace pt
