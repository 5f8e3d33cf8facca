#include "common/accel/traverse_cwbvh_block.h"

#include "common/accel/traverse_cwbvh_avx2.h"

namespace pt {

#ifdef __x86_64__

namespace {

PT_AVX2 void prefetch(const void* p, std::size_t bytes) {
  const char* const begin = static_cast<const char*>(p);
  __builtin_prefetch(begin);
  __builtin_prefetch(begin + bytes - 1);
}

/// order_slots as a table: [octant][slots].
struct SlotOrders {
  std::uint8_t of[8][256];
};
constexpr SlotOrders slot_orders = [] {
  SlotOrders orders{};
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    for (std::uint32_t slots = 0; slots < 256; ++slots) {
      std::uint32_t ordered = 0;
      for (std::uint32_t s = 0; s < 8; ++s) ordered |= (slots >> s & 1u) << (s ^ octant);
      orders.of[octant][slots] = static_cast<std::uint8_t>(ordered);
    }
  }
  return orders;
}();

/// A ray on its way: what traverse_cwbvh_by keeps. Between two steps it knows its next node.
template <class Query>
class Traveller {
 public:
  PT_AVX2 void start(const TriangleTree& tree, const Ray& ray, float t_max) {
    query_ = Query(0.0f, t_max);
    ray_ = make_cwbvh_ray(ray);
    depth_ = 1;
    stack_[0] = nodes_ = root_group(tree.root, ray_.octant);
    choose_node(tree);
  }

  /// Tests the next node. True: leaves wait to be tested.
  PT_AVX2 bool visit_node(const TriangleTree& tree) {
    const CwbvhNode& node = *node_;
    const std::uint32_t hits = CwbvhTestsAvx2::node(node, ray_, query_.t_min(), query_.t_max());
    const std::uint32_t inner = node.inner_mask();
    nodes_ = {node.child_base, slot_orders.of[ray_.octant][hits & inner] | inner << 8};
    leaves_ = leaf_group(node, hits);
    __builtin_prefetch(&tree.triangles[leaves_.base]);
    return leaves_.has_slots();
  }

  /// True: the ray need not go on.
  PT_AVX2 bool visit_leaves(const TriangleTree& tree) {
    do {
      const CwbvhLeaf leaf = take_leaf(leaves_);
      if (CwbvhTestsAvx2::offer(tree, ray_.triangles, leaf, leaves_, query_)) return true;
    } while (leaves_.has_slots());
    return false;
  }

  /// True: there is a next node.
  PT_AVX2 bool choose_node(const TriangleTree& tree) {
    const bool here = nodes_.has_slots();
    const bool goes_on = here || depth_ > 1;
    // Without a branch, and at the end once more the root, which is not looked at.
    depth_ -= here ? 0 : 1;
    const CwbvhGroup* const from = here ? &nodes_ : &stack_[depth_];
    CwbvhGroup group = *from;
    node_ = &tree.cwbvh[take_child(group, ray_.octant)];
    prefetch(node_, sizeof *node_);
    stack_[depth_] = group;
    depth_ += group.has_slots() ? 1 : 0;
    return goes_on;
  }

  void stop() { nodes_.bits = 0, depth_ = 1; }
  const Query& query() const { return query_; }

 private:
  CwbvhRay ray_;
  Query query_{0.0f, 0.0f};
  CwbvhGroup nodes_, leaves_;
  const CwbvhNode* node_;
  int depth_;
  CwbvhGroup stack_[bvh_depth_max + 2];
};

/// Numbers of rays.
struct RayList {
  std::uint32_t count = 0;
  std::uint8_t rays[RayBlock::size_max + 1];

  /// Without a branch.
  void append_if(bool condition, std::uint8_t ray) {
    rays[count] = ray;
    count += condition ? 1 : 0;
  }
};

/// Calls finish.take(number, query) for each ray that may meet anything. All go from node to node
/// together: the same few steps for each ray in turn, so that there is little to be guessed wrong,
/// and while one ray waits for memory others go on.
template <class Query, class Finish>
PT_AVX2 void trace_in_turns(const TriangleTree& tree, const RayBlock& rays, Finish& finish) {
  if (tree.triangle_count == 0) return;
  Traveller<Query> travellers[RayBlock::size_max];
  RayList going, at_leaves;
  for (std::uint32_t i = 0; i < rays.count; ++i) {
    const Ray ray = rays.ray(i);
    if (!is_traceable(ray) || !(rays.t_max[i] > 0.0f)) continue;
    travellers[i].start(tree, ray, rays.t_max[i]);
    going.append_if(true, static_cast<std::uint8_t>(i));
  }
  const RayList all = going;
  while (going.count > 0) {
    at_leaves.count = 0;
    for (std::uint32_t k = 0; k < going.count; ++k) {
      at_leaves.append_if(travellers[going.rays[k]].visit_node(tree), going.rays[k]);
    }
    for (std::uint32_t k = 0; k < at_leaves.count; ++k) {
      Traveller<Query>& traveller = travellers[at_leaves.rays[k]];
      if (traveller.visit_leaves(tree)) traveller.stop();
    }
    const std::uint32_t count = going.count;
    going.count = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
      going.append_if(travellers[going.rays[k]].choose_node(tree), going.rays[k]);
    }
  }
  for (std::uint32_t k = 0; k < all.count; ++k) {
    finish.take(all.rays[k], travellers[all.rays[k]].query());
  }
}

struct StoreHits {
  HitBlock& hits;
  void take(std::uint32_t number, const ClosestTriangle& query) {
    const Hit hit = query.result();
    hits.t[number] = hit.t;
    hits.primitive[number] = hit.primitive;
  }
};

struct CollectOccluded {
  std::uint32_t occluded = 0;
  void take(std::uint32_t number, const AnyTriangle& query) {
    occluded |= (query.result() ? 1u : 0u) << number;
  }
};

}  // namespace

PT_AVX2 void closest_triangles_in_turns(const TriangleTree& tree, const RayBlock& rays,
                                        HitBlock& hits) {
  for (std::uint32_t i = 0; i < rays.count; ++i) hits.primitive[i] = no_primitive;
  StoreHits store{hits};
  trace_in_turns<ClosestTriangle>(tree, rays, store);
}

PT_AVX2 std::uint32_t any_triangles_in_turns(const TriangleTree& tree, const RayBlock& rays) {
  CollectOccluded collect;
  trace_in_turns<AnyTriangle>(tree, rays, collect);
  return collect.occluded;
}

#else

void closest_triangles_in_turns(const TriangleTree&, const RayBlock&, HitBlock&) {}
std::uint32_t any_triangles_in_turns(const TriangleTree&, const RayBlock&) { return 0; }

#endif

}  // namespace pt
