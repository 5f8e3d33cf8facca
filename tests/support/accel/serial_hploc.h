// H-PLOC by one thread: the tree that the device's builder makes (build_cuda/hierarchy.cu), but for
// what another rounding of areas decides.
#pragma once

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>
#include <vector>

#include "common/accel/build/binary/build_tree.h"
#include "common/accel/build/morton_order.h"

namespace pt {

/// A binary tree as the device's hierarchy builders leave it.
struct HostBuildTree {
  std::vector<BuildNode> primitives;
  std::vector<BuildNode> nodes;  ///< as many as primitives; one is unused
  TreeRef root = 0;

  std::uint32_t count() const { return static_cast<std::uint32_t>(primitives.size()); }
  const BuildNode& operator[](TreeRef ref) const {
    return (is_primitive(ref) ? primitives : nodes)[ref_index(ref)];
  }
};

class SerialHploc {
 public:
  /// Takes at least one box.
  explicit SerialHploc(const std::vector<Bounds>& boxes)
      : count_(static_cast<std::uint32_t>(boxes.size())) {
    for (const Bounds& box : boxes) tree.primitives.push_back({box.min, 0, box.max, 0});
    tree.nodes.resize(count_, {{}, nobody, {}, nobody});
    const std::vector<std::uint32_t> order = sort(boxes);
    for (std::uint32_t i = 0; i < count_; ++i) pairs_.push_back({make_ref(1, order[i]), i});
    tree.root = pairs_[0].ref;
    std::vector<std::uint32_t> ranges(count_, nobody);
    for (std::uint32_t i = 0; i < count_ && count_ > 1; ++i) climb(i, ranges);
  }

  HostBuildTree tree;

 private:
  struct Cluster {
    TreeRef ref;
    std::uint32_t node_index;
  };
  static constexpr std::uint32_t nobody = 0xffffffffu;
  static constexpr std::uint32_t kept = 16;  // of a half

  std::vector<std::uint32_t> sort(const std::vector<Bounds>& boxes) {
    Bounds centers;
    for (const Bounds& box : boxes) centers.grow(box.center());
    const MortonGrid grid = make_morton_grid(centers, morton_bits_max);
    std::vector<std::uint64_t> codes;
    for (const Bounds& box : boxes) codes.push_back(morton_code(grid, box.center()));
    std::vector<std::uint32_t> order(count_);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return codes[a] < codes[b]; });
    prefixes_.assign(count_ + 1, 0);
    for (std::uint32_t i = 1; i < count_; ++i) {
      prefixes_[i] = neighbour_prefix(codes[order[i - 1]], codes[order[i]], i - 1);
    }
    return order;
  }

  void climb(std::uint32_t leaf, std::vector<std::uint32_t>& ranges) {
    std::uint32_t first = leaf, last = leaf;
    while (first > 0 || last + 1 < count_) {
      const bool is_left = prefixes_[last + 1] > prefixes_[first];
      const std::uint32_t split = is_left ? last : first - 1;
      const std::uint32_t other = std::exchange(ranges[split], is_left ? first : last);
      if (other == nobody) return;
      (is_left ? last : first) = other;
      const bool is_whole = last - first + 1 == count_;
      if (last - first + 1 > kept || is_whole) merge(first, split + 1, last, is_whole);
    }
  }

  void merge(std::uint32_t first, std::uint32_t split, std::uint32_t last, bool is_whole) {
    std::vector<Cluster> clusters;
    const auto load = [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t i = begin; i < std::min(begin + kept, end); ++i) {
        if (pairs_[i].ref != nobody) clusters.push_back(pairs_[i]);
      }
    };
    load(first, split);
    load(split, last + 1);
    while (clusters.size() > (is_whole ? 1 : kept)) clusters = merge_pairs(clusters);
    if (is_whole) {
      tree.root = clusters[0].ref;
      return;
    }
    clusters.resize(kept, {nobody, 0});
    std::copy(clusters.begin(), clusters.end(), pairs_.begin() + first);
  }

  std::vector<Cluster> merge_pairs(const std::vector<Cluster>& clusters) {
    const int count = static_cast<int>(clusters.size());
    const auto box = [&](int i) {
      return tree[clusters[static_cast<std::size_t>(i)].ref].bounds();
    };
    std::array<std::uint32_t, 2 * kept> best;
    best.fill(no_pair);
    for (int i = 0; i < count; ++i) {
      for (int distance = 1; distance <= ploc_radius && i + distance < count; ++distance) {
        const std::uint32_t rank = pair_rank(box(i), box(i + distance), i, distance);
        for (const int member : {i, i + distance}) {
          std::uint32_t& least = best[static_cast<std::size_t>(member)];
          least = std::min(least, rank);
        }
      }
    }
    const auto partner = [&](int i) { return pair_partner(best[static_cast<std::size_t>(i)], i); };
    std::vector<Cluster> left;
    for (int i = 0; i < count; ++i) {
      const Cluster& c = clusters[static_cast<std::size_t>(i)];
      const int other = partner(i);
      if (partner(other) != i) {
        left.push_back(c);
      } else if (i < other) {
        left.push_back(join(c, clusters[static_cast<std::size_t>(other)]));
      }
    }
    return left;
  }

  Cluster join(const Cluster& a, const Cluster& b) {
    Bounds box = tree[a.ref].bounds();
    box.grow(tree[b.ref].bounds());
    tree.nodes[a.node_index] = {box.min, a.ref, box.max, b.ref};
    return {make_ref(ref_count(a.ref) + ref_count(b.ref), a.node_index), b.node_index};
  }

  std::uint32_t count_;
  std::vector<std::uint8_t> prefixes_;
  std::vector<Cluster> pairs_;
};

}  // namespace pt
