#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_scan.h>

#include <array>

#include "wavefront/compaction.h"

namespace pt {
namespace {

using Range = tbb::blocked_range<std::uint32_t>;
using Counts = std::array<std::uint32_t, 2>;

constexpr std::uint32_t grain = 8192;

Counts count_tags(const CompactionRequest& request, const Range& range) {
  Counts counts{};
  for (std::uint32_t slot = range.begin(); slot < range.end(); ++slot) {
    for (int c = 0; c < 2; ++c) counts[c] += request.tags[slot] == request.wanted[c] ? 1 : 0;
  }
  return counts;
}

Counts sum(const Counts& a, const Counts& b) { return {a[0] + b[0], a[1] + b[1]}; }

// Writes the range's slots to both queues, from the given places on.
void gather(const CompactionRequest& request, const Range& range, Counts place) {
  for (std::uint32_t slot = range.begin(); slot < range.end(); ++slot) {
    for (int c = 0; c < 2; ++c) {
      if (request.tags[slot] == request.wanted[c]) request.queues[c][place[c]++] = slot;
    }
  }
}

}  // namespace

void compact_cpu(Compaction strategy, const CompactionRequest& request) {
  check_request(request);
  const Range all(0, request.slot_count, grain);
  Counts total;
  if (strategy == Compaction::none) {
    total = tbb::parallel_reduce(
        all, Counts{},
        [&](const Range& range, const Counts& before) {
          return sum(before, count_tags(request, range));
        },
        sum);
  } else {
    // A prefix sum over ranges gives each range its place, so the order is kept.
    total = tbb::parallel_scan(
        all, Counts{},
        [&](const Range& range, const Counts& before, bool final) {
          if (final) gather(request, range, before);
          return sum(before, count_tags(request, range));
        },
        sum);
  }
  for (int c = 0; c < 2; ++c) request.counts[c] = total[c];
}

}  // namespace pt
