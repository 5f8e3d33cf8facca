// How full warps are, counted by the code that they run: at chosen points, how many lanes are there
// together. Only in a build with PTEXP_DIVERGENCE (docs/statistics.md); in others a LaneCounter has
// no members and no code.
#pragma once

#include <iterator>
#include <string_view>

#include "common/platform/platform.h"

namespace pt {

// PT_LANE_COUNTER: the member `lanes` of a structure that carries a counter.
#ifdef PTEXP_DIVERGENCE
inline constexpr bool counts_lanes = true;
#define PT_LANE_COUNTER LaneCounter lanes = {}
#else
inline constexpr bool counts_lanes = false;
#define PT_LANE_COUNTER
#endif

// The points, in the order in which a path passes them: name, what the lanes do there.
#define PT_LANE_POINTS(POINT)                                              \
  POINT(iteration, "have a path in an iteration of the megakernel's loop") \
  POINT(generate, "begin a path")                                          \
  POINT(bounce, "trace and shade a ray in one kernel")                     \
  POINT(finish, "follow one of a batch's last paths to its end")           \
  POINT(intersect, "begin to trace a ray")                                 \
  POINT(node, "visit a node")                                              \
  POINT(primitive, "test a primitive, or the triangles of a leaf")         \
  POINT(flight, "sample a collision in a grid, null or not")               \
  POINT(route_hits, "send a path to the stage that shades it")             \
  POINT(shade_miss, "shade a ray that left the scene")                     \
  POINT(shade_surface, "shade a surface")                                  \
  POINT(shade_medium, "shade a collision in a medium")                     \
  POINT(light, "sample a light")                                           \
  POINT(bsdf, "evaluate and sample the same BSDF")                         \
  POINT(shadow, "begin to trace a shadow ray")                             \
  POINT(shadow_node, "visit a node for shadow rays")                       \
  POINT(shadow_primitive, "test a primitive, or a leaf, for shadow rays")  \
  POINT(shadow_flight, "estimate a grid's transmittance")

#define PT_LANE_POINT_ENUMERATOR(name, meaning) name,
enum class LanePoint : std::uint8_t { PT_LANE_POINTS(PT_LANE_POINT_ENUMERATOR) };
#undef PT_LANE_POINT_ENUMERATOR

struct LanePointInfo {
  std::string_view name, meaning;
};

#define PT_LANE_POINT_ROW(name, meaning) {#name, meaning},
inline constexpr LanePointInfo lane_points[] = {PT_LANE_POINTS(PT_LANE_POINT_ROW)};
#undef PT_LANE_POINT_ROW
#undef PT_LANE_POINTS
inline constexpr int lane_point_count = static_cast<int>(std::size(lane_points));

/// Bounces that are counted apart; the last one's counts are those of all from there on.
inline constexpr int lane_bounces = 64;

/// In the device's memory.
struct LaneCounts {
  /// [LanePoint][bounce][n - 1]: how often n lanes of a warp were there together.
  std::uint64_t groups[lane_point_count][lane_bounces][32];
};

/// Counts the lanes that are somewhere on behalf of a ray. A ray's bounce is the number of rays
/// that its path had traced before it: 0 for the camera ray. Lanes that are somewhere together
/// count for the bounce of the first of them.
template <bool counts>
class LaneCounterIf {
 public:
  LaneCounterIf() = default;  ///< counts nothing
  explicit LaneCounterIf(LaneCounts* all) : counts_(all) {}

  /// For rays of this bounce.
  PT_HD LaneCounterIf at(std::uint32_t bounce) const {
    LaneCounterIf result = *this;
    result.bounce_ = static_cast<std::uint8_t>(bounce < lane_bounces ? bounce : lane_bounces - 1);
    return result;
  }

  /// For the shadow ray cast where such a ray ended: of tracing it, points of its own count.
  PT_HD LaneCounterIf of_shadow_ray() const {
    LaneCounterIf result = *this;
    result.is_shadow_ = true;
    return result;
  }

  PT_HD void count(LanePoint point) const {
    if (counts_ == nullptr) return;
    if (is_shadow_) point = shadow_point(point);
    count_active_lanes(counts_->groups[static_cast<int>(point)][bounce_]);
  }

 private:
  PT_HD static LanePoint shadow_point(LanePoint point) {
    if (point == LanePoint::intersect) return LanePoint::shadow;
    if (point == LanePoint::node) return LanePoint::shadow_node;
    if (point == LanePoint::primitive) return LanePoint::shadow_primitive;
    if (point == LanePoint::flight) return LanePoint::shadow_flight;
    return point;
  }

  LaneCounts* counts_ = nullptr;
  std::uint8_t bounce_ = 0;
  bool is_shadow_ = false;
};

template <>
class LaneCounterIf<false> {
 public:
  LaneCounterIf() = default;
  explicit LaneCounterIf(LaneCounts*) {}
  PT_HD LaneCounterIf at(std::uint32_t) const { return {}; }
  PT_HD LaneCounterIf of_shadow_ray() const { return {}; }
  PT_HD void count(LanePoint) const {}
};

using LaneCounter = LaneCounterIf<counts_lanes>;

/// The counter that `owner` carries.
template <class Owner>
PT_HD LaneCounter lanes_of([[maybe_unused]] const Owner& owner) {
  if constexpr (counts_lanes) {
    return owner.lanes;
  } else {
    return {};
  }
}

template <class Owner>
PT_HD void set_lanes([[maybe_unused]] Owner& owner, [[maybe_unused]] const LaneCounter& lanes) {
  if constexpr (counts_lanes) owner.lanes = lanes;
}

}  // namespace pt
