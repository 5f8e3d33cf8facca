// Points of the Sobol sequence's first two dimensions with hash-based Owen scrambling and a
// shuffled order (Burley 2020, 'Practical hash-based Owen scrambling', JCGT 9(4)). Each pair of
// numbers of each block is a sequence of its own over a pixel's samples: padding, as pbrt-v4's
// PaddedSobolSampler (section 8.6.3) does it.
#pragma once

#include "common/sampling/philox.h"
#include "common/sampling/remix.h"
#include "common/sampling/warp.h"

namespace pt {

/// A permutation in which each bit changes by those below it alone (Laine and Karras 2011, with
/// Vegdahl's constants of 2021).
PT_HD std::uint32_t permute_upwards(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= seed >> 16 | 1u;
  x ^= x * 0x05526c56u;
  return x ^ x * 0x53a22864u;
}

/// The second generator matrix is Pascal's triangle modulo 2: bit i of the result is the sum of all
/// bits j of the index in whose binary number i's is contained (Lucas), five passes.
PT_HD std::uint32_t pascal_sum(std::uint32_t index) {
  index ^= index >> 1 & 0x55555555u;
  index ^= index >> 2 & 0x33333333u;
  index ^= index >> 4 & 0x0f0f0f0fu;
  index ^= index >> 8 & 0x00ff00ffu;
  return index ^ (index >> 16 & 0x0000ffffu);
}

/// A scrambled pair of the sequence that `seeds` name: a shuffle and two scrambles.
PT_HD Vec2 sobol_pair(std::uint32_t sample, std::uint32_t shuffle, std::uint32_t scramble0,
                      std::uint32_t scramble1) {
  // Scrambling the index, too, permutes aligned runs of 2^m points and keeps each one whole.
  const std::uint32_t index = reverse_bits(permute_upwards(reverse_bits(sample), shuffle));
  const std::uint32_t x = reverse_bits(permute_upwards(index, scramble0));
  const std::uint32_t y = reverse_bits(permute_upwards(pascal_sum(index), scramble1));
  return {to_unit_float(x), to_unit_float(y)};
}

/// The four numbers of a block for the sample of this number; `seeds`: 128 random bits that are the
/// same for all samples of a pixel.
PT_HD Vec4 sobol_block(std::uint32_t sample, const Uint4& seeds) {
  const Vec2 a = sobol_pair(sample, seeds.x, seeds.y, seeds.z);
  const Vec2 b = sobol_pair(sample, seeds.w, remix(seeds.y), remix(seeds.z));
  return {a.x, a.y, b.x, b.y};
}

}  // namespace pt
