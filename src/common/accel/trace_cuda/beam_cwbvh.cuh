// Coherent rays as a beam: a warp's 32 rays go down the wide tree as one, its lanes test boxes
// instead of rays.
//
// Neighbouring camera rays visit nearly the same nodes: on a mesh of 70 k triangles the 32 rays of
// an 8 x 4 tile visit 28 nodes of a binary tree together and 27 each. So the warp bounds its rays
// and traverses by interval arithmetic (Boulos, Wald and Shirley 2006, 'Geometric and Arithmetic
// Culling Methods for Entire Ray Packets'), one child per lane, four nodes at a time. Leaves that
// the beam meets are queued; then each lane tests their boxes against its own ray, and the
// triangles of those that it hits. Nodes lie near to far on the stack, by the octant that all rays
// have in common.
#pragma once

#include "common/accel/traverse_cwbvh.h"

namespace pt {

/// What bounds a warp's coherent rays: intervals of origins and of inverse directions, axis by
/// axis, in shared memory. Distances are relative to `center`, the first ray's origin. Along an
/// axis the beam enters a plane at distance d not before d * near_inverse + near_offset, and leaves
/// it not after d * far_inverse + far_offset; behind the origins both are negative.
struct alignas(16) Beam {
  float center[4];
  float outward[4];  ///< beam_tolerance, or less that for positive directions
  float near_inverse[4], near_offset[4];
  float far_inverse[4], far_offset[4];
};

/// As cwbvh_origin_tolerance, of a beam's rays, relative to the distance from its center.
inline constexpr float beam_tolerance = 16.0f * half_ulp;

/// Beams wider than this, relative to their direction, do not pay.
inline constexpr float beam_width_max = 0.25f;

/// The least and the largest |x| of a warp, for the same signs of all.
__device__ inline float warp_min_magnitude(float x) {
  return __uint_as_float(warp_min(__float_as_uint(x) & 0x7fffffffu));
}
__device__ inline float warp_max_magnitude(float x) {
  return __uint_as_float(warp_max(__float_as_uint(x) & 0x7fffffffu));
}

/// By the whole warp. Sets `width` to how much the directions differ; false: in their signs.
__device__ inline bool make_beam_axis(float origin, float inverse, int i, Beam& beam,
                                      float& width) {
  constexpr unsigned whole_warp = 0xffffffffu;
  const unsigned negative = __ballot_sync(whole_warp, inverse < 0.0f);
  const float center = __shfl_sync(whole_warp, origin, 0);
  const float spread = __all_sync(whole_warp, origin == center)
                           ? 0.0f
                           : warp_max_magnitude(origin - center) * (1.0f + beam_tolerance);
  const float least = warp_min_magnitude(inverse), most = warp_max_magnitude(inverse);
  beam.center[i] = center;
  beam.outward[i] = negative != 0 ? beam_tolerance : -beam_tolerance;
  beam.near_inverse[i] = negative != 0 ? -least : least;
  beam.far_inverse[i] = negative != 0 ? -most : most;
  beam.near_offset[i] = -spread * least;
  beam.far_offset[i] = spread * most;
  width = (most - least) / least;
  return negative == 0 || negative == whole_warp;
}

/// By the whole warp, whose lanes read the beam after the next __syncwarp. False in lanes that see
/// rays that are not coherent; the inverse directions are finite.
__device__ inline bool make_beam(const Vec3& origin, const Vec3& inverse, Beam& beam) {
  float width_x, width_y, width_z;
  bool is_coherent = make_beam_axis(origin.x, inverse.x, 0, beam, width_x);
  is_coherent &= make_beam_axis(origin.y, inverse.y, 1, beam, width_y);
  is_coherent &= make_beam_axis(origin.z, inverse.z, 2, beam, width_z);
  return is_coherent && fminf(width_x, fminf(width_y, width_z)) < beam_width_max;
}

/// Where the beam may be inside of a box, before t_max; widened.
__device__ inline bool beam_meets(const Beam& beam, const Vec3& near_planes, const Vec3& far_planes,
                                  float t_max) {
  float near = 0.0f, far = t_max;
  PT_UNROLL(3)
  for (int i = 0; i < 3; ++i) {
    near = fmaxf(near, __fmaf_rn(near_planes[i], beam.near_inverse[i], beam.near_offset[i]));
    far = fminf(far, __fmaf_rn(far_planes[i], beam.far_inverse[i], beam.far_offset[i]));
  }
  return near <= far * (1.0f + slab_tolerance);
}

// The traversal.

/// A leaf that the beam met: where a ray enters and leaves its slabs, relative to Beam::center, and
/// its triangles.
struct alignas(16) BeamLeaf {
  Vec3 near;
  std::uint32_t first;
  Vec3 far;
  std::uint32_t count;
};

/// What a warp needs in shared memory.
struct BeamMemory {
  static constexpr int stack_size = 256;
  static constexpr int leaf_batch = 4;  ///< leaves that are worth turning to

