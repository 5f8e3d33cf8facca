// The rays of a block on their ways through the wide tree, in turns: first each tests its next
// node, then all triangles that their leaves hold are tested, eight pairs of a ray and a triangle
// at once, then each ray chooses the node after that and asks memory for it. Few
// branches are mispredicted, and while one ray waits for memory others continue. `Isa` is the
// processor's:
//   Lanes                                    eight floats (lanes.h)
//   meet_node(node, ray, octant)             as intersect_cwbvh_node
//   list_triangles(node, hits, ray, pairs)   appends those of the leaves among `hits`
// PT_LANES says for what functions here are compiled; all of them depend on Isa.
#pragma once

#include "common/accel/trace_cpu/lanes.h"
#include "common/accel/trace_cpu/ray_block.h"
#include "common/accel/traverse_cwbvh.h"

#ifdef __x86_64__

namespace pt {

/// A ray as nodes and triangles are tested with it: CwbvhRay in rows of four, and how far it goes.
struct alignas(64) TurnRay {
  float origin[3], triangle_inverse;
  float x_axis[3];
  std::uint32_t axis;
  float y_axis[3], t_max;
  float inverse[4];  ///< the last one is 0
};

/// Rays and triangles that are to be tested, by their index in the block and their slot.
struct TrianglePairs {
  static constexpr std::uint32_t of_ray_max = cwbvh_width * cwbvh_leaf_max;
  static constexpr std::uint32_t size_max = RayBlock::size_max * of_ray_max;

  std::uint32_t count = 0;
  std::uint32_t slots[size_max + of_ray_max];  // what is appended is stored as whole lanes
  std::uint8_t rays[size_max + of_ray_max];

  void append(std::uint32_t ray, std::uint32_t slot) {
    rays[count] = static_cast<std::uint8_t>(ray);
    slots[count++] = slot;
  }

