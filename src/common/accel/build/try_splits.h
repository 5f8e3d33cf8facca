// Rays that are traced through trees over the same triangles to tell which is the best: what the
// surface area heuristic expects holds for rays that begin outside and meet nothing.
#pragma once

#include <span>
#include <vector>

#include "common/accel/build/build_nodes.h"

namespace pt {

/// A ray and the distance of its hit, or infinity.
struct TrialRay {
  Ray ray;
  float t;
};

/// Rays among the triangles, the same in each call: the second and third ones of `paths` diffuse
/// paths that begin anywhere in `bounds`, as far as these meet anything. `nodes` is a tree over the
/// triangles, which are given by slot; the root comes first.
std::vector<TrialRay> trial_rays(const BuiltNodes& nodes, std::span<const Triangle> triangles,
                                 const Bounds& bounds, std::uint32_t paths);

/// What a ray costs on average, in units of one node's visit: all nodes and leaves whose boxes it
/// enters before its hit, which any order of traversal visits. A leaf counts 1.5: with that the
/// cost explains the rates of the GPU's tracer within 2 % (results/log/2026-11-tree-builders.md).
/// The root comes first.
double trial_cost(const BuiltNodes& nodes, std::span<const TrialRay> rays);

}  // namespace pt
