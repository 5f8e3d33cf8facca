// What a point of a floor gets from all lights at once, by summing over directions in double
// precision: an oracle that knows no light sampling, no tree and no instance.
#pragma once

#include <functional>
#include <vector>

#include "common/scene/data/scene_data.h"
#include "statistics.h"

namespace pt {

/// A triangle of a lamp as it lies in the world, shining to the side of cross(v1 - v0, v2 - v0).
struct LampTriangle {
  glm::dvec3 v[3];
  std::function<glm::dvec3(double b1, double b2)> radiance;  ///< at b0 v0 + b1 v1 + b2 v2
};

struct LampSphere {
  glm::dvec3 center;
  double radius;
  glm::dvec3 radiance;
};

struct LightsAround {
  std::vector<LampTriangle> triangles;
  std::vector<LampSphere> spheres;
  std::function<glm::dvec3(const glm::dvec3& direction)> environment;  ///< or empty
};

/// Distance to a triangle and where (Cramer's rule), if the ray from the origin meets it.
inline bool meets(const LampTriangle& lamp, const glm::dvec3& d, double& t, double& b1,
                  double& b2) {
  const glm::dvec3 e1 = lamp.v[1] - lamp.v[0], e2 = lamp.v[2] - lamp.v[0], to = -lamp.v[0];
  const double determinant = -glm::dot(d, glm::cross(e1, e2));
  if (determinant == 0) return false;
  t = glm::dot(to, glm::cross(e1, e2)) / determinant;
  b1 = glm::dot(e2, glm::cross(to, d)) / determinant;
  b2 = -glm::dot(e1, glm::cross(to, d)) / determinant;
  return t > 0 && b1 >= 0 && b2 >= 0 && b1 + b2 <= 1;
}

/// Radiance that arrives at the origin from direction `d`, of unit length.
inline glm::dvec3 arriving(const LightsAround& lights, const glm::dvec3& d) {
  double nearest = 1e300, t = 0, b1 = 0, b2 = 0;
  glm::dvec3 radiance = lights.environment ? lights.environment(d) : glm::dvec3(0);
  for (const LampTriangle& lamp : lights.triangles) {
    if (!meets(lamp, d, t, b1, b2) || t >= nearest) continue;
    nearest = t;
    const glm::dvec3 normal = glm::cross(lamp.v[1] - lamp.v[0], lamp.v[2] - lamp.v[0]);
    radiance = glm::dot(normal, d) < 0 ? lamp.radiance(b1, b2) : glm::dvec3(0);
  }
  for (const LampSphere& lamp : lights.spheres) {
    const double b = glm::dot(d, lamp.center);
    const double c = glm::dot(lamp.center, lamp.center) - lamp.radius * lamp.radius;
    if (b <= 0 || b * b < c || b - std::sqrt(b * b - c) >= nearest) continue;
    nearest = b - std::sqrt(b * b - c);
    radiance = lamp.radiance;
  }
  return radiance;
}

/// The irradiance of a floor, whose normal is +y, at the origin. The square grid becomes a disk of
/// cosine-weighted directions (Malley's method), so that all points count alike.
inline glm::dvec3 floor_irradiance(const LightsAround& lights, int steps = 700) {
  glm::dvec3 sum(0);
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      const double r2 = (i + 0.5) / steps, phi = 2 * pi_double * (j + 0.5) / steps;
      const double r = std::sqrt(r2);
      sum += arriving(lights, {r * std::cos(phi), std::sqrt(1 - r2), r * std::sin(phi)});
    }
  }
  return pi_double / (static_cast<double>(steps) * steps) * sum;
}

}  // namespace pt
