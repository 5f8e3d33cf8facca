// Parallel reinsertion (Meister and Bittner 2018, 'Parallel Reinsertion for Bounding Volume
// Hierarchy Optimization'): what one thread does in each kernel. Subtrees are taken out of a binary
// tree and put in where the sum of all nodes' areas falls most; all moves of a pass are found in
// the same tree and made at once. reinsert.cu launches the steps, and tests run them on the CPU.
//
// Moves that would change the same node, or make a cycle together, are told apart by keys, so that
// the tree does not depend on the order of the threads.
#pragma once

#include "common/accel/build/binary/build_tree.h"

namespace pt::device_build {

inline constexpr std::uint32_t no_node = 0xffffffffu;

/// A pass tries every n-th subtree, the next pass those after them. Fewer at a time are in each
/// other's way less often: as many searches gain more.
inline constexpr std::uint32_t reinsertion_stride = 4;
inline constexpr int reinsertion_passes = 16;

/// Bounds of a search, for scenes of many boxes inside one another. Elsewhere a search takes 40 to
/// 50 steps, hardly ever more than 200, and fills half of the stack.
inline constexpr int reinsertion_steps = 256;
inline constexpr int reinsertion_stack = 16;

/// What a move must gain, as a share of the parent's area: less is rounding, or not worth it.
inline constexpr float reinsertion_least_gain = 1.0f / 128;

/// Where a subtree is to go: beside `to`, into a new node.
struct alignas(16) Move {
  float gain = 0;                 ///< of area
  TreeRef to = no_node;           ///< no_node: stays
  std::uint32_t pivot = no_node;  ///< the deepest node above both places, which keeps its box
  std::uint32_t padding = 0;
};

/// Arrays [2 count] are of subtrees by number: nodes, then primitives.
struct ReinsertionJob {
  std::uint32_t count = 0;  ///< primitives, at least 2
  const BuildNode* primitives = nullptr;
  BuildNode* nodes = nullptr;  ///< [count]; one is none, and has no_node for its children
  TreeRef* root = nullptr;
  std::uint32_t* parents = nullptr;   ///< [2 count], starts as ones; of the root: no_node
  std::uint64_t* locks = nullptr;     ///< [2 count], zeros in each pass: keys of moves
  std::uint32_t* arrivals = nullptr;  ///< [count], starts as zeros, and is left so
  Move* moves = nullptr;              ///< [candidates()]
  std::uint32_t first = 0;            ///< the pass tries this subtree and every n-th one after it

