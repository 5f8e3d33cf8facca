#include "wavefront/measure/measure_compaction.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>

namespace pt {
namespace {

/// The slots of a queue in ascending order, each once. A sort would take most of the time of
/// `ptexp compact`.
std::vector<std::uint32_t> in_order(const std::vector<std::uint32_t>& found, std::size_t slots) {
  std::vector<std::uint8_t> is_there(slots);
  for (const std::uint32_t slot : found) {
    if (slot < slots) is_there[slot] = 1;
  }
  std::vector<std::uint32_t> ordered;
  ordered.reserve(found.size());
  for (std::uint32_t slot = 0; slot < slots; ++slot) {
    if (is_there[slot] != 0) ordered.push_back(slot);
  }
  ordered.resize(found.size(), CompactionResult::unwritten);
  return ordered;
}

/// What is wrong with a queue of which `expected` are the slots, in ascending order.
std::string queue_breach(const CompactionInfo& strategy, std::uint32_t count,
                         const std::vector<std::uint32_t>& queue,
                         const std::vector<std::uint32_t>& expected) {
  if (count != expected.size()) {
    return fmt::format("counts {} slots; {} wait", count, expected.size());
  }
  const auto end = queue.begin() + (strategy.has_queues ? count : 0);
  const auto written = [](std::uint32_t slot) { return slot != CompactionResult::unwritten; };
  if (std::any_of(end, queue.end(), written)) return "is written beyond its slots";
  if (!strategy.has_queues) return "";
  std::vector<std::uint32_t> found(queue.begin(), end);
  if (strategy.appends) found = in_order(found, queue.size());  // the order of arrival is free
  const auto [wrong, right] = std::ranges::mismatch(found, expected);
  if (wrong == found.end()) return "";
  return fmt::format("has {} where slot {} belongs",
                     written(*wrong) ? fmt::format("slot {}", *wrong) : "nothing", *right);
}

}  // namespace

std::vector<StageId> make_tags(const CompactionCase& c) {
  std::mt19937_64 random(c.items);
  std::vector<StageId> tags(c.items, free_slot);
  for (std::uint32_t first = 0; first < c.items; first += std::min(c.run_length, c.items - first)) {
    const std::uint64_t bits = random();
    const double u = static_cast<double>(bits >> 11) * 0x1p-53;
    if (u >= static_cast<double>(c.density)) continue;
    const StageId stage = measured_stages[c.queues > 1 ? bits & 1 : 0];
    std::fill_n(tags.begin() + first, std::min(c.run_length, c.items - first), stage);
  }
  return tags;
}

std::uint64_t count_waiting(const std::vector<StageId>& tags) {
  return static_cast<std::uint64_t>(
      std::ranges::count_if(tags, [](StageId tag) { return tag != free_slot; }));
}

std::uint64_t moved_bytes(Compaction strategy, std::uint64_t slots, std::uint64_t waiting) {
  const bool gathers = compaction_info(strategy).has_queues;
  return slots * sizeof(StageId) + (gathers ? waiting * sizeof(std::uint32_t) : 0);
}

std::string contract_breach(Compaction strategy, const std::vector<StageId>& tags,
                            const CompactionResult& result) {
  for (std::size_t q = 0; q < result.queues.size(); ++q) {
    std::vector<std::uint32_t> expected;
    for (std::uint32_t slot = 0; slot < tags.size(); ++slot) {
      if (tags[slot] == measured_stages[q]) expected.push_back(slot);
    }
    const std::string breach =
        queue_breach(compaction_info(strategy), result.counts[q], result.queues[q], expected);
    if (!breach.empty()) {
      return fmt::format("the queue of {} {}", to_string(measured_stages[q]), breach);
    }
  }
  return "";
}

std::uint32_t count_passes(std::uint64_t items_per_time, std::uint64_t items) {
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(items_per_time / items, 1, 256));
}

std::uint32_t count_sets(std::uint64_t cold_bytes, std::uint64_t bytes) {
  return static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>((cold_bytes + bytes - 1) / bytes, 1, 4096));
}

}  // namespace pt
