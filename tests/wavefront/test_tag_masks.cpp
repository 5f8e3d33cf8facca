// Tags compared 32 at a time, against one by one.
#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "statistics.h"
#include "wavefront/compaction/tag_masks.h"

namespace pt {
namespace {

constexpr int tag_count = stage_count + 1;  // and idle

using Tags = std::array<StageId, mask_slots>;

std::uint32_t mask_of(const Tags& tags, StageId wanted) {
  std::uint32_t words[8];
  static_assert(sizeof words == sizeof tags);
  std::memcpy(words, tags.data(), sizeof words);
  return match_mask(words, wanted);
}

void expect_every_mask(const Tags& tags) {
  for (int tag = 0; tag < tag_count; ++tag) {
    const auto wanted = static_cast<StageId>(tag);
    std::uint32_t expected = 0;
    for (std::uint32_t i = 0; i < mask_slots; ++i) expected |= (tags[i] == wanted ? 1u : 0u) << i;
    ASSERT_EQ(mask_of(tags, wanted), expected) << to_string(wanted);
  }
}

// Next to each other, since a byte must not borrow from its neighbour.
TEST(TagMasks, AreRightForEveryPairOfTagsAtEveryPlace) {
  for (int a = 0; a < tag_count; ++a) {
    for (int b = 0; b < tag_count; ++b) {
      Tags tags;
      tags.fill(static_cast<StageId>(a));
      for (StageId& tag : tags) {
        tag = static_cast<StageId>(b);
        expect_every_mask(tags);
        if (HasFatalFailure()) return;
      }
      for (std::uint32_t i = 0; i < mask_slots; ++i) {
        tags.fill(static_cast<StageId>(a));
        tags[i] = static_cast<StageId>(b);
        expect_every_mask(tags);
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(TagMasks, AreRightForTagsAtRandom) {
  TestRandom random(1);
  for (int i = 0; i < 10'000; ++i) {
    Tags tags;
    for (StageId& tag : tags) tag = static_cast<StageId>(random.below(tag_count));
    expect_every_mask(tags);
    if (HasFatalFailure()) return;
  }
}

TEST(TagMasks, GiveTheirBitsInOrder) {
  TestRandom random(2);
  for (int i = 0; i < 10'000; ++i) {
    std::uint32_t mask = random.bits() >> random.below(32);
    for (std::uint32_t bit = 0; bit < 32; ++bit) {
      if ((mask >> bit & 1) == 0) continue;
      ASSERT_EQ(lowest_bit(mask), bit);
      mask &= mask - 1;
    }
    ASSERT_EQ(mask, 0u);
  }
}

}  // namespace
}  // namespace pt
