#include "common/accel/build/try_splits.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>

#include "common/accel/build/binary/parallel.h"
#include "common/accel/traverse_triangles.h"
#include "common/sampling/random.h"
#include "common/sampling/warp.h"

namespace pt {
namespace {

constexpr int share_task_depth = 10;  // so far down, the two children are tasks of their own

/// The costs of a subtree, in units of area: a ray's expected visits times the root's area.
struct Costs {
  double visits = 0, overlap = 0;
};

double shared_area(const Bounds& a, const Bounds& b) {
  const Bounds shared{glm::max(a.min, b.min), glm::min(a.max, b.max)};
  const bool is_empty = glm::any(glm::lessThan(shared.max, shared.min));
  return is_empty ? 0.0 : static_cast<double>(shared.half_area());
}

Costs costs_of(const BinaryTree& tree, std::uint32_t subtree, double area, int depth) {
  if (is_leaf(subtree)) return {area, 0};
  const Bvh2Node& node = tree.nodes[subtree];
  const Bounds box[2] = {child_bounds(node, 0), child_bounds(node, 1)};
  double areas[2];
  Costs half[2];
  const auto weigh = [&](int i) {
    areas[i] = static_cast<double>(box[i].half_area());
    half[i] = costs_of(tree, node.child[i], areas[i], depth + 1);
  };
  invoke_both(
      depth < share_task_depth, [&] { weigh(0); }, [&] { weigh(1); });
  const auto visits_per_ray = [&](int i) { return areas[i] > 0 ? half[i].visits / areas[i] : 0.0; };
  const double saved = shared_area(box[0], box[1]) * std::min(visits_per_ray(0), visits_per_ray(1));
  return {area + half[0].visits + half[1].visits, half[0].overlap + half[1].overlap + saved};
}

}  // namespace

double overlap_share(const BinaryTree& tree) {
  const Costs costs = costs_of(tree, tree.root, static_cast<double>(tree.bounds.half_area()), 0);
  return costs.visits > 0 ? costs.overlap / costs.visits : 0.0;
}

namespace {

constexpr double leaf_cost = 1.5;
constexpr std::uint32_t kept = 2;  // of a path: its first ray begins nowhere, as none of a render
constexpr std::uint32_t first_paths = 16;  // before their cost is looked at; then as many again
constexpr float start_offset = 1e-5f;      // of a triangle's largest coordinate, from its surface

Vec3 normal_of(const Triangle& t) { return cross(t.v1 - t.v0, t.v2 - t.v0); }

Vec4 draw(std::uint32_t path, std::uint32_t block) {
  const Uint4 bits = philox4x32_10({path, block, 0, 0}, 0, 0);
  return {to_unit_float(bits.x), to_unit_float(bits.y), to_unit_float(bits.z),
          to_unit_float(bits.w)};
}

TriangleTree view_of(const BuiltNodes& nodes, std::span<const Triangle> triangles) {
  TriangleTree tree;
  nodes.for_each_nodes(tree, [](const auto& all, auto& pointer) { pointer = all.data(); });
  tree.triangles = triangles.data();
  tree.triangle_count = static_cast<std::uint32_t>(triangles.size());
  return tree;
}

Hit closest(const TriangleTree& tree, bool is_wide, const Ray& ray) {
  return is_wide ? closest_triangle<Accel::cwbvh, false>(tree, ray, 0.0f, infinite_distance)
                 : closest_triangle<Accel::bvh2, false>(tree, ray, 0.0f, infinite_distance);
}

/// From `point` of the triangle to the side that `out` points to.
Ray diffuse_ray(const Triangle& triangle, const Vec3& point, const Vec3& out, float u0, float u1) {
  const Vec3 facing = normalize(normal_of(triangle));
  const Vec3 normal = dot(facing, out) < 0.0f ? -facing : facing;
  return {point + start_offset * max_abs(point) * normal, sample_cosine_hemisphere(normal, u0, u1)};
}

/// Visits of one ray; the nodes are those of either structure.
struct Visits {
  const BuiltNodes& nodes;
  const TrialRay& trial;
  double nodes_entered = 0, leaves_entered = 0;

