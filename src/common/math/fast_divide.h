// Division by a number known only at run time, as one multiplication and a shift.
#pragma once

#include "common/platform/platform.h"

namespace pt {

/// Divides numbers below 2^31 by `divisor`, 1 <= divisor < 2^31
/// (Granlund and Montgomery 1994, 'Division by Invariant Integers using Multiplication').
class FastDivider {
 public:
  FastDivider() = default;
  explicit FastDivider(std::uint32_t divisor) : divisor_(divisor) {
    while ((std::uint64_t{1} << shift_) < divisor) ++shift_;
    multiplier_ = ((std::uint64_t{1} << (31 + shift_)) + divisor - 1) / divisor;
  }

  bool operator==(const FastDivider&) const = default;

  PT_HD std::uint32_t divisor() const { return divisor_; }
  PT_HD std::uint32_t quotient(std::uint32_t n) const {
    return static_cast<std::uint32_t>((n * multiplier_) >> (31 + shift_));
  }

 private:
  std::uint64_t multiplier_ = std::uint64_t{1} << 31;  // at most 2^32: n * multiplier_ < 2^63
  std::uint32_t divisor_ = 1;
  std::uint32_t shift_ = 0;
};

}  // namespace pt