  Beam beam;
  BeamLeaf leaves[leaf_batch + 32];
  std::uint32_t stack[stack_size];
};

/// The rays of a warp, one lane's view. Query: ClosestTriangle or AnyTriangle.
template <class Query>
class BeamTracer {
 public:
  __device__ BeamTracer(const TriangleTree& tree, const Ray& ray, BeamMemory& memory, Query& query)
      : tree_(tree),
        memory_(memory),
        query_(query),
        lane_(threadIdx.x & 31),
        origin_(ray.origin),
        ray_(make_cwbvh_ray(ray)),
        is_traceable_(is_traceable(ray)) {}

  /// By the whole warp. False: the rays are not coherent, or the stack has overflowed; then the
  /// query may hold hits already, but not all.
  __device__ bool run() {
    const bool is_coherent = make_beam(origin_, ray_.inverse, memory_.beam);
    if (!__all_sync(whole_warp, is_coherent && is_traceable_)) return false;
    __syncwarp();
    const float* center = memory_.beam.center;
    offset_ = (Vec3(center[0], center[1], center[2]) - origin_) * ray_.inverse;
    slot_ = (lane_ & 7u) ^ ray_.octant;
    t_max_ = warp_max_magnitude(query_.t_max());
    size_ = 1;
    if (lane_ == 0) memory_.stack[0] = tree_.root;
    while (true) {
      __syncwarp();
      step_down();
      if (size_ > BeamMemory::stack_size - 32) return false;
      if (leaf_count_ < BeamMemory::leaf_batch && size_ > 0) continue;
      __syncwarp();
      for (int first = 0; first < leaf_count_; first += 32) test_leaves(first);
      leaf_count_ = 0;
      t_max_ = warp_max_magnitude(is_done_ ? 0.0f : query_.t_max());
      if (size_ == 0 || __all_sync(whole_warp, is_done_)) return true;
    }
  }

 private:
  static constexpr unsigned whole_warp = 0xffffffffu;

  struct Planes {
    float near, far;
  };

  /// Planes of the lane's child along axis `i`, widened by more than rounding errors.
  __device__ Planes planes(int i, const CwbvhNode* node, float origin, std::uint32_t packed) const {
    constexpr float grid_slack = 1280.0f;  // in units of beam_tolerance
    static_assert(grid_slack * beam_tolerance > 1.05f * cwbvh_grid_tolerance);
    const float step = unpack_cwbvh_step(packed);
    const float outward = memory_.beam.outward[i];
    const float base = origin - memory_.beam.center[i];
    const float size = __fmaf_rn(step, grid_slack, fabsf(base));
    const uchar2 q = __ldg(reinterpret_cast<const uchar2*>(node->planes[i]) + slot_);
    const bool is_negative = outward > 0.0f;
    const auto near = static_cast<float>(is_negative ? q.y : q.x);
    const auto far = static_cast<float>(is_negative ? q.x : q.y);
    return {__fmaf_rn(near, step, __fmaf_rn(size, outward, base)),
            __fmaf_rn(far, step, __fmaf_rn(size, -outward, base))};
  }

