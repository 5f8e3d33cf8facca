// References to primitives as the CPU's builders move them about: a box and a number in 32 bytes,
// four floats at a time; ranges of them, and their partition by any predicate.
#pragma once

#include <tbb/parallel_reduce.h>

#include <cstdint>
#include <span>
#include <utility>

#include "common/accel/build/binary/parallel.h"
#include "common/geometry/bounds.h"

namespace pt {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

inline Float4 min4(Float4 a, Float4 b) { return a < b ? a : b; }
inline Float4 max4(Float4 a, Float4 b) { return a > b ? a : b; }
inline Float4 to_float4(const Vec3& v) { return Float4{v.x, v.y, v.z, 0.0f}; }

/// A primitive to be built over. Trivial, so that large arrays of it need no pass to make them.
struct BuildReference {
  Float4 low, high;

  std::uint32_t id() const { return float_to_bits(low[3]) & ~id_tag; }  ///< 0..2^28-1
  Float4 twice_center() const { return low + high; }

  // Makes any number a normal float: adding denormal ones is slow.
  static constexpr std::uint32_t id_tag = 0x40000000u;
};
static_assert(sizeof(BuildReference) == 32);

inline BuildReference make_reference(const Bounds& box, std::uint32_t id) {
  return {Float4{box.min.x, box.min.y, box.min.z, bits_to_float(BuildReference::id_tag | id)},
          to_float4(box.max)};
}

/// A box in registers; the fourth component means nothing.
struct Box4 {
  Float4 low = {HUGE_VALF, HUGE_VALF, HUGE_VALF, HUGE_VALF};
  Float4 high = {-HUGE_VALF, -HUGE_VALF, -HUGE_VALF, -HUGE_VALF};

  void grow(Float4 p) { low = min4(low, p), high = max4(high, p); }
  void grow(const Box4& b) { low = min4(low, b.low), high = max4(high, b.high); }
  void grow(const BuildReference& r) { low = min4(low, r.low), high = max4(high, r.high); }
  /// Half the surface area of a box that is not empty.
  float half_area() const {
    const Float4 size = high - low;
    return size[0] * (size[1] + size[2]) + size[1] * size[2];
  }
  Bounds bounds() const { return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}; }
};

/// References of one subtree, with the box of their boxes and of their (doubled) centres.
struct ReferenceRange {
  std::uint32_t begin = 0, end = 0;
  Box4 bounds, centers;

  std::uint32_t size() const { return end - begin; }
  void grow(const BuildReference& r) { bounds.grow(r), centers.grow(r.twice_center()); }
  void grow(const ReferenceRange& r) { bounds.grow(r.bounds), centers.grow(r.centers); }
};

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
