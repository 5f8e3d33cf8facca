#include "common/scene/load/files/meshes/ear_clipper.h"

#include <algorithm>
#include <cmath>

namespace pt {

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

}  // namespace pt