  /// Takes up to four nodes from the stack; lane l tests a child of the (l / 8)th.
  __device__ void step_down() {
    const int index = size_ - 1 - static_cast<int>(lane_ >> 3);
    const CwbvhNode* node = &tree_.cwbvh[memory_.stack[max(index, 0)]];
    const uint4 head = __ldg(reinterpret_cast<const uint4*>(node));
    const uint4 more = __ldg(reinterpret_cast<const uint4*>(node) + 1);
    const Planes x = planes(0, node, __uint_as_float(head.x), head.w);
    const Planes y = planes(1, node, __uint_as_float(head.y), more.x);
    const Planes z = planes(2, node, __uint_as_float(head.z), more.y);
    const Vec3 near = {x.near, y.near, z.near}, far = {x.far, y.far, z.far};
    const std::uint32_t bit = 1u << slot_, before = bit - 1u;
    const std::uint32_t leaf_mask = more.x & 0xffu, pair_mask = more.y & 0xffu;
    const bool is_inner = (head.w & bit) != 0, is_used = is_inner || (leaf_mask & bit) != 0;
    const bool is_hit = index >= 0 && is_used && beam_meets(memory_.beam, near, far, t_max_);
    const unsigned below = (1u << lane_) - 1;
    const unsigned inner = __ballot_sync(whole_warp, is_hit && is_inner);
    const unsigned leaves = __ballot_sync(whole_warp, is_hit && !is_inner);
    size_ = max(size_ - 4, 0) + __popc(inner);
    __syncwarp();  // all have read the stack
    if (is_hit && is_inner) {
      memory_.stack[size_ - 1 - __popc(inner & below)] = more.z + __popc(head.w & before);
    }
    if (is_hit && !is_inner) {
      memory_.leaves[leaf_count_ + __popc(leaves & below)] = {
          near, more.w + __popc(leaf_mask & before) + __popc(pair_mask & before), far,
          (pair_mask & bit) != 0 ? 2u : 1u};
    }
    leaf_count_ += __popc(leaves);
  }

  __device__ bool ray_meets(const BeamLeaf& leaf) const {
    const auto at = [&](const Vec3& plane, int i) {
      return __float_as_int(__fmaf_rn(plane[i], ray_.inverse[i], offset_[i]));
    };
    // As integers: their order is that of floats that are not negative.
    const int near = __vimax3_s32(at(leaf.near, 0), at(leaf.near, 1), max(at(leaf.near, 2), 0));
    const int far = __vimin3_s32(at(leaf.far, 0), at(leaf.far, 1),
                                 min(at(leaf.far, 2), __float_as_int(query_.t_max())));
    return __int_as_float(near) <= __int_as_float(far) * (1.0f + slab_tolerance);
  }

  /// Up to 32 leaves: their boxes by all lanes together, then each lane the triangles of its own.
  __device__ void test_leaves(int first) {
    const BeamLeaf* leaf = &memory_.leaves[first];
    const int count = min(leaf_count_ - first, 32);
    std::uint32_t mask = 0;
    for (int i = 0; i < count; ++i)
      if (ray_meets(load_wide(leaf + i))) mask |= 1u << i;
    if (is_done_) mask = 0;
    std::uint32_t triangle = 0, end = 0;
    while (true) {
      if (triangle == end && mask != 0) {
        const int i = __ffs(static_cast<int>(mask)) - 1;
        mask &= mask - 1;
        triangle = leaf[i].first;
        end = triangle + leaf[i].count;
      }
      if (!__any_sync(whole_warp, triangle != end)) return;
      if (triangle != end) {
        const Triangle t = load_wide(&tree_.triangles[triangle]);
        const TriangleHit hit = intersect_triangle(ray_.triangles, t.v0, t.v1, t.v2);
        is_done_ = query_.offer(tree_, hit.t, triangle, 0);
        ++triangle;
        if (is_done_) triangle = end, mask = 0;
      }
    }
  }

  const TriangleTree& tree_;
  BeamMemory& memory_;
  Query& query_;
  unsigned lane_;
  Vec3 origin_;
  CwbvhRay ray_;
  bool is_traceable_;
  Vec3 offset_{};           // (center - origin) * inverse
  std::uint32_t slot_ = 0;  // of the children that this lane tests
  float t_max_ = 0.0f;      // of all rays: the same in all lanes, as are the counts
  int size_ = 0, leaf_count_ = 0;
  bool is_done_ = false;
};

/// Traces the warp's rays as a beam, all lanes together; false: see BeamTracer::run.
template <class Query>
__device__ bool trace_beam(const TriangleTree& tree, const Ray& ray, BeamMemory& memory,
                           Query& query) {
  return BeamTracer<Query>(tree, ray, memory, query).run();
}

}  // namespace pt