  void visit_wide(const CwbvhRay& ray, std::uint32_t index) {
    ++nodes_entered;
    const CwbvhNode& node = nodes.cwbvh[index];
    const std::uint32_t hits = intersect_cwbvh_node(node, ray, 0.0f, trial.t);
    for_each_cwbvh_child(node, [&](int slot, const CwbvhChild& child) {
      if ((hits >> slot & 1u) == 0) return;
      if (child.count > 0) {
        ++leaves_entered;
      } else {
        visit_wide(ray, child.index);
      }
    });
  }

  void visit_binary(const SlabTestRay& ray, std::uint32_t index) {
    if (is_leaf(index)) {
      ++leaves_entered;
      return;
    }
    ++nodes_entered;
    const Bvh2Step step = step_bvh2(nodes.bvh2[index], ray, 0.0f, trial.t);
    if (step.children > 0) visit_binary(ray, step.first);
    if (step.children > 1) visit_binary(ray, step.second);
  }

  double cost() {
    if (!nodes.cwbvh.empty()) visit_wide(make_cwbvh_ray(trial.ray), 0);
    if (!nodes.bvh2.empty()) visit_binary(make_slab_test_ray(trial.ray), 0);
    return nodes_entered + leaf_cost * leaves_entered;
  }
};

struct TrialPath {
  TrialRay rays[kept] = {{{}, -1}, {{}, -1}};
  double cost = 0;  // of all three
};

}  // namespace

std::vector<TrialRay> trial_rays(const BuiltNodes& nodes, std::span<const Triangle> triangles,
                                 const Bounds& bounds, std::uint32_t paths, double cost_max) {
  const TriangleTree tree = view_of(nodes, triangles);
  const bool is_wide = !nodes.cwbvh.empty();
  const auto follow = [&](std::uint32_t path) {
    TrialPath result;
    const Vec4 u = draw(path, 0), v = draw(path, 1);
    const Vec3 place(u.x, u.y, u.z);
    Ray ray = {bounds.min + place * (bounds.max - bounds.min), sample_unit_sphere(v.x, v.y)};
    Hit hit = closest(tree, is_wide, ray);
    result.cost += Visits{nodes, {ray, hit.t}}.cost();
    for (std::uint32_t k = 0; k < kept && !hit.is_miss(); ++k) {
      const Vec4 w = draw(path, 2 + k);
      ray = diffuse_ray(triangles[hit.primitive], ray.origin + hit.t * ray.direction,
                        -ray.direction, w.x, w.y);
      hit = closest(tree, is_wide, ray);
      result.cost += Visits{nodes, {ray, hit.t}}.cost();
      result.rays[k] = {ray, hit.t};
    }
    return result;
  };
  std::vector<TrialRay> rays;
  double cost = 0;
  for (std::uint32_t first = 0, end = std::min(first_paths, paths);
       first < paths && cost < cost_max; first = end, end = std::min(2 * end, paths)) {
    std::vector<TrialPath> more(end - first);
    tbb::parallel_for(first, end, [&](std::uint32_t i) { more[i - first] = follow(i); });
    for (const TrialPath& path : more) {
      cost += path.cost;
      for (const TrialRay& ray : path.rays)
        if (ray.t >= 0 && is_traceable(ray.ray)) rays.push_back(ray);
    }
  }
  return rays;
}

double trial_cost(const BuiltNodes& nodes, std::span<const TrialRay> rays) {
  const double sum = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, rays.size(), 64), 0.0,
      [&](const auto& range, double part) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
          part += Visits{nodes, rays[i]}.cost();
        return part;
      },
      std::plus<>());
  return rays.empty() ? 0.0 : sum / static_cast<double>(rays.size());
}

}  // namespace pt
