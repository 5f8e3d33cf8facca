#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <queue>
#include <vector>

#include "common/accel/build/binary/build_binary.h"

namespace pt {

namespace {

constexpr int passes = 3;
constexpr std::size_t upper_max = 1u << 16;  // nodes that can change
constexpr double least_saving = 0.0225;      // of these nodes' areas
// Nodes that the search for one subtree's best place looks at. It ends after less than 128 in the
// scenes measured, after less than 1,024 among long needles; where all boxes are alike it would
// look at all.
constexpr std::uint32_t visits_max = 1u << 12;
constexpr std::uint32_t nothing = 0xffffffffu;

/// A node of the upper part of the tree, or a subtree below, which stays as it is.
struct Node {
  Bounds bounds;
  std::uint32_t parent;
  std::uint32_t child[2];  // of a subtree below: nothing, and what the old tree calls it

  bool is_subtree() const { return child[0] == nothing; }
};

/// Where a subtree is to go: beside node `at`, into a new node.
struct Move {
  float gain = 0;  // of area
  std::uint32_t at = nothing;
};

Bounds joined(Bounds a, const Bounds& b) {
  a.grow(b);
  return a;
}

class Reinserter {
 public:
  explicit Reinserter(const BinaryTree& tree) : tree_(tree) {
    nodes_.push_back({tree.bounds, nothing, {nothing, tree.root}});
    open_largest();
    tried_ = std::min(upper_max / 2, nodes_in(tree) / 10);
  }

  /// Sum over the upper nodes.
  double area() const {
    double sum = 0;
    for (const Node& node : nodes_) {
      if (!node.is_subtree()) sum += static_cast<double>(node.bounds.half_area());
    }
    return sum;
  }

  // What seems to gain is found by all threads in the tree as it is, then looked for again and
  // moved one by one, since the moves before may have changed where it goes.
  void pass() {
    const std::vector<std::uint32_t> tried = largest_nodes();
    std::vector<char> gains(tried.size());
    tbb::parallel_for(std::size_t{0}, tried.size(),
                      [&](std::size_t i) { gains[i] = find_best_move(tried[i]).gain > 0; });
    for (std::size_t i = 0; i < tried.size(); ++i) {
      if (gains[i] == 0) continue;
      const Move move = find_best_move(tried[i]);
      if (move.gain > 0) apply(tried[i], move.at);
    }
  }

  /// None where it is too deep.
  std::optional<BinaryTree> result() const {
    BinaryTree result;
    result.bounds = tree_.bounds, result.order = tree_.order;
    result.node_capacity = tree_.node_capacity;
    result.nodes.reset(new Bvh2Node[tree_.node_capacity]);
    std::vector<std::uint32_t> sizes(nodes_.size());  // of subtrees below, in nodes
    tbb::parallel_for(std::size_t{0}, nodes_.size(), [&](std::size_t i) {
      if (nodes_[i].is_subtree()) sizes[i] = count_nodes(nodes_[i].child[1]);
    });
    std::vector<Copy> copies;
    std::uint32_t count = 0;
    if (!emit(root_, 0, sizes, result.nodes.get(), count, copies)) return std::nullopt;
    std::atomic<bool> too_deep = false;
    tbb::parallel_for(std::size_t{0}, copies.size(), [&](std::size_t i) {
      const Copy& copy = copies[i];
      std::uint32_t to = copy.to;
      if (!copy_subtree(copy.from, copy.depth, result.nodes.get(), to)) too_deep = true;
    });
    if (too_deep) return std::nullopt;
    return result;
  }

 private:
  /// A subtree below that is to be copied.
  struct Copy {
    std::uint32_t from, to;
    int depth;
  };

  static std::size_t nodes_in(const BinaryTree& tree) { return 2 * tree.order.size() - 1; }

