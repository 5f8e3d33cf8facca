// Curves as tubes, and those that are flat with normals as ribbons.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/scene/load/pbrt/scene_parts.h"
#include "common/scene/load/pbrt/syntax/parameters.h"

namespace pt::pbrt {
namespace {

using Bezier = std::array<Vec3, 4>;

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

Vec3 position_on(const Bezier& b, float t) {
  const float s = 1.0f - t;
  return s * s * s * b[0] + 3.0f * s * s * t * b[1] + 3.0f * s * t * t * b[2] + t * t * t * b[3];
}

/// In proportion to the derivative.
Vec3 slope_on(const Bezier& b, float t) {
  const float s = 1.0f - t;
  return s * s * (b[1] - b[0]) + 2.0f * s * t * (b[2] - b[1]) + t * t * (b[3] - b[2]);
}

/// The segments of a curve of any degree and basis that pbrt has. Throws Error.
std::vector<Bezier> read_beziers(const Parameters& parameters) {
  const int degree = parameters.integer("degree", 3);
  const std::string basis = parameters.text("basis", "bezier");
  const std::vector<Vec3> p = parameters.points("P");
  if ((degree != 2 && degree != 3) || (basis != "bezier" && basis != "bspline")) {
    fail(parameters.place(), "curve: degree {}, basis '{}'; expected 2 or 3, and bezier or bspline",
         degree, basis);
  }
  const auto step = static_cast<std::size_t>(basis == "bezier" ? degree : 1);
  const auto own = static_cast<std::size_t>(degree) + 1;
  if (p.size() < own || (p.size() - own) % step != 0) {
    fail(parameters.place(), "curve: {} points in 'P'; expected {} and a multiple of {}", p.size(),
         own, step);
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

/// Points on the curve and what lies across it: two unit vectors, x and y.
struct CurveFrame {
  Vec3 position, along, x, y;
};

Vec3 unit_or(const Vec3& v, const Vec3& fallback) {
  const float length = glm::length(v);
  return length > 0.0f && std::isfinite(length) ? v / length : fallback;
}

/// x stays as near to what it was before as the curve allows, so that tubes are not twisted.
std::vector<CurveFrame> frames_of(const std::vector<Bezier>& segments) {
  std::vector<CurveFrame> frames;
  Vec3 along(0, 0, 1), x(0.0f);
  for (const Bezier& segment : segments) {
    for (int i = frames.empty() ? 0 : 1; i <= curve_steps; ++i) {
      const float t = static_cast<float>(i) / float{curve_steps};
      // Where points of it coincide, its ends tell where it goes.
      along = unit_or(slope_on(segment, t), unit_or(segment[3] - segment[0], along));
      const Vec3 aside = std::abs(along.x) < 0.6f ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
      x = unit_or(x - glm::dot(x, along) * along, glm::normalize(glm::cross(along, aside)));
      frames.push_back({position_on(segment, t), along, x, glm::cross(along, x)});
    }
  }
  return frames;
}

/// A polygon around the curve that is as wide, in the mean of all directions, as the circle.
SurfacePoint on_tube(const CurveFrame& frame, float width, float v) {
  const double half = double{pi} / curve_sides,
               angle = v >= 1.0f ? 0.0 : 2 * double{pi} * double{v};
  const auto radius = static_cast<float>(0.5 * double{width} * half / std::sin(half));
  const Vec3 normal =
      static_cast<float>(std::cos(angle)) * frame.x + static_cast<float>(std::sin(angle)) * frame.y;
  return {frame.position + radius * normal, normal};
}

/// Normals at the ends of the segments, turned as pbrt does it: by equal angles.
Vec3 ribbon_normal(const std::vector<Vec3>& normals, std::size_t column, const Vec3& along) {
  const std::size_t segment = std::min(column / curve_steps, normals.size() - 2);
  const float t = static_cast<float>(column - segment * curve_steps) / float{curve_steps};
  const Vec3 a = glm::normalize(normals[segment]), b = glm::normalize(normals[segment + 1]);
  const float angle = std::acos(glm::clamp(glm::dot(a, b), -1.0f, 1.0f)), sine = std::sin(angle);
  const Vec3 n = sine > 1e-4f ? (std::sin((1.0f - t) * angle) * a + std::sin(t * angle) * b) / sine
                              : (1.0f - t) * a + t * b;
  return unit_or(n - glm::dot(n, along) * along, n);
}

std::vector<Vec3> read_normals(Context& context, const Parameters& parameters,
                               std::size_t segments) {
  const std::string type = parameters.text("type", "flat");
  if (type == "flat") {
    context.reporter.warn_once(
        "flat curve", parameters.place(),
        "a curve that is flat and turns to its viewer is not supported: a tube is used");
  } else if (type != "ribbon" && type != "cylinder") {
    fail(parameters.place(), "curve '{}'; expected flat, ribbon or cylinder", type);
  }
  std::vector<Vec3> normals = parameters.points("N");
  if (type != "ribbon") return {};
  const bool is_short =
      std::ranges::any_of(normals, [](const Vec3& n) { return !(glm::length(n) > 0.0f); });
  if (normals.size() != segments + 1 || is_short) {
    fail(parameters.place(), "curve: {} normals; expected {} that are not 0", normals.size(),
         segments + 1);
  }
  return normals;
}

}  // namespace

/// u grows along the curve by 1 for each segment, v across it.
Mesh read_curve(Context& context, const Entity& entity, const ShapeMaterial&) {
  const Parameters& parameters = entity.parameters;
  const std::vector<Bezier> segments = read_beziers(parameters);
  const std::vector<Vec3> normals = read_normals(context, parameters, segments.size());
  const float both = parameters.number("width", 1.0f);
  const float first = parameters.number("width0", both), last = parameters.number("width1", both);
  if (!(first >= 0.0f && last >= 0.0f)) fail(parameters.place(), "curve: a width below 0");
  parameters.ignore({"splitdepth"});
  const std::vector<CurveFrame> frames = frames_of(segments);
  const int columns = static_cast<int>(frames.size()) - 1;
  Mesh mesh;
  tessellate(mesh, columns, normals.empty() ? curve_sides : 1, [&](float u, float v) {
    const auto column = static_cast<std::size_t>(std::lround(u * static_cast<float>(columns)));
    const CurveFrame& frame = frames[column];
    const float width = (1.0f - u) * first + u * last;
    if (normals.empty()) return on_tube(frame, width, v);
    const Vec3 normal = ribbon_normal(normals, column, frame.along);
    return SurfacePoint{frame.position + (v - 0.5f) * width * glm::cross(normal, frame.along),
                        normal};
  });
  for (Vec2& uv : mesh.uvs) uv.x *= static_cast<float>(segments.size());
  return mesh;
}

}  // namespace pt::pbrt
