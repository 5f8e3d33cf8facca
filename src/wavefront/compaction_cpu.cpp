#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_scan.h>

#include <array>
#include <atomic>

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

// Writes the range's slots to both queues, from the given places on.
void append(const CompactionRequest& request, const Range& range, Counts place) {
  for (std::uint32_t slot = range.begin(); slot < range.end(); ++slot) {
    for (int c = 0; c < 2; ++c) {
      if (request.tags[slot] == request.wanted[c]) request.queues[c][place[c]++] = slot;
    }
  }
}

// A parallel prefix sum over ranges gives each range its place: the order is kept.
void compact_in_order(const CompactionRequest& request) {
  const auto sum = [](const Counts& a, const Counts& b) { return Counts{a[0] + b[0], a[1] + b[1]}; };
  const Counts total = tbb::parallel_scan(
      Range(0, request.slot_count, grain), Counts{},
      [&](const Range& range, const Counts& before, bool final) {
        if (final) append(request, range, before);
        return sum(before, count_tags(request, range));
      },
      sum);
  for (int c = 0; c < 2; ++c) request.counts[c] = total[c];
}

// Each range reserves its places with one atomic addition per queue: the order is that of arrival.
void compact_by_arrival(const CompactionRequest& request, bool write) {
  std::array<std::atomic<std::uint32_t>, 2> next{};
  tbb::parallel_for(Range(0, request.slot_count, grain), [&](const Range& range) {
    const Counts counts = count_tags(request, range);
    Counts place;
    for (int c = 0; c < 2; ++c) place[c] = next[c].fetch_add(counts[c], std::memory_order_relaxed);
    if (write) append(request, range, place);
  });
  for (int c = 0; c < 2; ++c) request.counts[c] = next[c].load();
}

}  // namespace

void compact_cpu(Compaction strategy, const CompactionRequest& request) {
  check_request(request);
  if (strategy == Compaction::cub) {
    compact_in_order(request);
  } else {
    compact_by_arrival(request, strategy == Compaction::atomic);
  }
}

}  // namespace pt
