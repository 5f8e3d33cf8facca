// The paths before the Markov chains, each with its target: where chains begin
// (docs/design/metropolis.md).
#pragma once

#include "common/sampling/chains.h"

namespace pt {

/// The sum of the targets of some paths.
struct TargetSum {
  double sum = 0;
  double squares = 0;
};

/// The targets of all bootstrap paths, in a device's memory. Groups of them are summed one target
/// after the other, so that sums do not depend on the threads.
struct Bootstrap {
  static constexpr std::uint32_t group_paths = 256;
  static constexpr std::uint64_t bytes_per_group =
      group_paths * sizeof(float) + sizeof(TargetSum) + sizeof(double);

  float* targets = nullptr;     ///< [path]
  TargetSum* groups = nullptr;  ///< [group]
  double* below = nullptr;      ///< [group]: the sum of the targets of all groups before it

  static constexpr std::uint64_t group_count(std::uint64_t paths) {
    return (paths + group_paths - 1) / group_paths;
  }

  /// make(pointer's type, count) for each.
  template <class Make>
  void for_each_array(std::uint64_t paths, Make&& make) {
    make(targets, paths);
    make(groups, group_count(paths));
    make(below, group_count(paths));
  }
};

/// The proposal by which a bootstrap path is traced, and traced again where a chain begins.
PT_HD Proposal bootstrap_path(std::uint32_t path) { return {path, bootstrap_iteration, 0, 1}; }

/// Sums one group of the first `paths` targets.
PT_HD TargetSum sum_group(const Bootstrap& bootstrap, std::uint32_t group, std::uint32_t paths) {
  TargetSum result;
  const std::uint32_t first = group * Bootstrap::group_paths;
  for (std::uint32_t i = 0; i < Bootstrap::group_paths && first + i < paths; ++i) {
    const double target = bootstrap.targets[first + i];
    result.sum += target;
    result.squares += target * target;
  }
  return result;
}

/// Where chains begin: on the sum of the first `paths` targets, at equal distances from a position
/// of its first part (systematic resampling; Kitagawa 1996).
struct ChainPositions {
  std::uint32_t paths = 1;
  std::uint32_t chains = 1;
  double sum = 0;
  double u = 0;  ///< in [0, 1)

  PT_HD double of_chain(std::uint32_t chain) const {
    const double share = (static_cast<double>(chain) + u) / static_cast<double>(chains);
    return fmin(share, 1.0 - 0x1p-53) * sum;
  }
};

/// The path with light at which the sum of the targets exceeds the chain's position.
PT_HD std::uint32_t start_of(const Bootstrap& bootstrap, const ChainPositions& positions,
                             std::uint32_t chain) {
  const double position = positions.of_chain(chain);
  std::uint32_t group = 0;
  std::uint32_t end = static_cast<std::uint32_t>(Bootstrap::group_count(positions.paths));
  while (end - group > 1) {
    const std::uint32_t middle = group + (end - group) / 2;
    (bootstrap.below[middle] <= position ? group : end) = middle;
  }
  double sum = bootstrap.below[group];
  std::uint32_t path = group * Bootstrap::group_paths;
  const std::uint32_t last = path + Bootstrap::group_paths;
  std::uint32_t found = path;
  // The sum's last bits are those of another order: the group's last path with light ends it.
  for (; path < last && path < positions.paths && sum <= position; ++path) {
    if (bootstrap.targets[path] > 0.0f) found = path;
    sum += bootstrap.targets[path];
  }
  return found;
}

}  // namespace pt
