#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_scan.h>

#include <array>
#include <set>

#include "common/error/error.h"
#include "wavefront/compaction/compaction.h"

namespace pt {
namespace {

using Range = tbb::blocked_range<std::uint32_t>;
using Counts = std::array<std::uint32_t, CompactionRequest::queues_max>;

constexpr std::uint32_t grain = 8192;

Counts count_tags(const CompactionRequest& request, const Range& range) {
  Counts counts{};
  for (std::uint32_t slot = range.begin(); slot < range.end(); ++slot) {
    for (int c = 0; c < request.queues_wanted; ++c) {
      counts[c] += request.tags[slot] == request.wanted[c] ? 1 : 0;
    }
  }
  return counts;
}

Counts sum(Counts a, const Counts& b) {
  for (std::size_t c = 0; c < a.size(); ++c) a[c] += b[c];
  return a;
}

// Writes the range's slots to their queues, from the given indices on.
void gather(const CompactionRequest& request, const Range& range, Counts index) {
  for (std::uint32_t slot = range.begin(); slot < range.end(); ++slot) {
    for (int c = 0; c < request.queues_wanted; ++c) {
      if (request.tags[slot] == request.wanted[c]) request.queues[c][index[c]++] = slot;
    }
  }
}

}  // namespace

void check_request(const CompactionRequest& request) {
  if (request.queues_wanted < 1 || request.queues_wanted > CompactionRequest::queues_max) {
    throw Error(fmt::format("compaction: {} queues wanted; expected 1 to {}", request.queues_wanted,
                            CompactionRequest::queues_max));
  }
  if (request.capacity < request.slot_count) {
    throw Error(fmt::format(
        "compaction: a queue of {} places for {} slots; expected at least as many places",
        request.capacity, request.slot_count));
  }
  const std::set<StageId> tags(request.wanted, request.wanted + request.queues_wanted);
  if (static_cast<int>(tags.size()) < request.queues_wanted) {
    throw Error("compaction: two wanted tags are the same; expected different ones");
  }
  if (request.slot_count > 0x7fffffffu) {
    throw Error(fmt::format("compaction: {} slots; expected fewer than 2^31", request.slot_count));
  }
}

void compact_cpu(TagPass pass, const CompactionRequest& request) {
  check_request(request);
  const Range all(0, request.slot_count, grain);
  Counts total;
  if (pass == TagPass::count) {
    total = tbb::parallel_reduce(
        all, Counts{},
        [&](const Range& range, const Counts& before) {
          return sum(before, count_tags(request, range));
        },
        sum);
  } else {
    // A prefix sum over ranges gives each range its offset, so the order is kept.
    total = tbb::parallel_scan(
        all, Counts{},
        [&](const Range& range, const Counts& before, bool final) {
          if (final) gather(request, range, before);
          return sum(before, count_tags(request, range));
        },
        sum);
  }
  for (int c = 0; c < request.queues_wanted; ++c) request.counts[c] = total[c];
}

}  // namespace pt
