#include "common/accel/build/reinsert_nodes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <vector>

namespace pt {

namespace {

constexpr int passes = 3;
constexpr std::size_t share = 10;  // a tenth of all nodes, by their areas, is tried in each pass
constexpr std::uint32_t nothing = 0xffffffffu;

/// A node or a leaf, with its box at hand and the way up.
struct Node {
  Bounds bounds;
  std::uint32_t parent;
  std::uint32_t child[2];  // of a leaf: nothing, and the tree's name for it

  bool is_leaf() const { return child[0] == nothing; }
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
  explicit Reinserter(const BinaryTree& tree) {
    nodes_.reserve(2 * tree.order.size());
    root_ = read(tree, tree.root, tree.bounds, nothing);
  }

  // What seems to gain is found by all threads in the tree as it is, then looked for again and
  // moved one by one, since the moves before may have changed where it goes.
  void pass() {
    const std::vector<std::uint32_t> tried = largest_nodes();
    std::vector<char> gains(tried.size());
    tbb::parallel_for(std::size_t{0}, tried.size(),
                      [&](std::size_t i) { gains[i] = find_place(tried[i]).gain > 0; });
    for (std::size_t i = 0; i < tried.size(); ++i) {
      if (gains[i] == 0) continue;
      const Move move = find_place(tried[i]);
      if (move.gain > 0) apply(tried[i], move.at);
    }
  }

  /// False where the tree is too deep; `nodes` have room for all.
  bool write(Bvh2Node* nodes) const {
    std::uint32_t count = 0;
    return emit(root_, 0, nodes, count);
  }

 private:
  std::uint32_t read(const BinaryTree& tree, std::uint32_t subtree, const Bounds& bounds,
                     std::uint32_t parent) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({bounds, parent, {nothing, subtree}});
    if (is_leaf(subtree)) return index;
    const Bvh2Node& node = tree.nodes[subtree];
    for (int i = 0; i < 2; ++i) {
      const std::uint32_t child = read(tree, node.child[i], child_bounds(node, i), index);
      nodes_[index].child[i] = child;
    }
    return index;
  }

  // In depth-first order.
  bool emit(std::uint32_t index, int depth, Bvh2Node* result, std::uint32_t& count) const {
    if (nodes_[index].is_leaf()) return true;
    if (depth >= bvh_depth_max) return false;
    Bvh2Node& node = result[count++];
    node.padding[0] = node.padding[1] = 0;
    for (int i = 0; i < 2; ++i) {
      const Node& child = nodes_[nodes_[index].child[i]];
      set_child_bounds(node, i, child.bounds);
      node.child[i] = child.is_leaf() ? child.child[1] : count;
      if (!emit(nodes_[index].child[i], depth + 1, result, count)) return false;
    }
    return true;
  }

  /// The largest first; the root, which has no other place, is left out.
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
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(all.size() / share);
    std::nth_element(all.begin(), end, all.end(), larger);
    std::sort(all.begin(), end, larger);
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
  // side, as long as there may be a better place than the best.
  Move find_place(std::uint32_t moved) const {
    const Bounds& box = nodes_[moved].bounds;
    const float area = box.half_area();
    const std::uint32_t parent = nodes_[moved].parent;
    Move best;
    float saved = nodes_[parent].bounds.half_area();
    Bounds without;  // the pivot's child without what is moved
    for (std::uint32_t below = moved, pivot = parent; pivot != nothing;
         below = pivot, pivot = nodes_[pivot].parent) {
      if (below != moved && below != parent) {
        saved += nodes_[below].bounds.half_area() - without.half_area();
      }
      search_down(sibling(below), pivot == parent, box, saved - area, best);
      without.grow(nodes_[sibling(below)].bounds);
    }
    return best;
  }

  // `limit` is what could be gained at most. Beside the old sibling nothing would change.
  void search_down(std::uint32_t from, bool is_old_sibling, const Bounds& box, float limit,
                   Move& best) const {
    struct Candidate {
      std::uint32_t node;
      float grown;  // of the ancestors below the pivot
    };
    std::array<Candidate, 2 * bvh_depth_max> stack;
    std::size_t depth = 0;
    const float area = box.half_area();
    stack[depth++] = {from, 0};
    while (depth > 0) {
      const Candidate candidate = stack[--depth];
      if (limit - candidate.grown <= best.gain) continue;
      const Node& node = nodes_[candidate.node];
      const float joint = joined(node.bounds, box).half_area();
      const float gain = limit + area - candidate.grown - joint;
      if (gain > best.gain && !(is_old_sibling && candidate.node == from)) {
        best = {gain, candidate.node};
      }
      const float grown = candidate.grown + joint - node.bounds.half_area();
      if (node.is_leaf() || limit - grown <= best.gain || depth + 2 > stack.size()) continue;
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

  std::vector<Node> nodes_;
  std::uint32_t root_ = 0;
};

}  // namespace

BinaryTree reinsert_nodes(const BinaryTree& tree) {
  BinaryTree result;
  result.bounds = tree.bounds, result.root = tree.root, result.order = tree.order;
  result.node_capacity = tree.node_capacity;
  result.nodes.reset(new Bvh2Node[tree.node_capacity]);
  if (is_leaf(tree.root)) return result;
  Reinserter reinserter(tree);
  for (int i = 0; i < passes; ++i) reinserter.pass();
  if (!reinserter.write(result.nodes.get())) {
    std::copy_n(tree.nodes.get(), tree.node_capacity, result.nodes.get());
  }
  return result;
}

}  // namespace pt
