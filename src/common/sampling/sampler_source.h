// Numbers that a sampler places: each sample of a pixel on its own, or all of them together.
#pragma once

#include "common/sampling/choices.h"
#include "common/sampling/random.h"
#include "common/sampling/sobol.h"
#include "common/sampling/stratified.h"

namespace pt {

struct Sampler {
  SamplerKind kind = SamplerKind::independent;
  std::uint32_t samples = 1;  ///< of a pixel, for which a grid is made
  StrataGrid grid;
};

inline Sampler make_sampler(SamplerKind kind, std::uint32_t samples) {
  return {kind, samples, make_strata_grid(samples)};
}

/// Stateless, as PhiloxSource, whose numbers these are when they are independent. All threads take
/// the same branch. Samples that know of each other need 128 bits that are a pixel's and a block's.
struct SamplerSource {
  std::uint64_t seed;
  Sampler sampler;

  struct Stream {
    PhiloxSource::Stream philox;
    Sampler sampler;

    PT_HD Vec4 draw(std::uint32_t block) {
      if (sampler.kind == SamplerKind::independent) return philox.draw(block);
      const Uint4 pattern = PhiloxSource::Stream{philox.seed, philox.pixel, 0}.bits(block, 2);
      if (sampler.kind == SamplerKind::sobol) return sobol_block(philox.sample, pattern);
      return stratified_block(philox.draw(block), sampler.grid, sampler.samples, philox.sample,
                              pattern);
    }
  };

  PT_HD Stream open(const PathId& id) const { return {PhiloxSource{seed}.open(id), sampler}; }
  PT_HD void close(const PathId&, const Stream&) const {}
};

}  // namespace pt
