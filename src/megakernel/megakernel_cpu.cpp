// The megakernel on the CPU: the paths are divided over oneTBB's threads as --work says.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>

#include "common/device/cpu/cpu_renderer.h"
#include "megakernel/megakernel.h"
#include "megakernel/trace_path.h"

namespace pt {
namespace {

/// A thread of the CPU is a warp of one. `Cancelled` tells whether no path more is to be traced.
template <class Cancelled>
class PathRange {
 public:
  /// Every `step`-th index of [first, end).
  PathRange(const PathSupply& supply, const SampleBuffer& batch, std::uint32_t first,
            std::uint32_t end, std::uint32_t step, const Cancelled& cancelled)
      : supply_(supply),
        samples_(batch.samples),
        next_(first),
        end_(end),
        step_(step),
        cancelled_(cancelled) {}

  bool any(bool value) const { return value; }

  bool next(std::uint32_t& path_index, bool wanted) {
    if (!wanted) return true;
    for (; next_ < end_; advance()) {
      path_index = next_;
      if (!supply_.has_chains()) {
        if (cancelled_()) return false;
        advance();
        return true;
      }
      if (next_apart(path_index)) return true;
    }
    return false;
  }

 private:
  // Not inlined: paths of other kinds keep their registers.
  PT_NOINLINE bool next_apart(std::uint32_t path_index) const {
    return supply_.next(samples_, path_index);
  }

  void advance() { next_ = end_ - next_ > step_ ? next_ + step_ : end_; }

  PathSupply supply_;
  Sample* samples_;
  std::uint32_t next_, end_, step_;
  const Cancelled& cancelled_;
};

class MegakernelCpu : public CpuRenderer {
 public:
  MegakernelCpu(const ExecutionPlan& plan, const SceneData& scene) : CpuRenderer(plan, scene) {}

 private:
  void trace_batch(const SampleBuffer& batch) override {
    const auto cancelled = [this] { return is_cancelled(); };
    with_random_source(batch, [&](const auto& source) {
      using Source = std::remove_cvref_t<decltype(source)>;
      dispatch_traits(CpuKindsWith<Source>{}, traits_, [&](auto traits) {
        dispatch_branching<false, decltype(traits), Source, SceneMemory::global, KernelBody::loop>(
            plan_.branching, [&](auto branching) {
              timer_.time("megakernel", [&] {
                divide(batch, [&](std::uint32_t first, std::uint32_t end, std::uint32_t step) {
                  PathRange work(supply(), batch, first, end, step, cancelled);
                  trace_paths<decltype(traits), branching()>(scene_, source, batch, path_settings_,
                                                             work);
                });
              });
            });
      });
    });
  }

  // pixel: a task follows all samples of a pixel; sample: a task is one path's row of the batch;
  // persistent: each thread fetches runs of paths until none is left.
  template <class Trace>
  void divide(const SampleBuffer& batch, Trace&& trace) {
    const std::uint32_t pixels = batch.pixel_count.divisor();
    if (plan_.work == Work::pixel) {
      tbb::parallel_for(std::uint32_t{0}, pixels,
                        [&](std::uint32_t i) { trace(i, batch.path_count, pixels); });
    } else if (plan_.work == Work::sample) {
      tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, batch.path_count),
                        [&](const auto& range) { trace(range.begin(), range.end(), 1); });
    } else {
      constexpr std::uint32_t run = 256;
      std::atomic<std::uint64_t> next{0};
      const int threads = tbb::this_task_arena::max_concurrency();
      tbb::parallel_for(0, threads, [&](int) {
        for (std::uint64_t first; (first = next.fetch_add(run)) < batch.path_count;) {
          const std::uint64_t end = std::min<std::uint64_t>(first + run, batch.path_count);
          trace(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end), 1);
        }
      });
    }
  }
};

}  // namespace

std::unique_ptr<Renderer> make_megakernel_cpu(const ExecutionPlan& plan, const SceneData& scene) {
  return std::make_unique<MegakernelCpu>(plan, scene);
}

}  // namespace pt
