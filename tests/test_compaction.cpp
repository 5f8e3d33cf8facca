// Compaction on the CPU; the tests are in compaction_cases.h.
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstring>

#include "compaction_cases.h"
#include "wavefront/run_stage_cpu.h"

namespace pt {
namespace {

class CpuDevice {
 public:
  static constexpr const char* name = "CPU";
  static constexpr bool numbers_slots = false;
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

  Compactor compactor(Compaction strategy, std::uint32_t /*slot_count_max*/) {
    return [this, strategy](const CompactionRequest& request) {
      arena_.execute([&] { compact_cpu(strategy, request); });
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

}  // namespace
}  // namespace pt
