// Traces a set of rays against a tree, measures how long that takes, and compares the hits.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/accel/build/build_triangle_tree.h"
#include "common/accel/build/tree_statistics.h"
#include "common/accel/build/triangle_tree_data.h"
#include "common/accel/ray_record.h"
#include "common/options/options.h"
#include "common/rays/ray_file.h"

namespace pt {

/// How a CUDA device traces an array of rays.
enum class TraceVariant {
  automatic,   ///< beam for rays that are coherent and no instances, else persistent;
               ///< threads for other trees
  threads,     ///< a thread for every ray
  persistent,  ///< warps that take new rays when lanes are idle
  beam,        ///< 32 coherent rays together; incoherent ones singly
};

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

/// On `sms` multiprocessors (0: all) of the CUDA device `index`; only in a build with CUDA. Throws
/// Error where it has too little memory, or where the tree is not one that the variant can
/// traverse.
TraceResult trace_rays_cuda(const TriangleTreeData& tree, const RaySet& rays, const TraceRuns& runs,
                            int index, int sms = 0);

struct BuiltTrace {
  TraceResult result;
  TreeSummary tree;
};

/// As trace_rays_cuda(), with a tree built on the device: `tree` has one of its builders. Throws
/// Error also for invalid geometry.
BuiltTrace build_and_trace_cuda(std::span<const Mesh> meshes, std::span<const Instance> instances,
                                const TreeOptions& tree, const RaySet& rays, const TraceRuns& runs,
                                int index, int sms = 0);

inline constexpr float hit_tolerance = 1e-5f;  ///< of t, relative

/// How hits agree with reference hits.
struct HitComparison {
  std::uint64_t same = 0;   ///< t within the tolerance and the same triangle
  std::uint64_t ties = 0;   ///< t within the tolerance, another triangle: an edge, or coincident
  std::uint64_t other = 0;  ///< both hit, t differs
  std::uint64_t missed = 0, invented = 0;  ///< only the reference hits, or only the hits do
  std::string first;  ///< what the first of the last three kinds is, in words; empty: there is none

  bool agrees() const { return other + missed + invented == 0; }
};

/// `hits` and `reference` are of the same rays. Distances may also differ by `resolution`, the
/// precision of positions as floats.
HitComparison compare_hits(const std::vector<HitRecord>& hits,
                           const std::vector<HitRecord>& reference, float resolution = 0.0f);

/// Two ulps of the rays' largest coordinate.
float position_resolution(const std::vector<RayRecord>& rays);

}  // namespace pt
