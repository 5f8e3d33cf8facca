#include "common/scene/load/files/meshes/polygons.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/concurrent_vector.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "common/scene/load/files/meshes/ear_clipper.h"

namespace pt {
namespace {

using DVec3 = glm::dvec3;

DVec3 position(const Mesh& mesh, std::uint32_t vertex) { return DVec3(mesh.positions[vertex]); }

/// The triangles of a face.
struct Fan {
  const TriangleIndices* triangles;
  std::uint64_t count;

  std::uint32_t corner(std::uint64_t i) const {
    return i < 2 ? triangles[0].v[i] : triangles[i - 2].v[2];
  }
  std::uint64_t corners() const { return count + 2; }
};

/// Twice the area of a triangle of the mesh, along its normal.
DVec3 doubled_area(const Mesh& mesh, const TriangleIndices& triangle) {
  const DVec3 origin = position(mesh, triangle.v[0]);
  return glm::cross(position(mesh, triangle.v[1]) - origin, position(mesh, triangle.v[2]) - origin);
}

/// Newell's normal of a face, as long as twice its area.
DVec3 normal_of(const Mesh& mesh, const Fan& fan) {
  DVec3 normal(0.0);
  for (std::uint64_t i = 0; i < fan.count; ++i) normal += doubled_area(mesh, fan.triangles[i]);
  return normal;
}

/// Whether the triangles cover the face once, but for what the rounding of positions explains: as
/// seen along its normal none is turned over, since the areas of all add up to the face's.
bool covers_once(const Mesh& mesh, const Fan& fan) {
  const DVec3 normal = normal_of(mesh, fan);
  const double area = glm::length(normal);
  double all = 0;
  for (std::uint64_t i = 0; i < fan.count; ++i) {
    all += std::abs(glm::dot(doubled_area(mesh, fan.triangles[i]), normal));
  }
  if (!(all > area * area * (1.0 + 1e-9))) return true;
  double largest = 0, perimeter = 0;
  for (std::uint64_t i = 0; i < fan.corners(); ++i) {
    const DVec3 here = position(mesh, fan.corner(i));
    perimeter += glm::distance(here, position(mesh, fan.corner((i + 1) % fan.corners())));
    largest = std::max({largest, std::abs(here.x), std::abs(here.y), std::abs(here.z)});
  }
  return all / area - area <= 8.0 * 0x1p-24 * largest * perimeter;
}

/// The corners as seen along the normal, counterclockwise: along it onto the plane of the two axes
/// that it is farthest from, so that positions in such a plane are not rounded.
std::vector<OutlinePoint> outline_of(const Mesh& mesh, const Fan& fan) {
  const DVec3 normal = normal_of(mesh, fan);
  int up = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (std::abs(normal[axis]) > std::abs(normal[up])) up = axis;
  }
  const int x = (up + 1) % 3, y = (up + 2) % 3;
  std::vector<OutlinePoint> points;
  points.reserve(fan.corners());
  for (std::uint64_t i = 0; i < fan.corners(); ++i) {
    const DVec3 p = position(mesh, fan.corner(i));
    const double right = p[x] - normal[x] / normal[up] * p[up];
    const double ahead = p[y] - normal[y] / normal[up] * p[up];
    points.push_back(normal[up] < 0 ? OutlinePoint{ahead, right} : OutlinePoint{right, ahead});
  }
  return points;
}

/// False where the face is too large. Its triangles stay where others do not cover it better.
bool cut(const Mesh& mesh, TriangleIndices* triangles, std::uint64_t count) {
  const Fan fan{triangles, count};
  const std::vector<OutlinePoint> outline = outline_of(mesh, fan);
  double all = 0;
  for (std::size_t i = 2; i < outline.size(); ++i) {
    all += std::abs(doubled_area(outline[0], outline[i - 1], outline[i]));
  }
  EarClipper clipper(outline);
  const bool is_done = clipper.clip();
  if (!is_done || clipper.doubled_area_of_all() >= all) return is_done;
  std::vector<TriangleIndices> ears;
  ears.reserve(count);
  for (const auto& [a, b, c] : clipper.triangles()) {
    ears.push_back({{fan.corner(a), fan.corner(b), fan.corner(c)}});
  }
  std::ranges::copy(ears, triangles);
  return true;
}

}  // namespace

void PolygonFans::add(std::uint64_t triangles) {
  if (triangles > 1) fans_.push_back({next_, triangles});
  next_ += triangles;
}

void PolygonFans::add_equal(std::uint64_t faces, std::uint64_t triangles) {
  equal_ = {next_, triangles}, equals_ = triangles > 1 ? faces : 0;
  next_ += faces * triangles;
}

void PolygonFans::cut_concave(Mesh& mesh, std::vector<std::string>* warnings) const {
  const auto fan_at = [&](std::size_t i) {
    const std::uint64_t nth = i - fans_.size();  // used where i is behind them
    return i < fans_.size() ? fans_[i]
                            : Place{equal_.first + nth * equal_.triangles, equal_.triangles};
  };
  tbb::concurrent_vector<std::uint64_t> too_large;
  using Range = tbb::blocked_range<std::size_t>;
  tbb::parallel_for(Range(0, fans_.size() + equals_, 1024), [&](const Range& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Place place = fan_at(i);
      TriangleIndices* const first = mesh.triangles.data() + place.first;
      if (covers_once(mesh, {first, place.triangles})) continue;
      if (!cut(mesh, first, place.triangles)) too_large.push_back(place.triangles + 2);
    }
  });
  if (warnings == nullptr || too_large.empty()) return;
  warnings->push_back(fmt::format(
      "{} concave faces with up to {} corners are too intricate to be cut into triangles: fans are "
      "used; expected that comparing each corner with the {} around it is enough",
      too_large.size(), std::ranges::max(too_large), EarClipper::steps_per_corner));
}

}  // namespace pt
