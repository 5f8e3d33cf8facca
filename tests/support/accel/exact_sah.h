// The surface area heuristic by its definition, without bins: what a builder's tree is compared
// with.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "common/accel/build/binary/binary_tree.h"

namespace pt {

/// The cost of the tree that splits each set where the sum of area times count is least, over all
/// places between two centres on all three axes (a full sweep), and that makes a leaf of a subtree
/// of at most `costs.leaf_max` primitives where that is cheaper.
class ExactSah {
 public:
  ExactSah(std::vector<Bounds> bounds, const TreeCosts& costs)
      : bounds_(std::move(bounds)), costs_(costs) {}

  /// Relative to the root's area, in units of one node's visit.
  double cost() const {
    std::vector<std::uint32_t> all(bounds_.size());
    std::iota(all.begin(), all.end(), 0u);
    return cost_of(all) / area_of(all);
  }

 private:
  using Set = std::vector<std::uint32_t>;

  static double area(const Bounds& b) {
    const glm::dvec3 d = glm::dvec3(b.max) - glm::dvec3(b.min);
    return d.x * d.y + d.y * d.z + d.z * d.x;
  }
  double area_of(const Set& set) const {
    Bounds sum;
    for (const std::uint32_t i : set) sum.grow(bounds_[i]);
    return area(sum);
  }

  double cost_of(const Set& set) const {
    const auto count = static_cast<double>(set.size());
    const double leaf = costs_.triangle * area_of(set) * count;
    if (set.size() == 1) return leaf;
    Set best_order;
    std::size_t best_left = 0;
    double best = HUGE_VAL;
    for (int axis = 0; axis < 3; ++axis) {
      Set order = set;
      std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return bounds_[a].center()[axis] < bounds_[b].center()[axis];
      });
      std::vector<double> right(order.size());
      Bounds sum;
      for (std::size_t i = order.size() - 1; i > 0; --i) {
        sum.grow(bounds_[order[i]]);
        right[i] = area(sum) * static_cast<double>(order.size() - i);
      }
      sum = {};
      for (std::size_t i = 1; i < order.size(); ++i) {
        sum.grow(bounds_[order[i - 1]]);
        const double both = area(sum) * static_cast<double>(i) + right[i];
        if (both < best) best = both, best_left = i, best_order = order;
      }
    }
    const auto middle = best_order.begin() + static_cast<std::ptrdiff_t>(best_left);
    const double node = costs_.node * area_of(set) + cost_of({best_order.begin(), middle}) +
                        cost_of({middle, best_order.end()});
    return set.size() <= costs_.leaf_max ? std::min(node, leaf) : node;
  }

  std::vector<Bounds> bounds_;
  TreeCosts costs_;
};

}  // namespace pt