  // A node is at least as large as those below, so that the largest are the tree's upper part.
  void open_largest() {
    struct Sized {
      float area;
      std::uint32_t node;
      bool operator<(const Sized& b) const {
        return area < b.area || (area == b.area && node > b.node);
      }
    };
    std::priority_queue<Sized> closed;
    const auto close = [&](std::uint32_t node) {
      if (!is_leaf(nodes_[node].child[1])) closed.push({nodes_[node].bounds.half_area(), node});
    };
    close(root_);
    std::size_t left = std::min(upper_max, nodes_in(tree_) / 5 + 1);
    for (; left > 0 && !closed.empty(); --left) {
      const std::uint32_t index = closed.top().node;
      closed.pop();
      const Bvh2Node& node = tree_.nodes[nodes_[index].child[1]];
      for (int i = 0; i < 2; ++i) {
        const auto child = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back({child_bounds(node, i), index, {nothing, node.child[i]}});
        nodes_[index].child[i] = child;
        close(child);
      }
    }
  }

  // Nodes lie in depth-first order; `count` are there already. Leaves room for the subtrees below.
  bool emit(std::uint32_t index, int depth, const std::vector<std::uint32_t>& sizes,
            Bvh2Node* result, std::uint32_t& count, std::vector<Copy>& copies) const {
    const Node& from = nodes_[index];
    if (from.is_subtree()) {
      if (is_leaf(from.child[1])) return true;
      copies.push_back({from.child[1], count, depth});
      count += sizes[index];
      return true;
    }
    if (depth >= bvh_depth_max) return false;
    Bvh2Node& node = result[count++];
    node.padding[0] = node.padding[1] = 0;
    for (int i = 0; i < 2; ++i) {
      const Node& child = nodes_[from.child[i]];
      set_child_bounds(node, i, child.bounds);
      const bool is_one = child.is_subtree() && is_leaf(child.child[1]);
      node.child[i] = is_one ? child.child[1] : count;
      if (!emit(from.child[i], depth + 1, sizes, result, count, copies)) return false;
    }
    return true;
  }

  std::uint32_t count_nodes(std::uint32_t subtree) const {
    if (is_leaf(subtree)) return 0;
    const Bvh2Node& node = tree_.nodes[subtree];
    return 1 + count_nodes(node.child[0]) + count_nodes(node.child[1]);
  }

  bool copy_subtree(std::uint32_t from, int depth, Bvh2Node* result, std::uint32_t& to) const {
    if (depth >= bvh_depth_max) return false;
    const Bvh2Node& old = tree_.nodes[from];
    Bvh2Node& node = result[to++];
    node = old;
    for (int i = 0; i < 2; ++i) {
      if (is_leaf(old.child[i])) continue;
      node.child[i] = to;
      if (!copy_subtree(old.child[i], depth + 1, result, to)) return false;
    }
    return true;
  }