  /// Repeats the first pair behind the last one, for lanes that would be empty.
  void fill_lanes() {
    for (std::uint32_t k = 0; k < 8; ++k) {
      rays[count + k] = rays[0];
      slots[count + k] = slots[0];
    }
  }
};

/// order_slots as a table: [octant][slots].
struct SlotOrders {
  std::uint8_t of[8][256];
};
inline constexpr SlotOrders slot_orders = [] {
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

/// What a TurnRay takes from constants, by the axis along which its direction is largest: which
/// components of -direction / largest its axes have, and where 1 and 0 stand.
struct alignas(16) AxisRow {
  std::int32_t from[4];
  std::uint32_t taken[4];  ///< as masks
  float constant[4];
};
inline constexpr AxisRow x_axis_rows[3] = {
    {{1, 0, 0, 0}, {~0u, 0, 0, 0}, {0.0f, 1.0f, 0.0f, 0.0f}},
    {{0, 2, 0, 0}, {0, ~0u, 0, 0}, {0.0f, 0.0f, 1.0f, 0.0f}},
    {{0, 0, 0, 0}, {0, 0, ~0u, 0}, {1.0f, 0.0f, 0.0f, 0.0f}}};
inline constexpr AxisRow y_axis_rows[3] = {
    {{2, 0, 0, 0}, {~0u, 0, 0, 0}, {0.0f, 0.0f, 1.0f, 0.0f}},
    {{0, 0, 0, 0}, {0, ~0u, 0, 0}, {1.0f, 0.0f, 0.0f, 0.0f}},
    {{0, 0, 1, 0}, {0, 0, ~0u, 0}, {0.0f, 1.0f, 0.0f, 0.0f}}};

/// As make_cwbvh_ray, without branches. The octant.
template <class Isa>
PT_LANES std::uint32_t make_turn_ray(const Ray& ray, float t_max, TurnRay& result) {
  const __m128 sign = _mm_set1_ps(-0.0f);
  const __m128 d = _mm_setr_ps(ray.direction.x, ray.direction.y, ray.direction.z, 0.0f);
  const __m128 size = _mm_andnot_ps(sign, d);
  const Vec3 length = glm::abs(ray.direction);
  const unsigned z = unsigned{length.z >= length.x} & unsigned{length.z >= length.y};
  const std::uint32_t axis = 2 * z + ((z ^ 1u) & unsigned{length.y >= length.x});
  const __m128 safe =
      _mm_or_ps(_mm_max_ps(size, _mm_set1_ps(cwbvh_least_direction)), _mm_and_ps(sign, d));
  const __m128 largest = _mm_permutevar_ps(d, _mm_set1_epi32(static_cast<int>(axis)));
  const __m128 inverse = _mm_set1_ps(1.0f) / _mm_blend_ps(safe, largest, 8);
  const __m128 slopes = _mm_xor_ps(sign, d) * _mm_permute_ps(inverse, 0xff);
  const auto make_axis = [slopes](const AxisRow& row) PT_LANES {
    const __m128 taken =
        _mm_permutevar_ps(slopes, _mm_load_si128(reinterpret_cast<const __m128i*>(row.from)));
    return _mm_or_ps(_mm_and_ps(taken, _mm_load_ps(reinterpret_cast<const float*>(row.taken))),
                     _mm_load_ps(row.constant));
  };
  _mm_store_ps(
      result.origin,
      _mm_blend_ps(_mm_setr_ps(ray.origin.x, ray.origin.y, ray.origin.z, 0.0f), inverse, 8));
  const __m128 last = _mm_castsi128_ps(_mm_set1_epi32(static_cast<int>(axis)));
  _mm_store_ps(result.x_axis, _mm_blend_ps(make_axis(x_axis_rows[axis]), last, 8));
  _mm_store_ps(result.y_axis, _mm_blend_ps(make_axis(y_axis_rows[axis]), _mm_set1_ps(t_max), 8));
  _mm_store_ps(result.inverse, _mm_blend_ps(inverse, _mm_setzero_ps(), 8));
  return static_cast<std::uint32_t>(_mm_movemask_ps(d)) & 7u;
}

/// The three floats at p[i] + 4 * row of eight pointers, by component, and what follows them.
template <class Isa>
PT_LANES inline void load_eight(const float* const (&p)[8], int row, __m256 (&result)[4]) {
  __m256 r[4];
  PT_UNROLL(4)
  for (int k = 0; k < 4; ++k) {
    r[k] = _mm256_set_m128(_mm_load_ps(p[k + 4] + 4 * row), _mm_load_ps(p[k] + 4 * row));
  }
  const __m256 a = _mm256_unpacklo_ps(r[0], r[1]), b = _mm256_unpacklo_ps(r[2], r[3]);
  const __m256 c = _mm256_unpackhi_ps(r[0], r[1]), d = _mm256_unpackhi_ps(r[2], r[3]);
  result[0] = _mm256_shuffle_ps(a, b, 0x44);
  result[1] = _mm256_shuffle_ps(a, b, 0xee);
  result[2] = _mm256_shuffle_ps(c, d, 0x44);
  result[3] = _mm256_shuffle_ps(c, d, 0xee);
}

/// Where the rays of eight pairs, from `first` on, meet the pairs' triangles: bit k of the result
/// says that the k-th one does at t[k], 0 < t[k] <= t_max. As intersect_triangle.
template <class Isa>
PT_LANES inline std::uint32_t meet_pairs(const TurnRay* rays, const Triangle* triangles,
                                         const TrianglePairs& pairs, std::uint32_t first,
                                         float (&t)[8]) {
  using L = typename Isa::Lanes;
  const float *ray[8], *triangle[8];
  PT_UNROLL(8)
  for (std::uint32_t k = 0; k < 8; ++k) {
    ray[k] = rays[pairs.rays[first + k]].origin;
    triangle[k] = &triangles[pairs.slots[first + k]].v0.x;
  }
  __m256 origin[4], x_axis[4], y_axis[4];
  load_eight<Isa>(ray, 0, origin);
  load_eight<Isa>(ray, 1, x_axis);
  load_eight<Isa>(ray, 2, y_axis);
  const __m256i axis = _mm256_castps_si256(x_axis[3]);
  const __m256 is_y = _mm256_castsi256_ps(_mm256_cmpeq_epi32(axis, _mm256_set1_epi32(1)));
  const __m256 is_z = _mm256_castsi256_ps(_mm256_cmpeq_epi32(axis, _mm256_set1_epi32(2)));
  __m256 x[3], y[3], depth[3];  // of the vertices
  PT_UNROLL(3)
  for (int v = 0; v < 3; ++v) {
    __m256 p[4];
    load_eight<Isa>(triangle, v, p);
    PT_UNROLL(3)
    for (int i = 0; i < 3; ++i) p[i] = p[i] - origin[i];
    x[v] = x_axis[0] * p[0] + (x_axis[1] * p[1] + x_axis[2] * p[2]);
    y[v] = y_axis[0] * p[0] + (y_axis[1] * p[1] + y_axis[2] * p[2]);
    depth[v] = _mm256_blendv_ps(_mm256_blendv_ps(p[0], p[1], is_y), p[2], is_z);
  }
  __m256 at;
  const auto met = meet_projected<L>(x, y, depth, origin[3], L::all(0.0f), y_axis[3], at);
  _mm256_storeu_ps(t, at);
  return L::bits(met);
}

/// What a block's rays look for: their nearest hits. offer() is told of a triangle that ray `i`
/// meets at t <= t_max; true: the ray's traversal ends.
struct ClosestOfBlock {
  HitBlock& hits;

  bool offer(const TriangleTree& tree, std::uint32_t i, float t, std::uint32_t slot,
             float& t_max) const {
    std::uint32_t& best = hits.primitive[i];
    const bool is_hit = best != no_primitive;
    // As ClosestTriangle; at the ray's own end there is nothing to be met.
    if (t < t_max || (is_hit && tree.triangles[slot].id < tree.triangles[best].id)) {
      hits.t[i] = t_max = t;
      best = slot;
    }
    return false;
  }
};

/// Any hit nearer than the ray's end.
struct AnyOfBlock {
  std::uint32_t occluded = 0;

  bool offer(const TriangleTree&, std::uint32_t i, float t, std::uint32_t, float& t_max) {
    if (!(t < t_max)) return false;
    occluded |= 1u << i;
    t_max = -1.0f;  // nothing else is met
    return true;
  }
};

/// See above. A ray's way: nodes that are left to visit.
template <class Isa, class Query>
class TurnsOfBlock {
 public:
  PT_LANES TurnsOfBlock(const TriangleTree& tree, const RayBlock& rays, const BlockMask* mask,
                        Query& query)
      : tree_(tree), block_(rays), mask_(mask), query_(query) {}

  PT_LANES void trace() {
    if (tree_.triangle_count == 0) return;
    for (std::uint32_t i = 0; i < block_.count; ++i) {
      const Ray ray = block_.ray(i);
      if (!is_traceable(ray) || !(block_.t_max[i] > 0.0f)) continue;
      Way& way = ways_[i];
      way.octant = make_turn_ray<Isa>(ray, block_.t_max[i], rays_[i]);
      way.depth = 0;
      way.node = &tree_.cwbvh[tree_.root];
      way.stack[0] = root_group(tree_.root, way.octant);
      going_[count_++] = static_cast<std::uint8_t>(i);
    }
    while (count_ > 0) {
      pairs_.count = 0;
      std::uint8_t hits[RayBlock::size_max];
      const std::uint32_t count = count_;
      for (std::uint32_t k = 0; k < count; ++k) {
        const Way& way = ways_[going_[k]];
        hits[k] =
            static_cast<std::uint8_t>(Isa::meet_node(*way.node, rays_[going_[k]], way.octant));
      }
      for (std::uint32_t k = 0; k < count; ++k) visit_node(going_[k], hits[k]);
      if (pairs_.count > 0) test_pairs();
      choose_nodes();
    }
  }

 private:
  struct Way {
    std::uint32_t octant;
    int depth;  ///< groups on the stack; below them lies one more, which is never emptied
    const CwbvhNode* node;
    CwbvhGroup stack[bvh_depth_max + 2];
  };

  PT_LANES void visit_node(std::uint32_t i, std::uint32_t hits) {
    Way& way = ways_[i];
    const CwbvhNode& node = *way.node;
    const std::uint32_t inner = node.inner_mask();
    const std::uint32_t slots = slot_orders.of[way.octant][hits & inner];
    way.stack[way.depth + 1] = {node.child_base, slots | inner << 8};
    way.depth += slots != 0 ? 1 : 0;
    Isa::list_triangles(node, hits, i, pairs_);
    __builtin_prefetch(&tree_.triangles[node.triangle_base]);
  }

  PT_LANES void test_pairs() {
    pairs_.fill_lanes();
    for (std::uint32_t first = 0; first < pairs_.count; first += 8) {
      float t[8];
      std::uint32_t met = meet_pairs<Isa>(rays_, tree_.triangles, pairs_, first, t);
      const std::uint32_t left = pairs_.count - first;
      if (left < 8) met &= (1u << left) - 1u;
      for (; met != 0; met &= met - 1) {
        const auto k = static_cast<std::uint32_t>(__builtin_ctz(met));
        offer(pairs_.rays[first + k], pairs_.slots[first + k], t[k]);
      }
    }
  }

  PT_LANES void offer(std::uint32_t i, std::uint32_t slot, float t) {
    float& t_max = rays_[i].t_max;
    if (!(t <= t_max)) return;  // since then another was met
    const bool is_masked =
        mask_ != nullptr && (tree_.triangles[slot].attributes & TriangleAttributes::masked) != 0;
    if (is_masked && mask_->hides(mask_->scene, block_, i, slot)) return;
    if (query_.offer(tree_, i, t, slot, t_max)) ways_[i].depth = 0;
  }

  PT_LANES void choose_nodes() {
    const CwbvhNode* const nodes = tree_.cwbvh;
    std::uint32_t count = 0;  // of those that continue
    for (std::uint32_t k = 0; k < count_; ++k) {
      const std::uint8_t i = going_[k];
      Way& way = ways_[i];
      const int depth = way.depth;
      going_[count] = i;
      count += depth > 0 ? 1 : 0;
      CwbvhGroup group = way.stack[depth];
      const CwbvhNode* const node = &nodes[take_child(group, way.octant)];
      way.node = node;
      way.stack[depth].bits = group.bits;
      way.depth = depth - (group.has_slots() ? 0 : 1);
      __builtin_prefetch(node);
      __builtin_prefetch(reinterpret_cast<const char*>(node) + sizeof(CwbvhNode) - 1);
    }
    count_ = count;
  }

  const TriangleTree& tree_;
  const RayBlock& block_;
  const BlockMask* mask_;
  Query& query_;
  std::uint32_t count_ = 0;
  std::uint8_t going_[RayBlock::size_max + 1];
  TurnRay rays_[RayBlock::size_max];
  Way ways_[RayBlock::size_max];
  TrianglePairs pairs_;
};

template <class Isa>
struct TreeBlockBy {
  PT_LANES static void closest(const TriangleTree& tree, const RayBlock& rays,
                               const BlockMask* mask, HitBlock& hits) {
    for (std::uint32_t i = 0; i < rays.count; ++i) hits.primitive[i] = no_primitive;
    ClosestOfBlock query{hits};
    TurnsOfBlock<Isa, ClosestOfBlock>(tree, rays, mask, query).trace();
  }
  PT_LANES static std::uint32_t any(const TriangleTree& tree, const RayBlock& rays,
                                    const BlockMask* mask) {
    AnyOfBlock query;
    TurnsOfBlock<Isa, AnyOfBlock>(tree, rays, mask, query).trace();
    return query.occluded;
  }
  static constexpr TreeBlock functions = {closest, any};
};

}  // namespace pt

#endif
