// The samplers' random numbers: samples of a pixel are independent, stratified or low-discrepancy.
#pragma once

#include "common/choices/choices.h"
#include "common/sampling/chains.h"
#include "common/sampling/random.h"
#include "common/sampling/sobol.h"
#include "common/sampling/stratified.h"

namespace pt {

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
