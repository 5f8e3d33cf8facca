// Noise for generated shapes: pure functions of a place, the same on every machine, as they use no
// operation but those that IEEE 754 defines.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace pt {

/// A bijection of 32-bit words that changes half of the bits (the finaliser of MurmurHash3).
inline std::uint32_t mix_bits(std::uint32_t h) {
  h = (h ^ (h >> 16)) * 0x85ebca6bu;
  h = (h ^ (h >> 13)) * 0xc2b2ae35u;
  return h ^ (h >> 16);
}

/// Gradient noise of `D` = 2 or 3 dimensions: zero at the lattice of integers, twice continuously
/// differentiable, mean 0, within [-D / 2, D / 2] and mostly within a third of that. Perlin 2002,
/// 'Improving Noise', with gradients of random lengths.
template <int D>
double gradient_noise(const glm::vec<D, double>& p, std::uint32_t seed) {
  constexpr int bits = 32 / D;
  constexpr std::uint32_t mask = (1u << bits) - 1;
  double floor[D], offset[D], fade[D];
  for (int d = 0; d < D; ++d) {
    floor[d] = std::floor(p[d]);
    const double t = offset[d] = p[d] - floor[d];
    fade[d] = t * t * t * (t * (t * 6 - 15) + 10);
  }
  double sum = 0;
  for (int corner = 0; corner < 1 << D; ++corner) {
    std::uint32_t hash = seed;
    double weight = 1;
    for (int d = 0; d < D; ++d) {
      const int step = (corner >> d) & 1;
      const auto cell = static_cast<std::uint32_t>(static_cast<std::int64_t>(floor[d]) + step);
      hash = mix_bits(hash ^ (cell * 0x9e3779b9u + static_cast<std::uint32_t>(d)));
      weight *= step ? fade[d] : 1 - fade[d];
    }
    double slope = 0;
    for (int d = 0; d < D; ++d) {
      const double gradient = ((hash >> (d * bits)) & mask) * (2.0 / mask) - 1.0;
      slope += gradient * (offset[d] - ((corner >> d) & 1));
    }
    sum += weight * slope;
  }
  return sum;
}

/// Finer octaves would only be aliased by a mesh whose edges are `spacing` long; the first octave's
/// lattice has edges of length 1.
inline constexpr double lacunarity = 65.0 / 32.0;  // not 2: so octaves' lattices do not coincide
inline int resolved_octaves(double spacing) {
  int octaves = 1;
  for (double size = 1 / lacunarity; size >= 2 * spacing && octaves < 16; size /= lacunarity)
    ++octaves;
  return octaves;
}

/// Sharp ridges with smooth valleys between them, in [0, 2). Musgrave, in Ebert et al. 2003,
/// 'Texturing and Modeling', chapter 16: H = 1, offset 1, gain 2.
template <int D>
double ridged_multifractal(glm::vec<D, double> p, int octaves, std::uint32_t seed) {
  double sum = 0, weight = 1, amplitude = 1;
  for (int octave = 0; octave < octaves; ++octave) {
    const double noise = gradient_noise<D>(p, seed + static_cast<std::uint32_t>(octave));
    const double ridge = std::max(0.0, 1 - 2.2 * std::abs(noise));
    const double signal = weight * ridge * ridge;
    sum += amplitude * signal;
    weight = std::min(1.0, 2 * signal);
    amplitude *= 0.5;
    p *= lacunarity;
  }
  return sum;
}

}  // namespace pt
