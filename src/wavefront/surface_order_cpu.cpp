#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "wavefront/surface_order.h"

namespace pt {
namespace {

void order_tile_cpu(const Scene& scene, const SurfaceOrder& order, std::uint32_t begin,
                    std::uint32_t end) {
  std::array<std::uint8_t, order_tile> kinds;
  std::array<std::uint32_t, kind_count> next{};
  for (std::uint32_t i = begin; i < end; ++i) {
    ++next[kinds[i - begin] = surface_kind(scene, order.pool, order.slots[i])];
  }
  std::exclusive_scan(next.begin(), next.end(), next.begin(), begin);
  for (std::uint32_t i = begin; i < end; ++i) {
    order.ordered[next[kinds[i - begin]]++] = order.slots[i];
  }
}

}  // namespace

void order_surfaces_cpu(const Scene& scene, const SurfaceOrder& order) {
  const std::uint32_t count = *order.count;
  tbb::parallel_for(std::uint32_t{0}, (count + order_tile - 1) / order_tile,
                    [&](std::uint32_t tile) {
                      const std::uint32_t begin = tile * order_tile;
                      order_tile_cpu(scene, order, begin, std::min(begin + order_tile, count));
                    });
}

}  // namespace pt
