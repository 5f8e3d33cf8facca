// Many tags compared at once: a bit for each of 32 neighbouring slots.
#pragma once

#include "common/options/stage_info.h"
#include "common/platform/platform.h"

namespace pt {

inline constexpr std::uint32_t mask_slots = 32;  ///< of a mask

/// `tag` in each byte of a word.
PT_HD std::uint32_t repeat_tag(StageId tag) {
  return 0x01010101u * static_cast<std::uint32_t>(tag);
}

/// Bit i: whether byte i of `tags`, counted from the lowest, is the tag that `wanted` repeats.
PT_HD std::uint32_t match_four(std::uint32_t tags, std::uint32_t wanted) {
  // Tags are below 128. A byte of the difference is 0 where they match, and only there 128 minus it
  // has its highest bit; no byte borrows from the next.
  static_assert(stage_count < 128);
  const std::uint32_t matches = (0x80808080u - (tags ^ wanted)) & 0x80808080u;
  return matches * 0x00204081u >> 28;  // bits 7, 15, 23, 31 to 28, 29, 30, 31
}

/// The bits of 32 tags: bit i is that of byte i % 4 of words[i / 4].
PT_HD std::uint32_t match_mask(const std::uint32_t (&words)[8], StageId wanted) {
  const std::uint32_t repeated = repeat_tag(wanted);
  std::uint32_t mask = 0;
  PT_UNROLL(8)
  for (int w = 0; w < 8; ++w) mask |= match_four(words[w], repeated) << 4 * w;
  return mask;
}

/// The lowest bit that is set; mask != 0.
PT_HD std::uint32_t lowest_bit(std::uint32_t mask) {
  return 31u - static_cast<std::uint32_t>(count_leading_zeros(mask & (0u - mask)));
}

}  // namespace pt
