#include "common/accel/build/build_bvh2.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace pt {

namespace {

constexpr int bin_count = 16;
constexpr float traversal_cost = 1.0f;  // of a node, in units of one primitive test
constexpr int median_depth = 16;        // from here on, halve: keeps the tree below bvh_depth_max

using Range = std::span<std::uint32_t>;

class Builder {
 public:
  Builder(std::span<const Bounds> bounds, std::uint32_t second_kind, float padding)
      : bounds_(bounds), second_kind_(second_kind), padding_(padding) {}

  Bvh2 build() {
    bvh_.order.resize(bounds_.size());
    std::iota(bvh_.order.begin(), bvh_.order.end(), 0u);
    const Range all(bvh_.order);
    if (const std::size_t left = split(all, 0)) {
      build_node(all, left, 0);
    } else {  // the traversal starts at an inner node: both children are the one leaf
      Bvh2Node& root = bvh_.nodes.emplace_back();
      for (int i = 0; i < 2; ++i) set_child(root, i, all, leaf(all));
    }
    number_by_kind();
    return std::move(bvh_);
  }

 private:
  Bounds bounds_of(Range range) const {
    Bounds sum;
    for (const std::uint32_t i : range) sum.grow(bounds_[i]);
    return sum;
  }

  std::uint32_t leaf(Range range) const {
    const auto first = static_cast<std::uint32_t>(range.data() - bvh_.order.data());
    return make_leaf(first, static_cast<std::uint32_t>(range.size()));
  }

  void set_child(Bvh2Node& node, int i, Range range, std::uint32_t child) const {
    const Bounds box = bounds_of(range);
    const Vec3 lo = box.min - padding_, hi = box.max + padding_;
    node.xy[i] = {lo.x, hi.x, lo.y, hi.y};
    node.z[2 * i] = lo.z;
    node.z[2 * i + 1] = hi.z;
    node.child[i] = child;
  }

  std::uint32_t build_node(Range range, std::size_t left, int depth) {
    const auto index = static_cast<std::uint32_t>(bvh_.nodes.size());
    bvh_.nodes.emplace_back();
    const std::array<Range, 2> halves = {range.first(left), range.subspan(left)};
    for (int i = 0; i < 2; ++i) {
      const std::size_t next = split(halves[i], depth + 1);
      const std::uint32_t child =
          next == 0 ? leaf(halves[i]) : build_node(halves[i], next, depth + 1);
      set_child(bvh_.nodes[index], i, halves[i], child);
    }
    return index;
  }

  // Reorders `range` so that its first `result` members go left; 0 when a leaf is cheaper.
  std::size_t split(Range range, int depth) const {
    if (range.size() == 1) return 0;
    const std::size_t firsts = partition_kinds(range);
    const bool one_kind = firsts == 0 || firsts == range.size();
    if (!one_kind && range.size() <= leaf_size_max) return firsts;
    Bounds centers;
    for (const std::uint32_t i : range) centers.grow(bounds_[i].center());
    const Vec3 size = centers.max - centers.min;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    if (depth >= median_depth || !(size[axis] > 0.0f)) return split_median(range, axis);
    const std::size_t left = split_sah(range, centers, axis, one_kind);
    return left;
  }

  std::size_t partition_kinds(Range range) const {
    const auto middle = std::partition(range.begin(), range.end(),
                                       [&](std::uint32_t i) { return i < second_kind_; });
    return static_cast<std::size_t>(middle - range.begin());
  }

  std::size_t split_median(Range range, int axis) const {
    const std::size_t half = range.size() / 2;
    if (range.size() <= 4) return 0;
    std::nth_element(range.begin(), range.begin() + static_cast<std::ptrdiff_t>(half), range.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                       return bounds_[a].center()[axis] < bounds_[b].center()[axis];
                     });
    return half;
  }

  std::size_t split_sah(Range range, const Bounds& centers, int axis, bool may_be_leaf) const {
    const float scale = bin_count / (centers.max[axis] - centers.min[axis]);
    const auto bin_of = [&](std::uint32_t i) {
      const float x = (bounds_[i].center()[axis] - centers.min[axis]) * scale;
      return std::clamp(static_cast<int>(x), 0, bin_count - 1);
    };
    std::array<Bounds, bin_count> bins;
    std::array<std::size_t, bin_count> counts{};
    for (const std::uint32_t i : range) {
      bins[bin_of(i)].grow(bounds_[i]);
      ++counts[bin_of(i)];
    }
    std::array<float, bin_count> cost{};  // of a split before bin b
    Bounds sum;
    std::size_t count = 0;
    for (int b = 1; b < bin_count; ++b) {
      sum.grow(bins[b - 1]);
      count += counts[b - 1];
      cost[b] = count == 0 ? HUGE_VALF : sum.half_area() * static_cast<float>(count);
    }
    sum = {};
    count = 0;
    int best = 1;
    for (int b = bin_count - 1; b >= 1; --b) {
      sum.grow(bins[b]);
      count += counts[b];
      cost[b] += count == 0 ? HUGE_VALF : sum.half_area() * static_cast<float>(count);
      if (cost[b] < cost[best]) best = b;
    }
    const float area = bounds_of(range).half_area();
    const float leaf_cost = area * static_cast<float>(range.size());
    if (may_be_leaf && range.size() <= leaf_size_max &&
        leaf_cost <= traversal_cost * area + cost[best]) {
      return 0;
    }
    const auto middle = std::partition(range.begin(), range.end(),
                                       [&](std::uint32_t i) { return bin_of(i) < best; });
    return static_cast<std::size_t>(middle - range.begin());
  }

  // Sorts `order` by kind, keeping each kind's sequence, and renumbers the leaves.
  void number_by_kind() {
    std::vector<std::uint32_t> place(bvh_.order.size());
    std::uint32_t first = 0, second = std::min<std::uint32_t>(
                                 second_kind_, static_cast<std::uint32_t>(bvh_.order.size()));
    for (std::size_t i = 0; i < place.size(); ++i) {
      place[i] = bvh_.order[i] < second_kind_ ? first++ : second++;
    }
    for (Bvh2Node& node : bvh_.nodes) {
      for (std::uint32_t& child : node.child) {
        if (is_leaf(child)) child = make_leaf(place[leaf_first(child)], leaf_count(child));
      }
    }
    std::vector<std::uint32_t> sorted(place.size());
    for (std::size_t i = 0; i < place.size(); ++i) sorted[place[i]] = bvh_.order[i];
    bvh_.order = std::move(sorted);
  }

  std::span<const Bounds> bounds_;
  std::uint32_t second_kind_;
  float padding_;
  Bvh2 bvh_;
};

}  // namespace

Bvh2 build_bvh2(std::span<const Bounds> bounds, std::uint32_t first_of_second_kind, float padding) {
  return Builder(bounds, first_of_second_kind, padding).build();
}

}  // namespace pt