  PT_HD std::uint32_t candidates() const {
    return (2 * count - first + reinsertion_stride - 1) / reinsertion_stride;
  }
  PT_HD std::uint32_t candidate(std::uint32_t i) const { return first + i * reinsertion_stride; }
};

// While nodes move, a TreeRef's count is only known to be that of a primitive or not.

PT_HD TreeRef node_ref(std::uint32_t node) { return make_ref(many_primitives, node); }
PT_HD std::uint32_t number_of(const ReinsertionJob& job, TreeRef ref) {
  return is_primitive(ref) ? job.count + ref_index(ref) : ref_index(ref);
}
PT_HD TreeRef numbered_ref(const ReinsertionJob& job, std::uint32_t number) {
  return number < job.count ? node_ref(number) : make_ref(1, number - job.count);
}
PT_HD std::uint32_t& parent_of(const ReinsertionJob& job, TreeRef ref) {
  return job.parents[number_of(job, ref)];
}
PT_HD BuildNode load_subtree(const ReinsertionJob& job, TreeRef ref) {
  return load_wide((is_primitive(ref) ? job.primitives : job.nodes) + ref_index(ref));
}
PT_HD bool is_same(const ReinsertionJob& job, TreeRef a, TreeRef b) {
  return number_of(job, a) == number_of(job, b);
}
PT_HD TreeRef other_child(const ReinsertionJob& job, const BuildNode& node, TreeRef child) {
  return is_same(job, node.left, child) ? node.right : node.left;
}

/// Before the first pass, for each node.
PT_HD void link_children(const ReinsertionJob& job, std::uint32_t node) {
  const BuildNode n = load_wide(&job.nodes[node]);
  if (n.left == no_node) return;
  parent_of(job, n.left) = node;
  parent_of(job, n.right) = node;
}

// ---- Step 1: the best move of each candidate ----

/// A search's candidate, and the best that it has found.
struct MoveSearch {
  Bounds box;
  float area;
  Move best;
  int steps_left = reinsertion_steps;
};

/// Looks for a place from `ref`, the pivot's other child, down. `limit` is what could be gained at
/// most. Beside the old sibling nothing is. Comparisons are false for NaN.
PT_HD void search_down(const ReinsertionJob& job, std::uint32_t pivot, TreeRef ref, BuildNode node,
                       float limit, MoveSearch& search) {
  struct Waiting {
    TreeRef ref;
    float grown;
  };
  Waiting stack[reinsertion_stack];
  int waiting = 0;
  float grown = 0;  // what the nodes between the pivot and `ref` grow by
  if (!(limit > search.best.gain)) return;
  while (search.steps_left-- > 0) {
    Bounds joint = node.bounds();
    joint.grow(search.box);
    const float joint_area = joint.half_area();
    const float gain = limit + search.area - grown - joint_area;
    if (gain > search.best.gain) search.best = {gain, ref, pivot};
    grown += joint_area - node.bounds().half_area();
    if (!is_primitive(ref) && limit - grown > search.best.gain && waiting < reinsertion_stack) {
      stack[waiting++] = {node.right, grown};
      ref = node.left;
    } else {
      do {
        if (waiting == 0) return;
        --waiting;
        ref = stack[waiting].ref, grown = stack[waiting].grown;
      } while (!(limit - grown > search.best.gain));
    }
    node = load_subtree(job, ref);
  }
}

/// A subtree that is taken out saves its parent's area and what the ancestors above shrink by; put
/// beside a node it costs the area of the new parent and what that node's ancestors grow by. So
/// the search goes up, and from each ancestor (the pivot, which stays as it is) down the other
/// side. As find_best_move in reinsert_nodes.cpp.
PT_HD Move find_best_move(const ReinsertionJob& job, std::uint32_t candidate) {
  const TreeRef moved = numbered_ref(job, candidate);
  const std::uint32_t parent = parent_of(job, moved);
  if (parent == no_node) return {};  // the root, or no node at all
  MoveSearch search;
  search.box = load_subtree(job, moved).bounds();
  search.area = search.box.half_area();
  float saved = load_wide(&job.nodes[parent]).bounds().half_area();
  search.best.gain = reinsertion_least_gain * saved;
  Bounds without;  // the pivot's box without what is moved
  TreeRef below = moved;
  for (std::uint32_t pivot = parent; pivot != no_node && search.steps_left-- > 0;
       pivot = job.parents[pivot]) {
    const BuildNode above = load_wide(&job.nodes[pivot]);
    const TreeRef sibling = other_child(job, above, below);
    const BuildNode sibling_node = load_subtree(job, sibling);
    search_down(job, pivot, sibling, sibling_node, saved - search.area, search);
    without.grow(sibling_node.bounds());
    if (pivot != parent) saved += above.bounds().half_area() - without.half_area();
    below = node_ref(pivot);
  }
  return search.best;
}

PT_HD void find_move(const ReinsertionJob& job, std::uint32_t i) {
  store_wide(&job.moves[i], find_best_move(job, job.candidate(i)));
}

// ---- Steps 2 to 4: which moves are made ----

/// The subtrees whose links to their parents a move changes. Moves that share none of them change
/// different links, though perhaps of one node.
struct ChangedLinks {
  TreeRef moved, sibling, to;
  std::uint32_t parent;

