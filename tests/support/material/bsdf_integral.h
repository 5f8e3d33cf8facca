// What a BSDF does with light from one direction, by quadrature of evaluate() over the sphere and,
// for discrete directions, by sample() with evenly spread numbers.
#pragma once

#include "material/each_bsdf.h"

namespace pt {

class BsdfIntegral {
 public:
  static constexpr std::size_t cells = 2 * PolarGrid::cells;  // of both sides

  template <class Bsdf>
  BsdfIntegral(const Bsdf& bsdf, const Vec3& wo) : wo_(wo), grids_{peaks(bsdf, wo)} {
    if (bsdf.is_delta()) return;
    for (const bool through : {false, true}) {
      grids_[through].for_each_point([&](std::size_t cell, const Vec3& wi, double angle) {
        if (through == same_side(wo, wi)) return;
        const BsdfValue value = bsdf.evaluate(wo, wi);
        density_[through * PolarGrid::cells + cell] += angle * static_cast<double>(value.pdf);
        albedo_ += angle * (through ? eta_ * eta_ : 1.0) * Vec3d(value.f);
      });
    }
  }

  std::size_t cell(const Vec3& wi) const {
    const bool through = !same_side(wo_, wi);
    return through * PolarGrid::cells + grids_[through].cell(wi);
  }

  const std::vector<double>& density() const { return density_; }  ///< by cell
  double total_density() const {
    double sum = 0;
    for (const double d : density_) sum += d;
    return sum;
  }

  /// What of the light leaves again, in energy: what is refracted is not condensed.
  Vec3d albedo() const { return albedo_ + discrete_; }

  // By sample().
  Vec3d sampled_albedo() const { return sampled_; }
  double sampled_error() const {  ///< four standard deviations, were the numbers random
    return 4 * std::sqrt(std::max(0.0, squares_ - glm::dot(sampled_, sampled_)) / count);
  }
  double discrete_part() const { return discrete_part_; }  ///< of the samples
  double absorbed_part() const { return absorbed_part_; }

 private:
  static constexpr int count = 1 << 15;

  /// The directions of the highest densities on each side; notes what sample() says.
  template <class Bsdf>
  std::array<PolarGrid, 2> peaks(const Bsdf& bsdf, const Vec3& wo) {
    eta_ = passing_eta(bsdf, wo).value_or(1.0);
    Vec3 poles[2] = {mirrored(wo), -wo};
    float densities[2] = {0, 0};
    for (int i = 0; i < count; ++i) {
      const BsdfSample s = bsdf.sample(wo, even_numbers(i));
      if (is_black(s.weight) && s.pdf == 0.0f) {
        absorbed_part_ += 1.0 / count;
        continue;
      }
      const bool through = !same_side(wo, s.wi);
      const double eta = static_cast<double>(s.eta);
      const Vec3d energy = Vec3d(s.weight) * eta * eta / static_cast<double>(count);
      sampled_ += energy;
      squares_ += glm::dot(energy, energy) * count;
      if (s.is_delta()) {
        discrete_ += energy;
        discrete_part_ += 1.0 / count;
      } else if (s.pdf > densities[through]) {
        densities[through] = s.pdf, poles[through] = s.wi;
      }
    }
    constexpr float narrow = 50.0f;
    return {PolarGrid(poles[0], densities[0] > narrow), PolarGrid(poles[1], densities[1] > narrow)};
  }

  Vec3 wo_;
  double eta_ = 1, discrete_part_ = 0, absorbed_part_ = 0, squares_ = 0;
  Vec3d albedo_{0.0}, discrete_{0.0}, sampled_{0.0};
  std::vector<double> density_ = std::vector<double>(cells);
  std::array<PolarGrid, 2> grids_;
};

}  // namespace pt
