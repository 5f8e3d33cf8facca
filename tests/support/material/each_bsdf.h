// What generic tests of BSDFs share: the cases, directions, and integrals over the sphere.
#pragma once

#include <array>
#include <optional>

#include "material/bsdf_cases.h"
#include "statistics.h"

namespace pt {

using Vec3d = glm::dvec3;

/// From the normal to grazing, on both sides of the surface.
inline constexpr std::array<double, 7> test_cosines = {1.0, 0.7, 0.2, 0.02, -0.02, -0.4, -1.0};

inline Vec3 direction_of(double cosine) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return {0.6 * sine, -0.8 * sine, cosine};
}

/// Calls test(case, bsdf, wo) for every case, or those that quadrature can see, and direction.
template <class Test>
void for_each_bsdf(const Test& test, bool with_sharp = false) {
  for (const BsdfCase& one : all_bsdf_cases()) {
    if (one.is_sharp && !with_sharp) continue;
    SCOPED_TRACE(one.name);
    for (const double cosine : test_cosines) {
      SCOPED_TRACE(testing::Message() << "cos(wo) = " << cosine);
      const Vec3 wo = direction_of(cosine);
      visit(one.material.kind, one.material, [&](const auto& bsdf) { test(one, bsdf, wo); });
    }
  }
}

inline Vec3 random_numbers(TestRandom& random) {
  return {random.unit(), random.unit(), random.unit()};
}

/// Point i of a sequence that fills [0, 1)^3 evenly (Roberts 2018, the R3 sequence).
inline Vec3 even_numbers(int i) {
  const auto part = [&](double step) {
    const double x = 0.5 + step * i;
    return std::min(static_cast<float>(x - std::floor(x)), one_minus_ulp);
  };
  return {part(0.8191725133961645), part(0.6710436067037893), part(0.5497004779019703)};
}

/// The index of refraction on the other side over that on this one, where light gets there.
template <class Bsdf>
std::optional<double> passing_eta(const Bsdf& bsdf, const Vec3& wo) {
  for (int i = 0; i < 4096; ++i) {
    const BsdfSample s = bsdf.sample(wo, even_numbers(i));
    if (!is_black(s.weight) && !same_side(wo, s.wi)) return static_cast<double>(s.eta);
  }
  return {};
}

/// A grid of cells around a pole, finer near it.
class PolarGrid {
 public:
  static constexpr int rings = 20, sectors = 20, cells = rings * sectors;

  /// `is_narrow`: with more points near the pole, for a narrow lobe that the horizon cuts.
  explicit PolarGrid(const Vec3& pole, bool is_narrow = false)
      : pole_(glm::normalize(Vec3d(pole))), is_narrow_(is_narrow) {
    x_ = glm::cross(std::abs(pole_.x) > 0.5 ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0), pole_);
    x_ = glm::normalize(x_);
    y_ = glm::cross(pole_, x_);
  }

  std::size_t cell(const Vec3& wi) const {
    const Vec3d w(wi);
    const double theta = std::acos(std::clamp(glm::dot(w, pole_), -1.0, 1.0));
    const double phi = std::atan2(glm::dot(w, y_), glm::dot(w, x_));
    return sectors * cell_of(std::sqrt(theta / pi_double), rings) +
           cell_of(phi / (2 * pi_double) + 0.5, sectors);
  }

  /// Calls f(cell, direction, solid angle) for points all over the sphere.
  template <class F>
  void for_each_point(const F& f) const {
    for (int ring = 0; ring < rings; ++ring) {
      const int fineness = is_narrow_ && ring < 5 ? 4 : 1;
      const int steps = 24 * fineness, turns = 8 * fineness;  // per cell
      for (int i = 0; i < steps; ++i) {
        const double s = (ring + (i + 0.5) / steps) / rings, theta = pi_double * s * s;
        const double angle = std::sin(theta) * 2 * pi_double * s / (rings * steps) * 2 * pi_double /
                             (sectors * turns);
        for (int k = 0; k < sectors * turns; ++k) {
          const double phi = ((k + 0.5) / (sectors * turns) - 0.5) * 2 * pi_double;
          const Vec3d w =
              std::cos(theta) * pole_ + std::sin(theta) * (std::cos(phi) * x_ + std::sin(phi) * y_);
          f(static_cast<std::size_t>(ring * sectors + k / turns), Vec3(w), angle);
        }
      }
    }
  }

 private:
  Vec3d pole_, x_, y_;
  bool is_narrow_;
};

}  // namespace pt
