// A primitive as the CPU's builders move it about: its box and number in 32 bytes, four floats at a
// time.
#pragma once

#include <cstdint>

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

}  // namespace pt
