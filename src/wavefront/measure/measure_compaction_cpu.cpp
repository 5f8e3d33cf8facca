#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <array>
#include <chrono>
#include <cstring>

#include "common/device/cpu/cpu_renderer.h"
#include "common/error/host_memory.h"
#include "wavefront/measure/measure_compaction.h"
#include "wavefront/run_stage_cpu.h"

namespace pt {
namespace {

/// What a stage does with slots that it has finished.
void append_waiting(const CompactionRequest& request) {
  std::array<std::uint32_t, queue_count> ends{};
  StageQueues queues;
  queues.waiting = ends.data();
  for (int c = 0; c < request.queues_wanted; ++c) {
    queues.next[queue_index(request.wanted[c])] = request.queues[c];
  }
  const tbb::blocked_range<std::uint32_t> all(0, request.slot_count, RangeAppender::range_max);
  const auto append_range = [&](const tbb::blocked_range<std::uint32_t>& range) {
    RangeAppender appender;
    for (std::uint32_t slot = range.begin(); slot < range.end(); ++slot) {
      for (int c = 0; c < request.queues_wanted; ++c) {
        if (request.tags[slot] == request.wanted[c]) appender.append(request.wanted[c], slot);
      }
    }
    appender.flush(queues);
  };
  tbb::parallel_for(all, append_range, tbb::simple_partitioner());
  for (int c = 0; c < request.queues_wanted; ++c) {
    request.counts[c] = ends[static_cast<std::size_t>(queue_index(request.wanted[c]))];
  }
}

void run_pass(Compaction strategy, const CompactionRequest& request) {
  const TagPass pass = compaction_info(strategy).pass;
  if (pass == TagPass::none) {
    append_waiting(request);
  } else {
    compact_cpu(pass, request);
  }
}

/// Tags and queues, `sets` times.
class Slots {
 public:
  Slots(const std::vector<StageId>& tags, int queues, std::uint32_t sets)
      : count_(tags.size()), queue_count_(queues) {
    const auto index_bytes = static_cast<std::uint64_t>(queues) * sizeof(std::uint32_t);
    check_host_memory(sets * count_ * (sizeof(StageId) + index_bytes), "the slots of a compaction");
    for (std::uint32_t set = 0; set < sets; ++set)
      tags_.insert(tags_.end(), tags.begin(), tags.end());
    queues_.assign(static_cast<std::size_t>(queues) * tags_.size(), CompactionResult::unwritten);
  }

  CompactionRequest request(std::uint32_t set) {
    CompactionRequest result;
    result.tags = &tags_[set * count_];
    result.slot_count = result.capacity = static_cast<std::uint32_t>(count_);
    result.queues_wanted = queue_count_;
    for (int q = 0; q < queue_count_; ++q) {
      result.wanted[q] = measured_stages[q];
      result.queues[q] =
          &queues_[(set * static_cast<std::size_t>(queue_count_) + static_cast<std::size_t>(q)) *
                   count_];
    }
    result.counts = counts_.data();
    return result;
  }

 private:
  std::size_t count_;
  int queue_count_;
  std::vector<StageId> tags_;
  std::vector<std::uint32_t> queues_;
  std::array<std::uint32_t, measured_queues_max> counts_{};
};

constexpr std::uint64_t items_per_time = std::uint64_t{1} << 22;
constexpr std::uint64_t cold_bytes = std::uint64_t{1} << 26;

/// Calls pass(set) as planned; sets that one time does not reach are the next one's.
template <class Pass>
std::vector<double> time_passes(const PassPlan& plan, const MeasuredRuns& runs, Pass&& pass) {
  std::vector<double> times_ms;
  std::uint32_t set = 0;
  for (int run = -runs.warmup; run < runs.repeat; ++run) {
    const auto begin = std::chrono::steady_clock::now();
    for (std::uint32_t i = 0; i < plan.passes; ++i) {
      pass(set);
      set = (set + 1) % plan.sets;
    }
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
    if (run >= 0) times_ms.push_back(time.count() / plan.passes);
  }
  return times_ms;
}

class CompactionCpu : public CompactionDevice {
 public:
  std::vector<CopyWay> copy_ways() const override { return {CopyWay::memcpy}; }
  PassPlan plan(std::uint64_t items, std::uint64_t bytes, bool cold) const override {
    return {count_passes(items_per_time, items), count_sets(cold ? cold_bytes : 0, bytes)};
  }
  int threads() const override { return tbb::this_task_arena::max_concurrency(); }

  CompactionResult compact(Compaction strategy, const std::vector<StageId>& tags,
                           int queues) override {
    Slots slots(tags, queues, 1);
    const CompactionRequest request = slots.request(0);
    run_pass(strategy, request);
    CompactionResult result;
    for (int q = 0; q < queues; ++q) {
      result.counts.push_back(request.counts[q]);
      result.queues.emplace_back(request.queues[q], request.queues[q] + request.slot_count);
    }
    return result;
  }

  std::vector<double> time_compaction(Compaction strategy, const std::vector<StageId>& tags,
                                      int queues, const PassPlan& plan,
                                      const MeasuredRuns& runs) override {
    Slots slots(tags, queues, plan.sets);
    return time_passes(plan, runs,
                       [&](std::uint32_t set) { run_pass(strategy, slots.request(set)); });
  }

  std::vector<double> time_copy(CopyWay, std::uint64_t bytes, const PassPlan& plan,
                                const MeasuredRuns& runs) override {
    const std::size_t size = (bytes + 1) / 2;
    check_host_memory(2 * size * plan.sets, "the copy beside a compaction");
    std::vector<char> from(size * plan.sets, 1), to(size * plan.sets);
    constexpr std::size_t grain = std::size_t{1} << 18;
    return time_passes(plan, runs, [&](std::uint32_t set) {
      const std::size_t first = set * size;
      const tbb::blocked_range<std::size_t> all(first, first + size, grain);
      tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& range) {
        std::memcpy(&to[range.begin()], &from[range.begin()], range.size());
      });
    });
  }
};

}  // namespace

std::unique_ptr<CompactionDevice> make_compaction_cpu() {
  return std::make_unique<CompactionCpu>();
}

}  // namespace pt
