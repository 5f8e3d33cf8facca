// Triangles of a polygon in the plane.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace pt {

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

}  // namespace pt
