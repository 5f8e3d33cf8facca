// Rays that nobody should trace, among others: with what is no number, infinite, no normal number,
// or 0, and without a direction.
#pragma once

#include <gtest/gtest.h>

#include <limits>

#include "common/accel/trace_cpu/ray_block.h"
#include "common/accel/traverse_brute.h"
#include "common/scene/data/scene_data.h"
#include "statistics.h"

namespace pt {

inline float nasty_float(TestRandom& random) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  constexpr float values[] = {0.0f,     -0.0f,     std::numeric_limits<float>::quiet_NaN(),
                              infinity, -infinity, 1e-42f,
                              -1e-42f,  1e-30f,    3e38f,
                              -3e38f,   1e19f,     -1e19f,
                              1.0f,     -1.0f};
  return values[random.below(std::size(values))];
}

/// `ray` with some of its numbers, perhaps all or none, made nasty.
inline Ray make_nasty(Ray ray, TestRandom& random) {
  const std::uint32_t which = random.bits() & random.bits();
  for (int i = 0; i < 3; ++i) {
    if ((which >> i & 1u) != 0) ray.origin[i] = nasty_float(random);
    if ((which >> (3 + i) & 1u) != 0) ray.direction[i] = nasty_float(random);
  }
  return ray;
}

/// Ray i of a block has met what it meets alone.
inline void expect_hit(const HitBlock& hits, std::uint32_t i, const Hit& expected) {
  ASSERT_EQ(hits.primitive[i], expected.primitive) << "ray " << i;
  if (!expected.is_miss()) {
    ASSERT_EQ(float_to_bits(hits.t[i]), float_to_bits(expected.t)) << "ray " << i;
  }
}

/// Blocks of 1 to 32 rays of make(random), a third of them nasty, each with a t_max that may be
/// anything: function(block).
template <class Make, class Function>
void for_each_block(int blocks, TestRandom& random, Make&& make, Function&& function) {
  for (int b = 0; b < blocks; ++b) {
    RayBlock block;
    const std::uint32_t count = 1 + static_cast<std::uint32_t>(b) % RayBlock::size_max;
    while (block.count < count) {
      const Ray ray = make(random);
      const std::uint32_t kind = random.below(12);
      const float t_max = kind == 0   ? nasty_float(random)
                          : kind <= 4 ? static_cast<float>(random.log_uniform(1e-3, 1e3))
                                      : infinite_distance;
      block.append(random.below(3) == 0 ? make_nasty(ray, random) : ray, t_max);
    }
    function(block);
  }
}

}  // namespace pt
