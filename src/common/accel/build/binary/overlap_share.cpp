#include "common/accel/build/binary/overlap_share.h"

#include <algorithm>

#include "common/accel/build/binary/invoke_both.h"

namespace pt {

namespace {

constexpr int share_task_depth = 10;  // so far down, the two children are tasks of their own

/// Of a subtree, in units of area: as many as a ray's expected visits times the root's.
struct Costs {
  double visits = 0, overlap = 0;
};

double shared_area(const Bounds& a, const Bounds& b) {
  const Bounds shared{glm::max(a.min, b.min), glm::min(a.max, b.max)};
  const bool is_empty = glm::any(glm::lessThan(shared.max, shared.min));
  return is_empty ? 0.0 : static_cast<double>(shared.half_area());
}

Costs costs_of(const BinaryTree& tree, std::uint32_t subtree, double area, int depth) {
  if (is_leaf(subtree)) return {area, 0};
  const Bvh2Node& node = tree.nodes[subtree];
  const Bounds box[2] = {child_bounds(node, 0), child_bounds(node, 1)};
  double areas[2];
  Costs half[2];
  const auto weigh = [&](int i) {
    areas[i] = static_cast<double>(box[i].half_area());
    half[i] = costs_of(tree, node.child[i], areas[i], depth + 1);
  };
  invoke_both(
      depth < share_task_depth, [&] { weigh(0); }, [&] { weigh(1); });
  const auto visits_per_ray = [&](int i) { return areas[i] > 0 ? half[i].visits / areas[i] : 0.0; };
  const double saved = shared_area(box[0], box[1]) * std::min(visits_per_ray(0), visits_per_ray(1));
  return {area + half[0].visits + half[1].visits, half[0].overlap + half[1].overlap + saved};
}

}  // namespace

double overlap_share(const BinaryTree& tree) {
  const Costs costs = costs_of(tree, tree.root, static_cast<double>(tree.bounds.half_area()), 0);
  return costs.visits > 0 ? costs.overlap / costs.visits : 0.0;
}

}  // namespace pt
