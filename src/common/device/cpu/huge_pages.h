// Large arrays that are read in no order: where pages are small, finding a page takes as long as
// reading it.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// Asks the system to put the scene's large arrays into huge pages, as they are, if the time that
/// copies them is less than what `tracing_s` of tracing is expected to become shorter by. Where it
/// cannot, nothing happens.
void use_huge_pages(const SceneData& scene, double tracing_s);

/// The part of an array of `size_bytes` at `begin` that whole huge pages cover.
struct HugePageRange {
  std::uintptr_t begin = 0;
  std::size_t size_bytes = 0;  ///< 0: none

  static constexpr std::size_t page_bytes = std::size_t{1} << 21;
};
HugePageRange huge_page_range(const void* begin, std::size_t size_bytes);

}  // namespace pt
