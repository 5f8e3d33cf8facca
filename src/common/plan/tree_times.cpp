#include <algorithm>
#include <cmath>

#include "common/plan/plan_steps.h"

namespace pt {
namespace {

constexpr double million = 1e6;

/// Times in seconds; `trace` by that with `sah`.
struct DeviceBuilder {
  TreeBuilder builder;
  double start_s, group_s, triangle_s, trace;
};

std::uint64_t bit_of(PlanConstant constant) {
  const auto found = std::ranges::find(plan_constant_table, constant, &PlanConstantInfo::value);
  return std::uint64_t{1} << (found - std::begin(plan_constant_table));
}

/// What one thread does in `s` seconds, done by several, `alone` of it by one of them.
double shared(double s, double alone, int threads) {
  return s * (alone + (1 - alone) / std::max(threads, 1));
}

double sah_build_s(const PlanConstants& c, double triangles, int threads) {
  const double growth = std::log2(std::max(triangles, 2.0)) / std::log2(million);
  return c.host_start_s + shared(c.sah_s * triangles / million * growth, c.sah_alone, threads);
}

double reinsertion_s(const PlanConstants& c, double triangles, int threads) {
  const double moved = std::min(triangles, c.reinsert_triangles);
  return shared(c.reinsert_s * moved / million, c.reinsert_alone, threads);
}

/// Of a tree with spatial splits.
double splits_build_s(const PlanConstants& c, double triangles, int threads) {
  return shared(c.splits_s * triangles / million, c.sah_alone, threads);
}

}  // namespace

void set_measured(PlanConstants& constants, PlanConstant constant, double value) {
  constants.*constant = value;
  constants.measured |= bit_of(constant);
}

bool is_measured(const PlanConstants& constants, PlanConstant constant) {
  return (constants.measured & bit_of(constant)) != 0;
}

std::string origin_of(const PlanConstants& constants, std::initializer_list<PlanConstant> used) {
  const auto count = static_cast<std::size_t>(std::ranges::count_if(
      used, [&](PlanConstant constant) { return is_measured(constants, constant); }));
  if (count == 0) return "from an H200";
  const std::string where =
      constants.measured_on.empty() ? "measured here" : "measured on " + constants.measured_on;
  return (count < used.size() ? "partly " : "") + where;
}

double expected_rays(double pixels, const ImageSettings& image, const PlanConstants& c) {
  const double path = std::min(double(image.max_depth), c.rays_of_path);
  return pixels * image.spp * path * (1 + (image.nee ? c.shadow_rays_of_ray : 0));
}

double expected_cpu_trace_s(double rays, int threads, const PlanConstants& c) {
  return rays * c.ray_s_thread / std::max(threads, 1);
}

std::vector<TreeTimes> expected_tree_times(const TreeWork& work, const DeviceProperties& device,
                                           double limit_s) {
  const PlanConstants& c = device.constants;
  double trace_s = device.is_cuda
                       ? work.rays * c.ray_s_multiprocessor / std::max(device.multiprocessors, 1)
                       : expected_cpu_trace_s(work.rays, device.threads, c);
  if (limit_s > 0) trace_s = std::min(trace_s, limit_s);
  std::vector<TreeTimes> times;
  const double n = work.triangles;
  const DeviceBuilder device_builders[] = {
      {TreeBuilder::hploc, c.hploc_start_s, c.hploc_group_s, c.hploc_triangle_s, c.hploc_trace},
      {TreeBuilder::hploc_reinsert, c.hploc_reinsert_start_s, c.hploc_reinsert_group_s,
       c.hploc_reinsert_triangle_s, c.hploc_reinsert_trace}};
  if (device.is_cuda) {
    for (const DeviceBuilder& b : device_builders) {
      times.push_back(
          {b.builder, b.start_s + work.groups * b.group_s + n * b.triangle_s, b.trace * trace_s});
    }
  }
  const int threads = device.host_threads;
  const double sah = sah_build_s(c, n, threads) + (device.is_cuda ? n * c.upload_triangle_s : 0);
  const double reinserted = sah + reinsertion_s(c, n, threads);
  const double splits = c.splits_tried * splits_build_s(c, n, threads);
  times.push_back({TreeBuilder::sah, sah, trace_s});
  times.push_back({TreeBuilder::sah_reinsert, reinserted, c.reinserted_trace * trace_s});
  times.push_back({TreeBuilder::best, reinserted + splits, c.best_trace * trace_s});
  return times;
}

void fit_builders(PlanConstants& constants, double triangles, int threads,
                  const BuilderSeconds& seconds) {
  // Each is proportional to its constant.
  PlanConstants unit = constants;
  unit.sah_s = unit.reinsert_s = unit.splits_s = 1;
  const double start_s = constants.host_start_s;
  const auto fit = [&](PlanConstant constant, double measured_s, double unit_s) {
    if (measured_s > 0) set_measured(constants, constant, measured_s / unit_s);
  };
  fit(&PlanConstants::sah_s, seconds.sah - start_s,
      sah_build_s(unit, triangles, threads) - start_s);
  fit(&PlanConstants::reinsert_s, seconds.sah_reinsert - seconds.sah,
      reinsertion_s(unit, triangles, threads));
  fit(&PlanConstants::splits_s, seconds.splits, splits_build_s(unit, triangles, threads));
}

}  // namespace pt
