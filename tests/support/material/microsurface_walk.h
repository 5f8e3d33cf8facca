// Light on a rough conductor, facet by facet: a random walk on a Smith microsurface of GGX facets
// (Heitz, Hanika, d'Eon and Dachsbacher 2016, 'Multiple-Scattering Microfacet BSDFs with the Smith
// Model'), in double precision. Shares nothing with src/common/material.
#pragma once

#include <cmath>
#include <random>

#include "statistics.h"

namespace pt {

class MicrosurfaceWalk {
 public:
  explicit MicrosurfaceWalk(double alpha) : alpha_(alpha) {}

  struct Result {
    glm::dvec3 once{0.0}, all{0.0};  ///< what leaves after one facet, and after any number
  };

  /// The mean over so many walks of light that comes along -wo; `reflectance(cosine)` is a facet's.
  template <class Reflectance>
  Result albedo(const glm::dvec3& wo, const Reflectance& reflectance, int walks) {
    Result sum;
    for (int i = 0; i < walks; ++i) {
      glm::dvec3 direction = -wo, weight(1.0);
      double below = 1;  // part of the surface that lies below the walk
      for (int facets = 0; facets < 1000; ++facets) {
        if (!descend(direction, below)) {
          if (facets == 1) sum.once += weight;
          sum.all += weight;
          break;
        }
        const glm::dvec3 m = visible_normal(-direction);
        const double cosine = -glm::dot(direction, m);
        weight *= reflectance(cosine);
        direction = glm::normalize(direction + 2 * cosine * m);
      }
    }
    sum.once /= walks, sum.all /= walks;
    return sum;
  }

  /// Smith's function of a direction, which may point down: then it is below -1.
  double lambda(const glm::dvec3& w) const {
    const double slopes = alpha_ * alpha_ * (w.x * w.x + w.y * w.y) / (w.z * w.z);
    return 0.5 * (-1 + std::copysign(std::sqrt(1 + slopes), w.z));
  }

 private:
  double unit() { return std::uniform_real_distribution<double>()(random_); }

  /// Goes on to the next facet, or out: false. Going up from `below` the part below^lambda gets
  /// out.
  bool descend(const glm::dvec3& w, double& below) {
    const double u = 1 - unit(), power = lambda(w);
    if (w.z > 0 && u <= std::pow(below, power)) return false;
    if (power != 0) below = std::clamp(below * std::pow(u, -1 / power), 1e-300, 1.0);
    return true;
  }

  /// By the projected area that w sees: a disk that w sees as half a circle is bent to a hemisphere
  /// and stretched (Walter et al. 2015, in the form that holds below the horizon as well: reject
  /// facets of the whole, unit hemisphere).
  glm::dvec3 visible_normal(const glm::dvec3& w) {
    const glm::dvec3 v = glm::normalize(glm::dvec3(alpha_ * w.x, alpha_ * w.y, w.z));
    const glm::dvec3 side = std::abs(v.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(side, v)), y = glm::cross(v, x);
    for (;;) {  // a point of the disk across v, raised to the half ball that v sees
      const double r = std::sqrt(unit()), phi = 2 * pi_double * unit();
      const glm::dvec3 n = r * std::cos(phi) * x + r * std::sin(phi) * y + std::sqrt(1 - r * r) * v;
      if (n.z <= 0) continue;
      return glm::normalize(glm::dvec3(alpha_ * n.x, alpha_ * n.y, n.z));
    }
  }

  double alpha_;
  std::mt19937_64 random_{1};
};

}  // namespace pt
