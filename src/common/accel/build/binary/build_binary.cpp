#include "common/accel/build/binary/build_binary.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <bit>
#include <cstring>

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/binary/build_reference.h"
#include "common/accel/build/binary/parallel.h"
#include "common/accel/build/binary/split.h"

namespace pt {
namespace {

/// Child `i` is the subtree of `range`: the node `index`, or a leaf where there is one reference.
void set_child(Bvh2Node& node, int i, const ReferenceRange& range, std::uint32_t index) {
  set_child_bounds(node, i, range.bounds.bounds());
  node.child[i] = range.size() == 1 ? make_leaf(range.begin, 1) : index;
  node.padding[i] = 0;
}

constexpr std::uint32_t task_min = 1024;  // references of a subtree that is worth a task

class SahBuilder {
 public:
  explicit SahBuilder(std::span<BuildReference> references)
      : references_(references), nodes_(new Bvh2Node[references.size()]) {}

  std::unique_ptr<Bvh2Node[]> build(const ReferenceRange& all) {
    if (all.size() > 1) build_node(all, 0, 0);
    return std::move(nodes_);
  }

 private:
  // A subtree of n references has n - 1 nodes, so each node's index is known beforehand and threads
  // need not agree on anything.
  void build_node(const ReferenceRange& range, std::uint32_t index, int depth) {
    const RangeHalves halves = split(range, depth);
    const ReferenceRange& left = halves.left;
    const ReferenceRange& right = halves.right;
    const std::uint32_t children[2] = {index + 1, index + left.size()};
    Bvh2Node& node = nodes_[index];
    set_child(node, 0, left, children[0]);
    set_child(node, 1, right, children[1]);
    const auto build_left = [&] {
      if (left.size() > 1) build_node(left, children[0], depth + 1);
    };
    const auto build_right = [&] {
      if (right.size() > 1) build_node(right, children[1], depth + 1);
    };
    invoke_both(range.size() >= task_min, build_left, build_right);
  }

  RangeHalves split(const ReferenceRange& range, int depth) const {
    if (range.size() == 2) return split_in_halves(references_, range);
    const ObjectSplit best = find_object_split(references_, range);
    if (best.cost == HUGE_VALF) return split_in_halves(references_, range);
    const RangeHalves halves = partition_references(references_, range, best);
    const std::uint32_t larger = std::max(halves.left.size(), halves.right.size());
    const bool too_deep = depth + 1 + std::bit_width(larger - 1) > bvh_depth_max;
    return too_deep ? split_in_halves(references_, range) : halves;
  }

  std::span<BuildReference> references_;
  std::unique_ptr<Bvh2Node[]> nodes_;
};

}  // namespace

BinaryTree build_sah(std::uint32_t count, const BoundsOf& bounds_of) {
  const std::unique_ptr<BuildReference[]> memory(new BuildReference[count]);
  const std::span<BuildReference> references(memory.get(), count);
  ReferenceRange all = tbb::parallel_reduce(
      tbb::blocked_range<std::uint32_t>(0, count, 1 << 13), ReferenceRange(),
      [&](const auto& part, ReferenceRange sum) {
        for (std::uint32_t i = part.begin(); i < part.end(); ++i) {
          references[i] = make_reference(bounds_of(i), i);
          sum.grow(references[i]);
        }
        return sum;
      },
      [](ReferenceRange a, const ReferenceRange& b) { return a.grow(b), a; });
  all.end = count;
  BinaryTree tree;
  tree.bounds = all.bounds.bounds();
  tree.root = count == 1 ? make_leaf(0, 1) : 0;
  tree.node_capacity = count;
  tree.nodes = SahBuilder(references).build(all);
  tree.order.resize(count);
  tbb::parallel_for(0u, count, [&](std::uint32_t i) { tree.order[i] = references[i].id(); });
  return tree;
}

namespace {

constexpr std::uint32_t sbvh_task_min = 512;  // references of a subtree that is worth a task
constexpr float least_gain = 0.99f;           // of a spatial split's cost to an object split's

/// A subtree's references, and the room that it has for them and for more.
struct Segment {
  ReferenceRange range;
  std::uint32_t limit;

  std::uint32_t room() const { return limit - range.end; }
};

class SbvhBuilder {
 public:
  SbvhBuilder(std::span<BuildReference> references, const TriangleOf& triangle_of,
              float least_overlap)
      : references_(references),
        triangle_of_(triangle_of),
        least_overlap_(least_overlap),
        nodes_(new Bvh2Node[references.size()]) {}

  std::unique_ptr<Bvh2Node[]> build(const Segment& all) {
    if (all.range.size() > 1) build_node(all, 0, 0);
    return std::move(nodes_);
  }

