// The samplers' random numbers: samples of a pixel are independent, stratified or low-discrepancy.
#pragma once

#include "common/choices/choices.h"
#include "common/platform/platform.h"
#include "common/sampling/chains.h"
#include "common/sampling/random.h"
#include "common/sampling/warp.h"

namespace pt {

/// A bijection in which every bit of the result depends on all bits of x (two rounds of
/// multiplication and shift; constants by Wellons' search for low bias).
PT_HD std::uint32_t remix(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ x >> 16;
}

// Sobol points: the sequence's first two dimensions with hash-based Owen scrambling and a shuffled
// order (Burley 2020, 'Practical hash-based Owen scrambling', JCGT 9(4)). Each pair of numbers of
// each block is a sequence of its own over a pixel's samples: padding, as pbrt-v4's
// PaddedSobolSampler (section 8.6.3) does it.

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

// Stratified numbers: a pixel's samples take the cells of a grid in random order, one each, a grid
// for every pair of numbers of a block (pbrt-v4, section 8.5).

/// The cells of a grid for `count` samples, as square as can be; what is left over is not
/// stratified.
struct StrataGrid {
  std::uint32_t columns = 1, rows = 1;

  PT_HD std::uint32_t cells() const { return columns * rows; }
};

inline StrataGrid make_strata_grid(std::uint32_t count) {
  std::uint32_t columns = 1;
  while (std::uint64_t{columns + 1} * (columns + 1) <= count) ++columns;
  return {columns, count / columns};
}

/// A random permutation of [0, count), for each seed another: bijections of the next power of two
/// are applied until the value is below count (cycle walking, as Kensler 2013, 'Correlated
/// multi-jittered sampling').
PT_HD std::uint32_t permute(std::uint32_t i, std::uint32_t count, std::uint32_t seed) {
  std::uint32_t mask = count - 1;
  mask |= mask >> 1, mask |= mask >> 2, mask |= mask >> 4, mask |= mask >> 8, mask |= mask >> 16;
  const std::uint32_t shift = mask > 0x3fu ? 4u : mask > 7u ? 2u : 1u;
  do {
    PT_UNROLL(1)
    for (std::uint32_t round = 0; round < 4; ++round) {  // fewer leave pairs of small grids uneven
      const std::uint32_t key = remix(seed + round * 0x9e3779b9u);
      i = (i ^ key) * (key >> 8 | 1u) & mask;
      i ^= i >> shift;
      i = (i + (key >> 20)) * (key >> 12 | 1u) & mask;
      i ^= i >> 1;
    }
  } while (i >= count);
  return i;
}

/// `u` in its cell. `sample` below the grid's number of cells.
PT_HD Vec2 stratify(const Vec2& u, const StrataGrid& grid, std::uint32_t sample,
                    std::uint32_t seed) {
  const std::uint32_t cell = permute(sample, grid.cells(), seed);
  const std::uint32_t row = cell / grid.columns, column = cell - row * grid.columns;
  return {
      fminf((static_cast<float>(column) + u.x) / static_cast<float>(grid.columns), one_minus_ulp),
      fminf((static_cast<float>(row) + u.y) / static_cast<float>(grid.rows), one_minus_ulp)};
}

/// The four numbers of a block: `u`, independent for each sample, in the cells that `seeds` (the
/// same for all samples of a pixel) give this sample. Samples after the last cell begin a new grid.
PT_HD Vec4 stratified_block(const Vec4& u, const StrataGrid& grid, std::uint32_t count,
                            std::uint32_t sample, const Uint4& seeds) {
  const std::uint32_t round = sample / count, index = sample - round * count;
  if (index >= grid.cells()) return u;
  const Vec2 a = stratify({u.x, u.y}, grid, index, seeds.x + round * seeds.z);
  const Vec2 b = stratify({u.z, u.w}, grid, index, seeds.y + round * seeds.w);
  return {a.x, a.y, b.x, b.y};
}

struct Sampler {
  SamplerKind kind = SamplerKind::independent;
  std::uint32_t samples = 1;  ///< per pixel, for the grid of strata
  StrataGrid grid;
};

inline Sampler make_sampler(SamplerKind kind, std::uint32_t samples) {
  return {kind, samples, make_strata_grid(samples)};
}

/// Stateless, as PhiloxSource, whose numbers these are when they are independent. All threads take
/// the same branch. Stratified and Sobol samples need 128 bits that are a pixel's and a block's.
/// With chains a path is what one of them proposes: then the stream's `pixel` and `sample` are its
/// Proposal's `path` and `iteration`.
struct SamplerSource {
  std::uint64_t seed;
  Sampler sampler;
  const Chains* chains = nullptr;

  struct Stream {
    static constexpr bool is_specialized = false;
    PhiloxSource::Stream philox;
    Sampler sampler;
    const Chains* chains;

    PT_HD Vec4 draw(std::uint32_t block) {
      const bool alone = sampler.kind == SamplerKind::independent && chains == nullptr;
      return alone ? philox.draw<is_specialized>(block) : draw_apart(*this, block);
    }
  };

  /// Not inlined: kernels that draw independent numbers, too, keep their registers and their code
  /// close together.
  static PT_NOINLINE Vec4 draw_apart(Stream stream, std::uint32_t block) {
    PhiloxSource::Stream& philox = stream.philox;
    const Sampler& sampler = stream.sampler;
    if (stream.chains != nullptr) return stream.chains->draw(philox.pixel, philox.sample, block);
    const Uint4 pattern = PhiloxSource::Stream{philox.seed, philox.pixel, 0}.bits<false>(block, 2);
    if (sampler.kind == SamplerKind::sobol) return sobol_block(philox.sample, pattern);
    return stratified_block(philox.draw<false>(block), sampler.grid, sampler.samples, philox.sample,
                            pattern);
  }

  PT_HD Stream open(const PathId& id) const {
    if (chains == nullptr) return {PhiloxSource{seed}.open(id), sampler, nullptr};
    const Proposal proposal = load_wide(&chains->proposals[id.index]);
    return {{seed, proposal.path, proposal.iteration}, sampler, chains};
  }
  PT_HD void close(const PathId&, const Stream&) const {}
};

/// Where a path of pixel `pixel` and block 0 `u` begins: there, but a chain's path where its
/// numbers place it on the image.
template <class Stream>
PT_HD PixelPoint pixel_point(const Stream&, std::uint32_t pixel, const Vec4& u) {
  return {pixel, u};
}
PT_HD PixelPoint pixel_point(const SamplerSource::Stream& stream, std::uint32_t pixel,
                             const Vec4& u) {
  return stream.chains == nullptr ? PixelPoint{pixel, u} : stream.chains->window.point_of(u);
}

}  // namespace pt
