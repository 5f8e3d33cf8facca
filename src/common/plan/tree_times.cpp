#include <algorithm>
#include <cmath>

#include "common/plan/plan_steps.h"

namespace pt {
namespace {

constexpr double million = 1e6;

// A thread's seconds for a million triangles, of which a part is done by one thread alone. What is
// reinserted is at most some 330,000 triangles' worth of nodes; spatial splits are tried by `best`
// where siblings overlap, in about one scene of three.
constexpr double sah_s = 1.0, sah_alone = 0.07;
constexpr double reinsert_s = 0.6, reinsert_alone = 0.2, reinsert_triangles = 0.33e6;
constexpr double splits_s = 3.5, splits_tried = 0.35;
constexpr double host_start_s = 2e-3;

constexpr double host_trace = 1, reinserted_trace = 0.98, best_trace = 0.97;  // of that by `sah`
constexpr double upload_triangle_s = 1e-8;

// A builder on a GPU: kernels that are loaded at their first use, launches for each group's tree,
// and what a triangle takes with the upload of its mesh.
struct DeviceBuilder {
  TreeBuilder builder;
  double start_s, group_s, triangle_s, trace;
};
constexpr DeviceBuilder device_builders[] = {
    {TreeBuilder::hploc, 6e-3, 2.5e-3, 2.5e-9, 1.01},
    {TreeBuilder::hploc_reinsert, 7e-3, 4e-3, 7.5e-9, 0.98}};

constexpr double ray_s_of_thread = 0.9e-6;
constexpr double ray_s_of_device = 0.4e-9, device_multiprocessors = 132;

constexpr double rays_of_path_max = 4;  // before most have left or are absorbed
constexpr double shadow_rays_of_ray = 0.6;

/// What one thread does in `s` seconds, done by several, `alone` of it by one of them.
double shared(double s, double alone, int threads) {
  return s * (alone + (1 - alone) / std::max(threads, 1));
}

double sah_build_s(double triangles, int threads) {
  const double growth = std::log2(std::max(triangles, 2.0)) / std::log2(million);
  return host_start_s + shared(sah_s * triangles / million * growth, sah_alone, threads);
}

double reinsertion_s(double triangles, int threads) {
  const double moved = std::min(triangles, reinsert_triangles);
  return shared(reinsert_s * moved / million, reinsert_alone, threads);
}

}  // namespace

double expected_rays(double pixels, const ImageSettings& image) {
  const double path = std::min(double(image.max_depth), rays_of_path_max);
  return pixels * image.spp * path * (1 + (image.nee ? shadow_rays_of_ray : 0));
}

double expected_cpu_trace_s(double rays, int threads) {
  return rays * ray_s_of_thread / std::max(threads, 1);
}

std::vector<TreeTimes> expected_tree_times(const TreeWork& work, const DeviceProperties& device,
                                           double limit_s) {
  double trace_s = device.is_cuda ? work.rays * ray_s_of_device * device_multiprocessors /
                                        std::max(device.multiprocessors, 1)
                                  : expected_cpu_trace_s(work.rays, device.threads);
  if (limit_s > 0) trace_s = std::min(trace_s, limit_s);
  std::vector<TreeTimes> times;
  const double n = work.triangles;
  if (device.is_cuda) {
    for (const DeviceBuilder& b : device_builders) {
      times.push_back(
          {b.builder, b.start_s + work.groups * b.group_s + n * b.triangle_s, b.trace * trace_s});
    }
  }
  const int threads = device.host_threads;
  const double sah = sah_build_s(n, threads) + (device.is_cuda ? n * upload_triangle_s : 0);
  const double reinserted = sah + reinsertion_s(n, threads);
  const double splits = shared(splits_tried * splits_s * n / million, sah_alone, threads);
  times.push_back({TreeBuilder::sah, sah, host_trace * trace_s});
  times.push_back({TreeBuilder::sah_reinsert, reinserted, reinserted_trace * trace_s});
  times.push_back({TreeBuilder::best, reinserted + splits, best_trace * trace_s});
  return times;
}

}  // namespace pt
