#include "common/device/cpu/huge_pages.h"

#include <vector>

#include "common/scene/data/scene_arrays.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace pt {
namespace {

[[maybe_unused]] constexpr int collapse =
    25;  // MADV_COLLAPSE of Linux 6.1: now, and what is filled

// Measured: results/log/2026-11-whole-process.md and 2026-11-cpu-shading.md.
[[maybe_unused]] constexpr double copy_s_of_byte = 8e-10, time_saved = 0.07;

}  // namespace

HugePageRange huge_page_range(const void* begin, std::size_t size_bytes) {
  constexpr std::uintptr_t page = HugePageRange::page_bytes;
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (address + page - 1) / page * page;
  const std::uintptr_t last = (address + size_bytes) / page * page;
  return first < last ? HugePageRange{first, last - first} : HugePageRange{};
}

void use_huge_pages([[maybe_unused]] const SceneData& scene, [[maybe_unused]] double tracing_s) {
#ifdef __linux__
  std::vector<HugePageRange> ranges;
  double size_bytes = 0;
  const auto add = [&](auto*&, const auto& values, const char*) {
    ranges.push_back(huge_page_range(values.data(), values.size() * sizeof values.front()));
    size_bytes += static_cast<double>(ranges.back().size_bytes);
  };
  Scene view;
  for_each_array(scene, view, add);
  scene.tree.for_each_array(view.triangles, add);
  if (copy_s_of_byte * size_bytes > time_saved * tracing_s) return;
  for (const HugePageRange& range : ranges) {
    if (range.size_bytes == 0) continue;
    void* const begin = reinterpret_cast<void*>(range.begin);
    madvise(begin, range.size_bytes, MADV_HUGEPAGE);
    madvise(begin, range.size_bytes, collapse);
  }
#endif
}

}  // namespace pt
