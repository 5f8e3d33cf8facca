// Traces a set of rays against a tree, and measures how long that takes.
#pragma once

#include <string>
#include <vector>

#include "common/accel/build/build_triangle_tree.h"
#include "common/accel/build/tree_summary.h"
#include "common/accel/build/triangle_tree_data.h"
#include "common/options/options.h"
#include "common/rays/ray_file.h"
#include "common/rays/trace_variant.h"

namespace pt {

struct TraceRuns {
  TraceVariant variant = TraceVariant::automatic;
  int warmup = 0;  ///< runs that are not measured
  int repeat = 1;  ///< >= 1
};

struct TraceResult {
  std::vector<HitRecord> hits;                     ///< by ray
  std::vector<double> times_ms;                    ///< of the measured runs: of kernels on CUDA
  TraceVariant variant = TraceVariant::automatic;  ///< what ran; automatic on the CPU
  int threads = 0;                                 ///< of the CPU; 0 on CUDA
};

/// On all threads of the processor.
TraceResult trace_rays_cpu(const TriangleTreeData& tree, const RaySet& rays, const TraceRuns& runs);

/// On the CUDA device `index`; only in a build with CUDA. Throws Error where it has too little
/// memory, or where the tree is not one that the variant can traverse.
TraceResult trace_rays_cuda(const TriangleTreeData& tree, const RaySet& rays, const TraceRuns& runs,
                            int index);

struct BuiltTrace {
  TraceResult result;
  TreeSummary tree;
};

/// The same with a tree built on the device: `tree` has one of its builders. Throws Error for
/// geometry that is not valid, too.
BuiltTrace build_and_trace_cuda(std::span<const Mesh> meshes, std::span<const Instance> instances,
                                const TreeOptions& tree, const RaySet& rays, const TraceRuns& runs,
                                int index);

}  // namespace pt
