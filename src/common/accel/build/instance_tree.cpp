#include "common/accel/build/instance_tree.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/accel/build/binary/build_binary.h"
#include "common/accel/build/build_nodes.h"
#include "common/error/error.h"

namespace pt {

namespace {

// A leaf is one instance: entering it costs much more than a box test.
constexpr TreeCosts instance_costs = {1.0f, 10.0f, 1};

/// An affine map in double precision.
struct DoubleAffine {
  glm::dmat3 linear;  // columns
  glm::dvec3 translation;
};

DoubleAffine to_double(const Affine& a) {
  DoubleAffine result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result.linear[j][i] = a.row[i][j];
    result.translation[i] = a.row[i].w;
  }
  return result;
}

glm::dmat3 absolute(const glm::dmat3& m) {
  return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])};
}

/// The world's box of what lies in `box` in object space. It is that of the rounded map by which
/// traversal takes rays to object space, widened by the rounding of rays from nearby.
Bounds world_bounds(const Bounds& box, const Affine& to_object) {
  const DoubleAffine object = to_double(to_object);
  const glm::dmat3 linear = glm::inverse(object.linear);
  glm::dvec3 low(HUGE_VAL), high(-HUGE_VAL);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p((corner & 1) != 0 ? box.max.x : box.min.x,
                       (corner & 2) != 0 ? box.max.y : box.min.y,
                       (corner & 4) != 0 ? box.max.z : box.min.z);
    const glm::dvec3 world = linear * (p - object.translation);
    low = glm::min(low, world), high = glm::max(high, world);
  }
  const glm::dvec3 size = glm::max(glm::abs(low), glm::abs(high));
  const glm::dvec3 in_object = absolute(object.linear) * size + glm::abs(object.translation);
  const glm::dvec3 margin = 8.0 * half_ulp * (absolute(linear) * in_object + size);
  return {Vec3(low - margin), Vec3(high + margin)};
}

InstanceRecord make_record(const GroupTree& group, const Affine& to_object, std::size_t index,
                           const MotionTracks& motion) {
  const MotionTrack track = motion.moves(index) ? motion.instances[index] : MotionTrack();
  const Bounds bounds = track.moves() ? moving_bounds(group.bounds, motion, track)
                                      : world_bounds(group.bounds, to_object);
  return {
      to_object, group.root, static_cast<std::uint32_t>(index), group.first_slot, group.slot_count,
      bounds,    track};
}

const GroupTree* find_group(std::span<const GroupTree> groups, std::uint32_t index) {
  const auto found = std::lower_bound(
      groups.begin(), groups.end(), index,
      [](const GroupTree& group, std::uint32_t wanted) { return group.group < wanted; });
  return found == groups.end() || found->group != index ? nullptr : &*found;
}

std::vector<InstanceRecord> place_instances(std::span<const GroupTree> groups,
                                            std::span<const Instance> instances,
                                            const MotionTracks& motion) {
  std::vector<InstanceRecord> records;
  const auto add = [&](const GroupTree* group, const Affine& to_object, std::size_t index) {
    if (group != nullptr) records.push_back(make_record(*group, to_object, index, motion));
  };
  for (std::size_t i = 0; i < instances.size(); ++i) {
    add(find_group(groups, instances[i].group), inverse(instances[i].to_world), i);
  }
  add(find_group(groups, 0), Affine(), instances.size());
  return records;
}

}  // namespace

Bounds moving_bounds(const Bounds& box, const MotionTracks& motion, const MotionTrack& track) {
  Bounds world;
  const double deviation = sample_poses(motion.segments, track, [&](const Affine& to_world) {
    world.grow(world_bounds(box, inverse(to_world)));
  });
  const glm::dvec3 low(box.min), high(box.max);
  const double farthest = glm::length(glm::max(glm::abs(low), glm::abs(high)));
  // Poses between them are rounded, too: a few units of all that is added to a point.
  const float size = std::max(max_abs(world.min), max_abs(world.max));
  const float margin = static_cast<float>(1.001 * deviation * farthest) + 32.0f * half_ulp * size;
  return {world.min - Vec3(margin), world.max + Vec3(margin)};
}

void check_instances(std::span<const Instance> instances) {
  for (std::size_t i = 0; i < instances.size(); ++i) {
    if (instances[i].group == 0) {
      throw Error(fmt::format("instance {}: of group 0, expected a group above", i));
    }
    const Affine to_object = inverse(instances[i].to_world);
    for (const Vec4& row : to_object.row) {
      const float sum = std::abs(row.x) + std::abs(row.y) + std::abs(row.z) + std::abs(row.w);
      if (!(sum < 1e15f)) {
        throw Error(fmt::format("instance {}: expected a transform that can be inverted", i));
      }
    }
  }
}

std::vector<std::uint32_t> groups_in_use(std::span<const Instance> instances) {
  std::vector<std::uint32_t> groups = {0};
  for (const Instance& instance : instances) groups.push_back(instance.group);
  std::sort(groups.begin(), groups.end());
  groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
  return groups;
}

InstanceTree build_instance_tree(std::span<const GroupTree> groups,
                                 std::span<const Instance> instances, AccelKind accel,
                                 std::uint32_t first_node, const MotionTracks& motion) {
  std::vector<InstanceRecord> records = place_instances(groups, instances, motion);
  InstanceTree tree;
  if (records.empty() || !has_nodes(accel)) {
    tree.instances = std::move(records);
    return tree;
  }
  BinaryTree binary = build_sah(static_cast<std::uint32_t>(records.size()),
                                [&](std::uint32_t i) { return records[i].bounds; });
  BuiltNodes built = build_nodes(std::move(binary), accel, instance_costs);
  move_references(built, first_node, 0);
  tree.for_each_nodes(built, [](auto& to, auto& nodes) { to = std::move(nodes); });
  for (const std::uint32_t i : built.order) tree.instances.push_back(records[i]);
  return tree;
}

void add_instance_tree(TriangleTreeData& tree, std::span<const Instance> instances, AccelKind accel,
                       const MotionTracks& motion) {
  tree.first_top_node = 0;
  tree.for_each_nodes(
      [&](const auto& nodes) { tree.first_top_node += static_cast<std::uint32_t>(nodes.size()); });
  InstanceTree top =
      build_instance_tree(tree.groups, instances, accel, tree.first_top_node, motion);
  tree.for_each_nodes(top, [&](auto& all, const auto& nodes) {
    all.insert(all.end(), nodes.begin(), nodes.end());
    if (!nodes.empty()) tree.root = tree.first_top_node;
  });
  tree.instances = std::move(top.instances);
}

void rebuild_instance_tree(TriangleTreeData& tree, std::span<const Instance> instances,
                           const MotionTracks& motion) {
  check_instances(instances);
  if (tree.instances.empty()) return;
  AccelKind accel = AccelKind::brute;
  if (!tree.bvh2.empty()) accel = AccelKind::bvh2, tree.bvh2.resize(tree.first_top_node);
  if (!tree.cwbvh.empty()) accel = AccelKind::cwbvh, tree.cwbvh.resize(tree.first_top_node);
  add_instance_tree(tree, instances, accel, motion);
}

}  // namespace pt
