// Partitions of references by any predicate.
#pragma once

#include <tbb/parallel_reduce.h>

#include <span>
#include <utility>

#include "common/accel/build/binary/build_reference.h"
#include "common/accel/build/binary/parallel.h"

namespace pt {

struct RangeHalves {
  ReferenceRange left, right;
};

inline constexpr std::uint32_t serial_range_max = 1 << 16;  ///< threads share what is larger
inline constexpr std::uint32_t range_block = 1 << 13;

inline ReferenceRange measured_range(std::span<const BuildReference> references,
                                     std::uint32_t begin, std::uint32_t end) {
  const auto grow = [&](const tbb::blocked_range<std::uint32_t>& part, ReferenceRange sum) {
    for (std::uint32_t i = part.begin(); i < part.end(); ++i) sum.grow(references[i]);
    return sum;
  };
  const tbb::blocked_range<std::uint32_t> all(begin, end, range_block);
  ReferenceRange range = end - begin <= serial_range_max
                             ? grow(all, {})
                             : tbb::parallel_reduce(all, ReferenceRange(), grow,
                                                    [](ReferenceRange a, const ReferenceRange& b) {
                                                      a.grow(b);
                                                      return a;
                                                    });
  range.begin = begin, range.end = end;
  return range;
}

template <class GoesLeft>
RangeHalves partition_serially(std::span<BuildReference> references, std::uint32_t begin,
                               std::uint32_t end, GoesLeft goes_left) {
  RangeHalves halves;
  std::uint32_t i = begin, j = end;
  for (;;) {
    for (; i < j && goes_left(references[i]); ++i) halves.left.grow(references[i]);
    for (; i < j && !goes_left(references[j - 1]); --j) halves.right.grow(references[j - 1]);
    if (i >= j) break;
    std::swap(references[i], references[j - 1]);
  }
  halves.left.begin = begin, halves.left.end = halves.right.begin = i;
  halves.right.end = end;
  return halves;
}

/// Reorders references [begin, end) so that those that `goes_left` says of come first. The result
/// does not depend on the number of threads.
template <class GoesLeft>
RangeHalves partition_range(std::span<BuildReference> references, std::uint32_t begin,
                            std::uint32_t end, GoesLeft goes_left) {
  if (end - begin <= serial_range_max) {
    return partition_serially(references, begin, end, goes_left);
  }
  const std::size_t left = parallel_partition(references.subspan(begin, end - begin), goes_left);
  const std::uint32_t middle = begin + static_cast<std::uint32_t>(left);
  return {measured_range(references, begin, middle), measured_range(references, middle, end)};
}

}  // namespace pt
