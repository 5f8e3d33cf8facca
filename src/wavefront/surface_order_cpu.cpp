#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_scan.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "wavefront/surface_order.h"

namespace pt {
namespace {

using Range = tbb::blocked_range<std::uint32_t>;
using Counts = std::array<std::uint32_t, kind_count>;

constexpr std::uint32_t grain = 4096;

Counts sum(Counts a, const Counts& b) {
  for (std::size_t k = 0; k < a.size(); ++k) a[k] += b[k];
  return a;
}

Counts count_kinds(const SurfaceOrder& order, const Range& range) {
  Counts counts{};
  for (std::uint32_t i = range.begin(); i < range.end(); ++i) ++counts[order.kinds[i]];
  return counts;
}

void order_tile_cpu(const Scene& scene, const SurfaceOrder& order, std::uint32_t begin,
                    std::uint32_t end) {
  std::array<std::uint8_t, order_tile> kinds;
  Counts next{};
  for (std::uint32_t i = begin; i < end; ++i) {
    ++next[kinds[i - begin] = surface_kind(scene, order.pool, order.slots[i])];
  }
  std::exclusive_scan(next.begin(), next.end(), next.begin(), begin);
  for (std::uint32_t i = begin; i < end; ++i) {
    order.ordered[next[kinds[i - begin]]++] = order.slots[i];
  }
}

void order_in_tiles(const Scene& scene, const SurfaceOrder& order) {
  const std::uint32_t count = *order.count;
  tbb::parallel_for(std::uint32_t{0}, (count + order_tile - 1) / order_tile,
                    [&](std::uint32_t tile) {
                      const std::uint32_t begin = tile * order_tile;
                      order_tile_cpu(scene, order, begin, std::min(begin + order_tile, count));
                    });
}

void order_in_ranges(const Scene& scene, const SurfaceOrder& order) {
  const Range all(0, *order.count, grain);
  const Counts counts = tbb::parallel_reduce(
      all, Counts{},
      [&](const Range& range, const Counts& before) {
        for (std::uint32_t i = range.begin(); i < range.end(); ++i) {
          order.kinds[i] = surface_kind(scene, order.pool, order.slots[i]);
        }
        return sum(before, count_kinds(order, range));
      },
      sum);
  std::uint32_t first = 0;
  for (int k = 0; k < kind_count; ++k) {
    order.ranges->count[k] = counts[k];
    order.ranges->first[k] = first;
    first += counts[k];
  }
  // A prefix sum over ranges gives each range its offsets, so the order within a kind is kept.
  tbb::parallel_scan(
      all, Counts{},
      [&](const Range& range, Counts before, bool final) {
        if (final) {
          Counts index = before;
          for (std::uint32_t i = range.begin(); i < range.end(); ++i) {
            const std::uint8_t kind = order.kinds[i];
            order.ordered[order.ranges->first[kind] + index[kind]++] = order.slots[i];
          }
        }
        return sum(before, count_kinds(order, range));
      },
      sum);
}

}  // namespace

void order_surfaces_cpu(const Scene& scene, const SurfaceOrder& order) {
  order.ranges == nullptr ? order_in_tiles(scene, order) : order_in_ranges(scene, order);
}

}  // namespace pt