 private:
  // A subtree has fewer nodes than room for references, so each node's index is known beforehand;
  // what is not used remains a gap.
  void build_node(const Segment& segment, std::uint32_t index, int depth) {
    const auto [left, right] = divide(segment, split(segment, depth));
    const std::uint32_t children[2] = {index + 1, index + left.limit - left.range.begin};
    Bvh2Node& node = nodes_[index];
    set_child(node, 0, left.range, children[0]);
    set_child(node, 1, right.range, children[1]);
    const auto build_left = [&, segment_left = left] {
      if (segment_left.range.size() > 1) build_node(segment_left, children[0], depth + 1);
    };
    const auto build_right = [&, segment_right = right] {
      if (segment_right.range.size() > 1) build_node(segment_right, children[1], depth + 1);
    };
    invoke_both(segment.range.size() >= sbvh_task_min, build_left, build_right);
  }

  // Shares the room out by the numbers of references.
  std::pair<Segment, Segment> divide(const Segment& segment, RangeHalves halves) const {
    ReferenceRange& right = halves.right;
    const std::uint64_t room = segment.limit - right.end;
    const std::uint64_t all = halves.left.size() + right.size();
    const auto left_room = static_cast<std::uint32_t>(room * halves.left.size() / all);
    BuildReference* const first = &references_[right.begin];
    std::memmove(static_cast<void*>(first + left_room), first,
                 right.size() * sizeof(BuildReference));
    right.begin += left_room, right.end += left_room;
    return {{halves.left, right.begin}, {right, segment.limit}};
  }

  RangeHalves split(const Segment& segment, int depth) const {
    const RangeHalves halves = cheapest_split(segment);
    const std::uint32_t larger = std::max(halves.left.size(), halves.right.size());
    const bool is_none = halves.left.size() == 0 || halves.right.size() == 0;
    if (!is_none && depth + 1 + std::bit_width(larger - 1) <= bvh_depth_max) return halves;
    return split_in_halves(references_,
                           measured_range(references_, segment.range.begin, halves.right.end));
  }

  RangeHalves cheapest_split(const Segment& segment) const {
    const ReferenceRange& range = segment.range;
    const ObjectSplit object = find_object_split(references_, range);
    if (segment.room() > 0 && may_gain(range, object)) {
      const SpatialSplit spatial = find_spatial_split(references_, range, triangle_of_);
      if (spatial.cost < least_gain * object.cost &&
          count_cut(references_, range, spatial) <= segment.room()) {
        return split_spatially(references_, range, spatial, triangle_of_);
      }
    }
    if (object.cost < HUGE_VALF) return partition_references(references_, range, object);
    return split_in_halves(references_, range);
  }

  // The overlap of an object split's halves bounds the gain of a spatial split.
  bool may_gain(const ReferenceRange& range, const ObjectSplit& object) const {
    if (!(object.cost < HUGE_VALF)) return true;
    const Box4 shared{max4(object.left_bounds.low, object.right_bounds.low),
                      min4(object.left_bounds.high, object.right_bounds.high)};
    const Float4 size = shared.high - shared.low;
    if (size[0] < 0 || size[1] < 0 || size[2] < 0) return false;
    const float area = shared.half_area();
    return area > least_overlap_ &&
           area * static_cast<float>(range.size()) > (1.0f - least_gain) * object.cost;
  }

  std::span<BuildReference> references_;
  const TriangleOf& triangle_of_;
  float least_overlap_;
  std::unique_ptr<Bvh2Node[]> nodes_;
};

}  // namespace

BinaryTree build_sbvh(std::uint32_t count, const TriangleOf& triangle_of,
                      const SbvhOptions& options) {
  const auto more = static_cast<std::uint64_t>(static_cast<double>(count) * options.duplicates);
  const auto capacity = static_cast<std::uint32_t>(
      std::min<std::uint64_t>(count + more, std::max(count, build_primitives_max)));
  const std::unique_ptr<BuildReference[]> memory(new BuildReference[capacity]);
  const std::span<BuildReference> references(memory.get(), capacity);
  tbb::parallel_for(0u, count, [&](std::uint32_t i) {
    const Triangle t = triangle_of(i);
    references[i] = make_reference(hit_bounds(t.v0, t.v1, t.v2), i);
  });
  tbb::parallel_for(count, capacity, [&](std::uint32_t i) { references[i] = BuildReference(); });
  const ReferenceRange all = measured_range(references, 0, count);
  BinaryTree tree;
  tree.bounds = all.bounds.bounds();
  tree.root = count == 1 ? make_leaf(0, 1) : 0;
  tree.node_capacity = capacity;
  tree.nodes = SbvhBuilder(references, triangle_of, options.alpha * tree.bounds.half_area())
                   .build({all, capacity});
  tree.order.resize(capacity);
  tbb::parallel_for(0u, capacity, [&](std::uint32_t i) { tree.order[i] = references[i].id(); });
  return tree;
}

}  // namespace pt
