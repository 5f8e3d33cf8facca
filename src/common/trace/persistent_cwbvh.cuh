// Persistent threads on a compressed wide tree: warps that never wait for their slowest ray.
//
// A lane whose ray is finished takes another one as soon as enough lanes of the warp are idle, and
// the warp does one thing at a time: a step down the tree for all lanes that have nodes left, or
// one triangle each for those that found some, whichever serves more lanes. All votes are
// explicit and by the whole warp: since Volta, threads that part do not meet again by themselves.
#pragma once

#include "common/trace/cwbvh_step.cuh"

namespace pt {

/// A stack of groups: the first `shared_depth` entries of each thread lie in shared memory, the
/// rest, seldom needed, in local memory.
template <int shared_depth, int block_size>
class GroupStack {
 public:
  __device__ explicit GroupStack(uint2* shared) : shared_(shared + threadIdx.x) {}

  __device__ bool is_empty() const { return size_ == 0; }

  __device__ void push(const CwbvhGroup& group) {
    if (size_ < shared_depth) {
      shared_[size_ * block_size] = {group.base, group.bits};
    } else {
      local_[size_ - shared_depth] = {group.base, group.bits};
    }
    ++size_;
  }

  __device__ CwbvhGroup top() const {
    const int last = size_ - 1;
    const uint2 top = last < shared_depth ? shared_[last * block_size] : local_[last - shared_depth];
    return {top.x, top.y};
  }

  __device__ void pop() { --size_; }

  __device__ void clear() { size_ = 0; }

 private:
  uint2* shared_;
  uint2 local_[2 * bvh_depth_max - shared_depth];
  int size_ = 0;
};

/// Traces what `work` hands out until there is nothing left. All threads of the block call it.
///
/// Work: a class with
///   bool fetch(bool wanted, Ray&, float& t_min, float& t_max)  by all lanes together; false for a
///                                                               lane that wants a ray and gets none
///   void finish(const Query&)  by lanes whose ray is done
template <class Query, int shared_depth, int block_size, int refill, int postpone, bool hold,
          class Work>
__device__ void trace_persistent(const TriangleTree& tree, Work& work) {
  __shared__ uint2 shared[shared_depth * block_size];
  constexpr unsigned whole_warp = 0xffffffffu;
  GroupStack<shared_depth, block_size> stack(shared);
  Query query(0, 0);
  Vec3 origin, inverse;
  TriangleRay triangle_ray;
  std::uint32_t octant4 = 0;
  CwbvhGroup nodes{0, 0}, triangles{0, 0};
  bool is_active = false, is_dry = false;
  while (true) {
    const unsigned idle = __ballot_sync(whole_warp, !is_active);
    if (idle == whole_warp || (!is_dry && __popc(idle) >= refill)) {
      Ray ray;
      float t_min, t_max;
      const bool fetched = work.fetch(!is_active, ray, t_min, t_max) && !is_active;
      if (fetched) {
        query = Query(t_min, t_max);
        const CwbvhRay prepared = make_cwbvh_ray(ray);
        origin = prepared.origin;
        inverse = prepared.inverse;
        octant4 = prepared.octant * 0x01010101u;
        triangle_ray = prepared.triangles;
        nodes = {tree.root, 0x80000000u};
        triangles = {0, 0};
        if (is_traceable(ray)) {
          is_active = true;
        } else {
          work.finish(query);
        }
      }
      const unsigned active = __ballot_sync(whole_warp, is_active);
      is_dry = work.is_dry();
      if (active == 0) {
        if (is_dry) return;
        continue;
      }
    }
    const bool has_triangles = triangles.bits != 0;
    const bool may_step = is_active && has_children(nodes) && !(hold && has_triangles);
    const int with_triangles = __popc(__ballot_sync(whole_warp, has_triangles));
    const bool steps = __any_sync(whole_warp, may_step);
    if (with_triangles >= postpone || !steps) {
      if (has_triangles) {
        const std::uint32_t slot = take_triangle(triangles);
        const Triangle triangle = load_wide(&tree.triangles[slot]);
        const TriangleHit hit =
            intersect_triangle(triangle_ray, triangle.v0, triangle.v1, triangle.v2);
        if (query.offer(tree, hit.t, slot, 0)) {
          nodes.bits = triangles.bits = 0;
          stack.clear();
        }
      }
    } else if (may_step) {
      if (triangles.bits != 0) stack.push(triangles);
      const std::uint32_t child = take_child(nodes, octant4 & 7u);
      if (has_children(nodes)) stack.push(nodes);
      const CwbvhWords node = load_cwbvh_words(&tree.cwbvh[child]);
      const std::uint32_t hits =
          intersect_cwbvh_words(node, origin, inverse, octant4, query.t_min(), query.t_max());
      nodes = {node.part[1].x, (hits & 0xff000000u) | node.part[0].w >> 24};
      triangles = {node.part[1].y, hits & 0x00ffffffu};
    }
    if (is_active && !has_children(nodes)) {
      if (!stack.is_empty()) {
        const CwbvhGroup top = stack.top();
        const bool is_node = has_children(top);
        if (is_node || triangles.bits == 0) {
          (is_node ? nodes : triangles) = top;
          stack.pop();
        }
      } else if (triangles.bits == 0) {
        work.finish(query);
        is_active = false;
      }
    }
  }
}

}  // namespace pt
