// Splits a set of references into two by the binned surface area heuristic on all three axes.
#pragma once

#include <span>

#include "common/accel/build/binary/partition_range.h"

namespace pt {

/// Which references go left: those whose centre lies in a bin below `bin` on `axis`.
struct ObjectSplit {
  float cost = HUGE_VALF;  ///< left area x left count + right area x right count; infinite: none
  int axis = 0;
  int bin = 0;
  int bin_count = 0;
  Box4 left_bounds, right_bounds;
};

/// Maps doubled centres to bins, monotonically.
class BinMapping {
 public:
  BinMapping(const Box4& centers, int bin_count);
  Int4 operator()(Float4 twice_center) const {
    const Float4 x = (twice_center - base_) * scale_;
    return __builtin_convertvector(min4(max4(x, Float4{}), last_), Int4);
  }
  /// Whether centres differ on an axis.
  bool is_flat(int axis) const { return scale_[axis] == 0.0f; }

 private:
  Float4 base_, scale_, last_;
};

/// The best split of `range` into two sets that are not empty.
ObjectSplit find_object_split(std::span<const BuildReference> references,
                              const ReferenceRange& range);

/// Reorders the references of `range` so that the left ones come first.
RangeHalves partition_references(std::span<BuildReference> references, const ReferenceRange& range,
                                 const ObjectSplit& split);

/// Two halves of equal count (the left one is larger by one if need be) along the widest axis:
/// always possible, and the shallowest tree that there is.
RangeHalves split_in_halves(std::span<BuildReference> references, const ReferenceRange& range);

}  // namespace pt