  /// The largest first; the root, which cannot be moved, is left out.
  std::vector<std::uint32_t> largest_nodes() const {
    struct Sized {
      float area;
      std::uint32_t node;
    };
    std::vector<Sized> all;
    all.reserve(nodes_.size());
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
      if (i != root_) all.push_back({nodes_[i].bounds.half_area(), i});
    }
    const auto larger = [](const Sized& a, const Sized& b) {
      return a.area > b.area || (a.area == b.area && a.node < b.node);
    };
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), tried_));
    std::partial_sort(all.begin(), end, all.end(), larger);
    std::vector<std::uint32_t> nodes;
    std::transform(all.begin(), end, std::back_inserter(nodes),
                   [](const Sized& sized) { return sized.node; });
    return nodes;
  }

  std::uint32_t sibling(std::uint32_t node) const {
    const Node& parent = nodes_[nodes_[node].parent];
    return parent.child[parent.child[0] == node ? 1 : 0];
  }

  // A subtree that is taken out saves its parent's area and what the ancestors above shrink by; put
  // beside a node it costs the area of the new parent and what that node's ancestors grow by. So
  // the search goes up, and from each ancestor (the pivot, which stays as it is) down the other
  // side, as long as there may be a better position than the best.
  Move find_best_move(std::uint32_t moved) const {
    const Bounds& box = nodes_[moved].bounds;
    const float area = box.half_area();
    const std::uint32_t parent = nodes_[moved].parent;
    Move best;
    std::uint32_t visits = 0;
    float saved = nodes_[parent].bounds.half_area();
    Bounds without;  // the pivot's child without what is moved
    for (std::uint32_t below = moved, pivot = parent; pivot != nothing;
         below = pivot, pivot = nodes_[pivot].parent) {
      if (below != moved && below != parent) {
        saved += nodes_[below].bounds.half_area() - without.half_area();
      }
      search_down(sibling(below), pivot == parent, box, saved - area, best, visits);
      without.grow(nodes_[sibling(below)].bounds);
    }
    return best;
  }

  // `limit` is what could be gained at most. Beside the old sibling nothing would change.
  void search_down(std::uint32_t from, bool is_old_sibling, const Bounds& box, float limit,
                   Move& best, std::uint32_t& visits) const {
    struct Candidate {
      std::uint32_t node;
      float grown;  // of the ancestors below the pivot
    };
    std::array<Candidate, 2 * bvh_depth_max> stack;
    std::size_t depth = 0;
    const float area = box.half_area();
    stack[depth++] = {from, 0};
    while (depth > 0 && visits < visits_max) {
      ++visits;
      const Candidate candidate = stack[--depth];
      if (limit - candidate.grown <= best.gain) continue;
      const Node& node = nodes_[candidate.node];
      const float joint = joined(node.bounds, box).half_area();
      const float gain = limit + area - candidate.grown - joint;
      if (gain > best.gain && !(is_old_sibling && candidate.node == from)) {
        best = {gain, candidate.node};
      }
      const float grown = candidate.grown + joint - node.bounds.half_area();
      if (node.is_subtree() || limit - grown <= best.gain || depth + 2 > stack.size()) continue;
      for (const std::uint32_t child : node.child) stack[depth++] = {child, grown};
    }
  }

  void replace_child(std::uint32_t parent, std::uint32_t from, std::uint32_t to) {
    nodes_[to].parent = parent;
    if (parent == nothing) {
      root_ = to;
    } else {
      nodes_[parent].child[nodes_[parent].child[0] == from ? 0 : 1] = to;
    }
  }

  // The old parent becomes the new one. Above a node whose box stays, all boxes do.
  void apply(std::uint32_t moved, std::uint32_t at) {
    const std::uint32_t parent = nodes_[moved].parent, above = nodes_[parent].parent;
    replace_child(above, parent, sibling(moved));
    fit_upwards(above);
    const std::uint32_t new_above = nodes_[at].parent;
    replace_child(new_above, at, parent);
    nodes_[parent].child[0] = at, nodes_[parent].child[1] = moved;
    nodes_[at].parent = nodes_[moved].parent = parent;
    nodes_[parent].bounds = joined(nodes_[at].bounds, nodes_[moved].bounds);
    fit_upwards(new_above);
  }

  void fit_upwards(std::uint32_t index) {
    for (; index != nothing; index = nodes_[index].parent) {
      Node& node = nodes_[index];
      const Bounds box = joined(nodes_[node.child[0]].bounds, nodes_[node.child[1]].bounds);
      if (box.min == node.bounds.min && box.max == node.bounds.max) return;
      node.bounds = box;
    }
  }

  const BinaryTree& tree_;
  std::vector<Node> nodes_;
  std::uint32_t root_ = 0;
  std::size_t tried_;  // in a pass
};

}  // namespace

std::optional<BinaryTree> reinsert_nodes(const BinaryTree& tree) {
  if (is_leaf(tree.root)) return std::nullopt;
  Reinserter reinserter(tree);
  const double before = reinserter.area();
  for (int i = 0; i < passes; ++i) reinserter.pass();
  if (!(reinserter.area() <= (1 - least_saving) * before)) return std::nullopt;
  return reinserter.result();
}

}  // namespace pt
