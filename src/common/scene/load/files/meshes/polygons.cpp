#include "common/scene/load/files/meshes/polygons.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/concurrent_vector.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace pt {
namespace {

struct OutlinePoint {
  double x, y;
  bool operator==(const OutlinePoint&) const = default;
};

/// Twice the area of a triangle, positive where it is counterclockwise.
inline double doubled_area(const OutlinePoint& a, const OutlinePoint& b, const OutlinePoint& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Clips one ear after the other off a counterclockwise polygon: a corner whose triangle with its
/// neighbours is not turned over and contains no other corner. The areas of all triangles, with
/// their signs, always add up to the polygon's: so where none is turned over they cover it once.
class EarClipper {
 public:
  /// `points` outlive the clipper.
  explicit EarClipper(const std::vector<OutlinePoint>& points);

  /// False where that took more than 2^24 + steps_per_corner * corners steps.
  bool clip();

  static constexpr std::int64_t steps_per_corner = 1024;

  /// Corners, two fewer triangles than there are corners.
  const std::vector<std::array<std::size_t, 3>>& triangles() const { return triangles_; }
  /// The sum of their areas without signs.
  double doubled_area_of_all() const { return all_; }

 private:
  /// Which corners are clipped: those that no other corner touches; or that none lies inside of, as
  /// where a polygon touches itself or has corners on its edges; or any, where it crosses itself.
  enum class Rule { apart, touched, any };

  double key(std::size_t i) const { return along_y_ ? points_[i].y : points_[i].x; }
  double area_at(std::size_t i) const {
    return doubled_area(points_[before_[i]], points_[i], points_[after_[i]]);
  }
  bool is_reflex(std::size_t i) const { return !(area_at(i) > 0); }
  bool is_blocked(std::size_t ear, Rule rule);
  bool is_ear(std::size_t ear, Rule rule);
  std::size_t smallest(std::size_t any) const;
  void remove(std::size_t i);

  const std::vector<OutlinePoint>& points_;
  std::vector<std::size_t> before_, after_;  ///< a ring of the corners that are left
  std::vector<char> is_left_;
  std::vector<std::size_t> reflex_;  ///< sorted by key(); may hold others that were reflex
  std::vector<std::array<std::size_t, 3>> triangles_;
  std::int64_t steps_ = 0;  ///< that may still be taken
  std::size_t removed_ = 0;
  double all_ = 0;
  bool along_y_ = false;
};

}  // namespace

EarClipper::EarClipper(const std::vector<OutlinePoint>& points)
    : points_(points),
      before_(points.size()),
      after_(points.size()),
      is_left_(points.size(), 1),
      steps_((std::int64_t{1} << 24) +
             steps_per_corner * static_cast<std::int64_t>(points.size())) {
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) before_[i] = (i + n - 1) % n, after_[i] = (i + 1) % n;
  const auto [left, right] = std::ranges::minmax_element(points, {}, &OutlinePoint::x);
  const auto [foot, head] = std::ranges::minmax_element(points, {}, &OutlinePoint::y);
  along_y_ = head->y - foot->y > right->x - left->x;
  for (std::size_t i = 0; i < n; ++i) {
    if (is_reflex(i)) reflex_.push_back(i);
  }
  std::ranges::sort(reflex_, {}, [&](std::size_t i) { return key(i); });
}

bool EarClipper::clip() {
  std::size_t corner = 0, failures = 0;
  Rule rule = Rule::apart;
  for (std::size_t left = points_.size(); left > 2;) {
    if (steps_ < 0) return false;
    if (rule == Rule::any) {
      corner = smallest(corner);
      steps_ -= static_cast<std::int64_t>(left);
    } else if (!is_ear(corner, rule)) {
      corner = after_[corner];
      if (++failures < left) continue;
      rule = rule == Rule::apart ? Rule::touched : Rule::any;
      failures = 0;
      continue;
    }
    triangles_.push_back({before_[corner], corner, after_[corner]});
    all_ += std::abs(area_at(corner));
    const std::size_t next = after_[corner];
    remove(corner);
    corner = after_[next];  // every second one: fewer slivers
    --left, failures = 0, rule = Rule::apart;
  }
  return true;
}

bool EarClipper::is_blocked(std::size_t ear, Rule rule) {
  const std::size_t corners[] = {before_[ear], ear, after_[ear]};
  const OutlinePoint &a = points_[corners[0]], &b = points_[ear], &c = points_[corners[2]];
  const double low = std::min({key(corners[0]), key(ear), key(corners[2])});
  const double high = std::max({key(corners[0]), key(ear), key(corners[2])});
  const auto blocks = [&](std::size_t i) {
    const OutlinePoint& p = points_[i];
    if (!is_left_[i] || p == a || p == b || p == c || !is_reflex(i)) return false;
    const double least =
        std::min({doubled_area(a, b, p), doubled_area(b, c, p), doubled_area(c, a, p)});
    return rule == Rule::apart ? least >= 0 : least > 0;
  };
  auto next = std::ranges::lower_bound(reflex_, low, {}, [&](std::size_t i) { return key(i); });
  for (; next != reflex_.end() && key(*next) <= high; ++next, --steps_) {
    if (blocks(*next)) return true;
  }
  return false;
}

/// A corner without an area is the tip of a spike, clipped at once, or lies on an edge: it is
/// clipped where no other is.
bool EarClipper::is_ear(std::size_t ear, Rule rule) {
  --steps_;
  const double area = area_at(ear);
  if (area > 0) return !is_blocked(ear, rule);
  const OutlinePoint &a = points_[before_[ear]], &b = points_[ear], &c = points_[after_[ear]];
  const bool is_spike = (a.x - b.x) * (c.x - b.x) + (a.y - b.y) * (c.y - b.y) >= 0;
  return area == 0 && (is_spike || rule == Rule::touched);
}

/// The corner that is left and has the least area.
std::size_t EarClipper::smallest(std::size_t any) const {
  std::size_t best = any;
  for (std::size_t i = after_[any]; i != any; i = after_[i]) {
    if (std::abs(area_at(i)) < std::abs(area_at(best))) best = i;
  }
  return best;
}

void EarClipper::remove(std::size_t i) {
  after_[before_[i]] = after_[i], before_[after_[i]] = before_[i];
  is_left_[i] = 0;
  if (++removed_ <= reflex_.size() / 2) return;
  std::erase_if(reflex_, [&](std::size_t r) { return !is_left_[r] || !is_reflex(r); });
  removed_ = 0;
}

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
