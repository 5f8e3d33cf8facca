// The random numbers of many paths at once, in advance: eight at a time by AVX2, where the
// processor has it. On the CPU alone.
#pragma once

#include "common/sampling/sampler_source.h"

namespace pt {

/// Who draws, and which block of numbers (random.h).
struct alignas(32) DrawNames {
  static constexpr std::uint32_t size_max = 32;
  std::uint32_t pixel[size_max], sample[size_max], block[size_max];
};

/// What they draw, by component.
struct alignas(32) DrawnBlock {
  float u[4][DrawNames::size_max];

  Vec4 at(std::uint32_t i) const { return {u[0][i], u[1][i], u[2][i], u[3][i]}; }
  void set(std::uint32_t i, const Vec4& v) {
    for (int k = 0; k < 4; ++k) u[k][i] = v[k];
  }
};

/// PhiloxSource's, of the first `count` names.
void draw_block(std::uint64_t seed, const DrawNames& names, std::uint32_t count, DrawnBlock& drawn);

/// Whether a source's streams are PhiloxSource's.
inline bool is_philox(const PhiloxSource&) { return true; }
inline bool is_philox(const SamplerSource& source) {
  return source.sampler.kind == SamplerKind::independent && source.chains == nullptr;
}

/// Used as a source: both blocks of numbers of a ray, drawn in advance for several paths;
/// those of path `index` are returned.
struct DrawnSource {
  const DrawnBlock* scatter;
  const DrawnBlock* light;
  std::uint32_t index = 0;

  struct Stream {
    const DrawnSource& source;

    Vec4 draw(std::uint32_t block) const {
      return ((block & 1u) == 0 ? source.scatter : source.light)->at(source.index);
    }
  };
  Stream open(const PathId&) const { return {*this}; }
  void close(const PathId&, const Stream&) const {}
};

}  // namespace pt
