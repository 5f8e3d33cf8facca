#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cmath>

#include "common/accel/traverse_brute.h"
#include "common/accel/traverse_bvh2.h"
#include "common/accel/traverse_cwbvh.h"
#include "common/rays/trace_rays.h"

namespace pt {
namespace {

enum class Structure { brute, bvh2, cwbvh };

template <Structure structure, bool instanced, class Query>
void traverse(const TriangleTree& tree, const Ray& ray, Query& query) {
  if constexpr (structure == Structure::brute) {
    traverse_triangles_brute<instanced>(tree, ray, query);
  } else if constexpr (structure == Structure::bvh2) {
    traverse_triangles_bvh2<instanced>(tree, ray, query);
  } else {
    traverse_cwbvh<instanced>(tree, ray, query);
  }
}

template <Structure structure, bool instanced>
HitRecord trace(const TriangleTree& tree, RayType type, const RayRecord& ray) {
  if (type == RayType::any) {
    AnyTriangle query(ray.t_min, ray.t_max);
    traverse<structure, instanced>(tree, ray.ray(), query);
    return hit_record(tree, query);
  }
  ClosestTriangle query(ray.t_min, ray.t_max);
  traverse<structure, instanced>(tree, ray.ray(), query);
  return hit_record(tree, query);
}

using TraceOne = HitRecord (*)(const TriangleTree&, RayType, const RayRecord&);

TraceOne choose(const TriangleTreeData& tree) {
  const bool instanced = !tree.instances.empty();
  if (!tree.cwbvh.empty())
    return instanced ? trace<Structure::cwbvh, true> : trace<Structure::cwbvh, false>;
  if (!tree.bvh2.empty())
    return instanced ? trace<Structure::bvh2, true> : trace<Structure::bvh2, false>;
  return instanced ? trace<Structure::brute, true> : trace<Structure::brute, false>;
}

}  // namespace

TraceResult trace_rays_cpu(const TriangleTreeData& tree, const RaySet& set, const TraceRuns& runs) {
  const TriangleTree view = tree.view();
  const TraceOne trace_one = choose(tree);
  TraceResult result;
  result.hits.resize(set.rays.size());
  result.threads = tbb::this_task_arena::max_concurrency();
  for (int run = -runs.warmup; run < runs.repeat; ++run) {
    const auto begin = std::chrono::steady_clock::now();
    tbb::parallel_for(std::size_t{0}, set.rays.size(), [&](std::size_t i) {
      result.hits[i] = trace_one(view, set.type, set.rays[i]);
    });
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
    if (run >= 0) result.times_ms.push_back(time.count());
  }
  return result;
}

namespace {

std::string describe(const HitRecord& hit) {
  if (hit.t < 0.0f) return "a miss";
  if (hit.primitive == no_primitive) return "a hit";
  return fmt::format("triangle {} at {}", hit.primitive, hit.t);
}

}  // namespace

float position_resolution(const std::vector<RayRecord>& rays) {
  float largest = 0.0f;
  for (const RayRecord& ray : rays) largest = std::fmax(largest, max_abs(ray.origin));
  return 4.0f * half_ulp * largest;
}

HitComparison compare_hits(const std::vector<HitRecord>& hits,
                           const std::vector<HitRecord>& reference, float resolution) {
  HitComparison result;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const HitRecord &a = hits[i], &b = reference[i];
    const bool hit = !(a.t < 0.0f), expected = !(b.t < 0.0f);
    const bool same_t = std::fabs(a.t - b.t) <= hit_tolerance * std::fabs(b.t) + resolution;
    if (hit == expected && (same_t || !hit)) {
      ++(a.primitive == b.primitive ? result.same : result.ties);
      continue;
    }
    ++(hit && expected ? result.other : hit ? result.invented : result.missed);
    if (result.first.empty())
      result.first = fmt::format("ray {}: {}, expected {}", i, describe(a), describe(b));
  }
  return result;
}

}  // namespace pt
