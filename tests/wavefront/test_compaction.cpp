// Compaction on the CPU; the tests are in compaction_cases.h.
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstring>
#include <latch>
#include <thread>

#include "compaction_cases.h"
#include "wavefront/run_stage_cpu.h"

namespace pt {
namespace {

class CpuDevice {
 public:
  static constexpr const char* name = "CPU";
  static constexpr int pass_queues_max = CompactionRequest::queues_max;
  struct Shape {
    int threads;
    std::string text() const { return std::to_string(threads) + " threads"; }
  };

  static bool available() { return true; }
  static std::vector<Shape> shapes() { return {{4}, {1}, {2}, {3}, {7}}; }

  void* allocate(std::size_t size_bytes) { return ::operator new(size_bytes); }
  void release(void* memory) { ::operator delete(memory); }
  void upload(void* to, const void* from, std::size_t size_bytes) { copy(to, from, size_bytes); }
  void download(void* to, const void* from, std::size_t size_bytes) { copy(to, from, size_bytes); }

  Compactor compactor(TagPass pass, std::uint32_t /*slot_count_max*/) {
    return [this, pass](const CompactionRequest& request) {
      arena_.execute([&] { compact_cpu(pass, request); });
    };
  }

  template <class Stage>
  void run(const Stage& stage, const StageQueues& queues, const Shape& shape) {
    tbb::task_arena arena(shape.threads);
    arena.execute([&] { run_stage_cpu(stage, Scene{}, queues); });
  }

 private:
  static void copy(void* to, const void* from, std::size_t size_bytes) {
    if (size_bytes > 0) std::memcpy(to, from, size_bytes);
  }

  // More threads than this machine may have: they must not disturb each other.
  tbb::global_control threads_{tbb::global_control::max_allowed_parallelism, 8};
  tbb::task_arena arena_{4};
};

INSTANTIATE_TYPED_TEST_SUITE_P(Cpu, CompactionOf, CpuDevice);

// Threads that do nothing but reserve places.
TEST(RangeAppender, GivesNoPlaceTwice) {
  constexpr std::uint32_t thread_count = 4, appends = 2'000'000;
  Slots queue(thread_count * appends, poison), waiting(queue_count + 1);
  StageQueues queues;
  queues.next[queue_index(StageId::shade_surface)] = queue.data();
  queues.waiting = waiting.data();
  std::latch start(thread_count);
  std::vector<std::thread> threads;
  for (std::uint32_t t = 0; t < thread_count; ++t) {
    threads.emplace_back([&queues, &start, t] {
      RangeAppender appender;
      start.arrive_and_wait();
      for (std::uint32_t i = 0; i < appends; ++i) {
        appender.append(StageId::shade_surface, t * appends + i);
        appender.flush(queues);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(waiting[queue_index(StageId::shade_surface)], queue.size());
  std::vector<int> times(queue.size());
  for (const std::uint32_t slot : queue) {
    ASSERT_LT(slot, times.size()) << "a place is empty";
    ++times[slot];
  }
  EXPECT_EQ(times, std::vector<int>(queue.size(), 1));
}

}  // namespace
}  // namespace pt