  template <class Visit>
  PT_HD void for_each(Visit&& visit) const {
    visit(moved);
    visit(sibling);
    visit(node_ref(parent));
    visit(to);
  }
};

PT_HD ChangedLinks links_of(const ReinsertionJob& job, TreeRef moved, TreeRef to) {
  const std::uint32_t parent = parent_of(job, moved);
  const BuildNode node = load_wide(&job.nodes[parent]);
  return {moved, other_child(job, node, moved), to, parent};
}

/// Of conflicting moves the one with the largest key is made: the one with the largest gain.
PT_HD std::uint64_t move_key(const Move& move, std::uint32_t candidate) {
  return static_cast<std::uint64_t>(float_to_bits(move.gain)) << 32 | candidate;
}
/// Marks the lock of a subtree that itself moves; no gain is negative.
inline constexpr std::uint64_t moving_bit = std::uint64_t{1} << 63;

/// Step 2: locks the links. raise(lock, key) sets the lock to the key if that is larger.
template <class Raise>
PT_HD void lock_links(const ReinsertionJob& job, std::uint32_t i, Raise&& raise) {
  const Move move = load_wide(&job.moves[i]);
  if (move.to == no_node) return;
  const std::uint64_t key = move_key(move, job.candidate(i));
  links_of(job, numbered_ref(job, job.candidate(i)), move.to).for_each([&](TreeRef ref) {
    raise(&job.locks[number_of(job, ref)], key);
  });
}

/// Step 3: a move that has not got all of its locks is given up. Others' reads of a lock that gets
/// its bit here find a key that is not theirs, before as after.
PT_HD void claim_links(const ReinsertionJob& job, std::uint32_t i) {
  const Move move = load_wide(&job.moves[i]);
  if (move.to == no_node) return;
  const std::uint32_t candidate = job.candidate(i);
  const std::uint64_t key = move_key(move, candidate);
  bool has_all = true;
  links_of(job, numbered_ref(job, candidate), move.to).for_each([&](TreeRef ref) {
    has_all = has_all && job.locks[number_of(job, ref)] == key;
  });
  if (has_all) {
    job.locks[candidate] = key | moving_bit;
  } else {
    job.moves[i].to = no_node;
  }
}

/// Step 4: a move is given up if on the way down from its pivot something moves by a larger key.
///
/// No cycle is left. Cut out what moves: each moving subtree, less those inside it, then hangs in
/// another one, that of the nearest moving node above its new place. Either it was below that node
/// before ('inside'), or it comes in from elsewhere, and that node lies on its way down ('enters').
/// If a enters b, and b was inside c, then a enters c or was inside it. So a cycle can be shortened
/// until it has moves that enter only, as the other kind alone makes none: and of these the one of
/// the least key is given up.
PT_HD void break_cycles(const ReinsertionJob& job, std::uint32_t i) {
  const Move move = load_wide(&job.moves[i]);
  if (move.to == no_node) return;
  const std::uint64_t key = move_key(move, job.candidate(i)) | moving_bit;
  for (std::uint32_t node = parent_of(job, move.to); node != move.pivot; node = job.parents[node]) {
    if (job.locks[node] > key) {
      job.moves[i].to = no_node;
      return;
    }
  }
}

// ---- Step 5: the moves ----

/// Others may change the parent's other link meanwhile, to something that is not `from` either.
PT_HD void replace_child(const ReinsertionJob& job, TreeRef from, TreeRef to) {
  const std::uint32_t parent = parent_of(job, from);
  parent_of(job, to) = parent;
  if (parent == no_node) {
    *job.root = to;
  } else {
    BuildNode& node = job.nodes[parent];
    (is_same(job, node.left, from) ? node.left : node.right) = to;
  }
}

/// The old parent becomes the new one. Boxes are wrong until all is refitted.
PT_HD void apply_move(const ReinsertionJob& job, std::uint32_t i) {
  const Move move = load_wide(&job.moves[i]);
  if (move.to == no_node) return;
  const ChangedLinks links = links_of(job, numbered_ref(job, job.candidate(i)), move.to);
  replace_child(job, node_ref(links.parent), links.sibling);
  replace_child(job, links.to, node_ref(links.parent));
  parent_of(job, links.to) = links.parent;
  job.nodes[links.parent].left = links.to;
  job.nodes[links.parent].right = links.moved;
}

// ---- Step 6: boxes and counts ----

PT_HD TreeRef counted_ref(TreeRef ref, const BuildNode& node) {
  return is_primitive(ref) ? ref
                           : make_ref(ref_count(node.left) + ref_count(node.right), ref_index(ref));
}

/// Climbs from a primitive; of two that meet at a node the second one goes on. `device` has
/// arrives_second(counter), which leaves zero for the next pass; load(ref), a subtree as another
/// thread has written it; and finish(index, node, left box, right box), which stores the node.
template <class Device>
PT_HD void refit_upwards(const ReinsertionJob& job, std::uint32_t primitive, Device&& device) {
  std::uint32_t index = job.parents[job.count + primitive];
  while (device.arrives_second(&job.arrivals[index])) {
    BuildNode node = job.nodes[index];
    const BuildNode left = device.load(node.left), right = device.load(node.right);
    node.left = counted_ref(node.left, left);
    node.right = counted_ref(node.right, right);
    Bounds box = left.bounds();
    box.grow(right.bounds());
    node.min = box.min, node.max = box.max;
    device.finish(index, node, left.bounds(), right.bounds());
    const std::uint32_t parent = job.parents[index];
    if (parent == no_node) {
      *job.root = counted_ref(node_ref(index), node);
      return;
    }
    index = parent;
  }
}

}  // namespace pt::device_build
