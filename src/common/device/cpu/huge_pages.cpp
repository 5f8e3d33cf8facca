#include "common/device/cpu/huge_pages.h"

#include "common/scene/data/scene_arrays.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace pt {
namespace {

[[maybe_unused]] constexpr int collapse =
    25;  // MADV_COLLAPSE of Linux 6.1: now, and what is filled

}  // namespace

HugePageRange huge_page_range(const void* begin, std::size_t size_bytes) {
  constexpr std::uintptr_t page = HugePageRange::page_bytes;
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (address + page - 1) / page * page;
  const std::uintptr_t last = (address + size_bytes) / page * page;
  return first < last ? HugePageRange{first, last - first} : HugePageRange{};
}

void use_huge_pages([[maybe_unused]] const SceneData& scene) {
#ifdef __linux__
  const auto use = [](auto*&, const auto& values, const char*) {
    const HugePageRange range =
        huge_page_range(values.data(), values.size() * sizeof values.front());
    if (range.size_bytes == 0) return;
    void* const begin = reinterpret_cast<void*>(range.begin);
    madvise(begin, range.size_bytes, MADV_HUGEPAGE);
    madvise(begin, range.size_bytes, collapse);
  };
  Scene view;
  for_each_array(scene, view, use);
  scene.tree.for_each_array(view.triangles, use);
#endif
}

}  // namespace pt
