#include "common/scene/load/pbrt/shapes/bezier.h"

#include <fmt/format.h>

namespace pt::pbrt {
namespace {

Vec3 between(const Vec3& a, const Vec3& b, float t) { return (1.0f - t) * a + t * b; }

Bezier elevated(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {a, between(a, b, 2.0f / 3.0f), between(c, b, 2.0f / 3.0f), c};
}

/// A span of a uniform B-spline; p points to its degree + 1 control points.
Bezier of_spline(const Vec3* p, int degree) {
  if (degree == 2) return elevated(between(p[0], p[1], 0.5f), p[1], between(p[1], p[2], 0.5f));
  const Vec3 left = between(p[1], p[2], 1.0f / 3.0f), right = between(p[1], p[2], 2.0f / 3.0f);
  return {between(between(p[0], p[1], 2.0f / 3.0f), left, 0.5f), left, right,
          between(right, between(p[2], p[3], 1.0f / 3.0f), 0.5f)};
}

}  // namespace

Vec3 position_on(const Bezier& b, float t) {
  const float s = 1.0f - t;
  return s * s * s * b[0] + 3.0f * s * s * t * b[1] + 3.0f * s * t * t * b[2] + t * t * t * b[3];
}

Vec3 slope_on(const Bezier& b, float t) {
  const float s = 1.0f - t;
  return s * s * (b[1] - b[0]) + 2.0f * s * t * (b[2] - b[1]) + t * t * (b[3] - b[2]);
}

std::vector<Bezier> read_beziers(const Parameters& parameters) {
  const int degree = parameters.integer("degree", 3);
  const std::string basis = parameters.text("basis", "bezier");
  const std::vector<Vec3> p = parameters.points("P");
  if ((degree != 2 && degree != 3) || (basis != "bezier" && basis != "bspline")) {
    fail(parameters.place(), fmt::format("curve: degree {}, basis '{}'; expected 2 or 3, and "
                                         "bezier or bspline",
                                         degree, basis));
  }
  const auto step = static_cast<std::size_t>(basis == "bezier" ? degree : 1);
  const auto own = static_cast<std::size_t>(degree) + 1;
  if (p.size() < own || (p.size() - own) % step != 0) {
    fail(parameters.place(),
         fmt::format("curve: {} points in 'P'; expected {} and a multiple of {}", p.size(), own,
                     step));
  }
  std::vector<Bezier> segments;
  for (std::size_t i = 0; i + own <= p.size(); i += step) {
    if (basis == "bspline") {
      segments.push_back(of_spline(&p[i], degree));
    } else if (degree == 2) {
      segments.push_back(elevated(p[i], p[i + 1], p[i + 2]));
    } else {
      segments.push_back({p[i], p[i + 1], p[i + 2], p[i + 3]});
    }
  }
  return segments;
}

}  // namespace pt::pbrt
