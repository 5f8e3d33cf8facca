// Walks along rays through the cells of a grid's majorants.
#pragma once

#include "common/medium/volume_grid.h"

namespace pt {

/// The end of a walk.
struct MajorantWalk {
  float t;         ///< distance from the ray's origin
  float depth;     ///< integral of the majorants over the distance walked
  float majorant;  ///< of the last cell
  bool arrives;    ///< at `t_max`, before the integral reached the given depth
};

/// Walks along one ray from cell to cell (Amanatides and Woo 1987, 'A fast voxel traversal
/// algorithm for ray tracing'; pbrt-v4, section 11.4.2). A walk ends where the integral of the
/// majorants over the distance reaches a given depth, or at the end of the ray. It can pause
/// between any two steps.
class CellWalk {
 public:
  enum class State { idle, walks, reaches_depth, arrives };

  CellWalk() = default;

  /// Walks along a ray to `t_max`; if that is infinite, only in the grid's cube.
  PT_HD CellWalk(const VolumeGrid& grid, const Ray& ray, float t_max) : last_(t_max) {
    const Vec3 size(static_cast<float>(grid.cells[0]), static_cast<float>(grid.cells[1]),
                    static_cast<float>(grid.cells[2]));
    origin_ = grid.to_unit.point(ray.origin) * size;
    direction_ = grid.to_unit.vector(ray.direction) * size;
    const auto inverse_of = [](float d) { return fabsf(d) > 1e-20f ? divide(1.0f, d) : 0.0f; };
    inverse_ = {inverse_of(direction_.x), inverse_of(direction_.y), inverse_of(direction_.z)};
    if (grid.ends == 0 && t_max < infinite_distance) return;
    const auto clip = [&](float from, float inverse_way, float length) {
      const float a = -from * inverse_way;
      const float b = (length - from) * inverse_way;
      const bool is_beside = inverse_way == 0.0f && !(from >= 0.0f && from <= length);
      if (inverse_way != 0.0f)
        first_ = fmaxf(first_, fminf(a, b)), last_ = fminf(last_, fmaxf(a, b));
      if (is_beside) last_ = 0.0f;
    };
    clip(origin_.x, inverse_.x, size.x), clip(origin_.y, inverse_.y, size.y);
    clip(origin_.z, inverse_.z, size.z);
  }

  /// Starts at a distance of `t`.
  PT_HD State begin(const VolumeGrid& grid, float t, float depth_goal) {
    t_ = fmaxf(t, first_), depth_ = 0.0f, depth_goal_ = depth_goal, majorant_ = 0.0f;
    if (!(t_ < last_)) return State::arrives;
    const Vec3 at = add_scaled(origin_, t_, direction_);
    x_ = detail::clamp_voxel(floorf(at.x), grid.cells[0]);
    y_ = detail::clamp_voxel(floorf(at.y), grid.cells[1]);
    z_ = detail::clamp_voxel(floorf(at.z), grid.cells[2]);
    end_ = {end_of(x_, grid.cells[0], origin_.x, inverse_.x),
            end_of(y_, grid.cells[1], origin_.y, inverse_.y),
            end_of(z_, grid.cells[2], origin_.z, inverse_.z)};
    return State::walks;
  }

  /// Goes through the present cell or, if it is empty, with those around it. `has_sparse`: the
  /// scene has sparse grids, and so distances in empty cells; see sample_grid().
  template <bool has_sparse = false>
  PT_HD State step(const VolumeGrids& grids, const VolumeGrid& grid) {
    const float cell_end = fmaxf(fminf(fminf(end_.x, end_.y), fminf(end_.z, last_)), t_);
    majorant_ = grids.majorants[grid.first_cell + x_ + grid.cells[0] * (y_ + grid.cells[1] * z_)];
    if constexpr (has_sparse || !runs_on_gpu) {
      if (majorant_ < 0.0f) {
        const auto reach = static_cast<std::uint32_t>(-majorant_) - 1;
        majorant_ = 0.0f;
        return jump(grid, reach);
      }
    }
    const float deeper = fused_multiply_add(majorant_, cell_end - t_, depth_);
    if (deeper > depth_goal_) {
      t_ = fminf(t_ + divide(depth_goal_ - depth_, majorant_), cell_end);
      depth_ = depth_goal_;
      return State::reaches_depth;
    }
    depth_ = fminf(deeper, infinite_distance);
    t_ = cell_end;
    if (t_ >= last_) return State::arrives;
    if (end_.x <= end_.y && end_.x <= end_.z) {
      inverse_.x > 0.0f ? ++x_ : --x_;
      end_.x = end_of(x_, grid.cells[0], origin_.x, inverse_.x);
    } else if (end_.y <= end_.z) {
      inverse_.y > 0.0f ? ++y_ : --y_;
      end_.y = end_of(y_, grid.cells[1], origin_.y, inverse_.y);
    } else {
      inverse_.z > 0.0f ? ++z_ : --z_;
      end_.z = end_of(z_, grid.cells[2], origin_.z, inverse_.z);
    }
    return State::walks;
  }

  /// The distance walked from the ray's origin.
  PT_HD float t() const { return t_; }

  /// `state` is what the last step returned, t_max the ray's.
  PT_HD MajorantWalk result(State state, float t_max) const {
    const bool arrives = state == State::arrives;
    return {arrives ? t_max : t_, depth_, majorant_, arrives};
  }

 private:
  /// Goes through all empty cells that differ from the present one by at most `reach` along each
  /// axis. It ends as steps from cell to cell do, with the same bits: these cross the walls in the
  /// order of their distances, at the same distance in that of the axes, and the distance of a wall
  /// depends on nothing else.
  PT_HD State jump(const VolumeGrid& grid, std::uint32_t reach) {
    const auto farthest = [&](std::uint32_t cell, std::uint32_t count, float inverse_way) {
      return inverse_way > 0.0f   ? min_integer(cell + reach, count - 1)
             : inverse_way < 0.0f ? cell - min_integer(cell, reach)
                                  : cell;
    };
    const std::uint32_t x = farthest(x_, grid.cells[0], inverse_.x),
                        y = farthest(y_, grid.cells[1], inverse_.y),
                        z = farthest(z_, grid.cells[2], inverse_.z);
    const Vec3 out(end_of(x, grid.cells[0], origin_.x, inverse_.x),
                   end_of(y, grid.cells[1], origin_.y, inverse_.y),
                   end_of(z, grid.cells[2], origin_.z, inverse_.z));
    const float end = fminf(fminf(out.x, out.y), out.z);
    t_ = fmaxf(fminf(end, last_), t_);
    if (t_ >= last_) return State::arrives;
    const bool leaves_x = out.x <= out.y && out.x <= out.z, leaves_y = !leaves_x && out.y <= out.z;
    const Vec3 at = add_scaled(origin_, end, direction_);
    // `ties`: crosses walls at the distance where the ray leaves the cells along another axis.
    const auto advance = [&](std::uint32_t& cell, float& cell_end, std::uint32_t last, bool leaves,
                             bool ties, std::uint32_t count, float from, float inverse_way,
                             float place) {
      const auto wall = [&](std::uint32_t c) { return end_of(c, count, from, inverse_way); };
      const auto crosses = [&](float distance) { return ties ? distance <= end : distance < end; };
      const std::uint32_t way = inverse_way > 0.0f ? 1 : ~0u;
      const std::uint32_t first = cell;
      if (leaves) {
        cell = last + way, cell_end = wall(cell);
        return;
      }
      // Near where rounding has it, between the first and the last.
      const std::uint32_t near = detail::clamp_voxel(floorf(place), count);
      cell = inverse_way > 0.0f ? min_integer(max_integer(near, first), last)
                                : max_integer(min_integer(near, first), last);
      cell_end = wall(cell);
      while (crosses(cell_end)) cell += way, cell_end = wall(cell);
      while (cell != first && !crosses(wall(cell - way))) cell -= way, cell_end = wall(cell);
    };
    advance(x_, end_.x, x, leaves_x, true, grid.cells[0], origin_.x, inverse_.x, at.x);
    advance(y_, end_.y, y, leaves_y, !leaves_x, grid.cells[1], origin_.y, inverse_.y, at.y);
    advance(z_, end_.z, z, !leaves_x && !leaves_y, false, grid.cells[2], origin_.z, inverse_.z,
            at.z);
    return State::walks;
  }

  /// Where the ray leaves a cell along an axis. Outermost cells have no end outwards.
  PT_HD static float end_of(std::uint32_t cell, std::uint32_t count, float from,
                            float inverse_way) {
    const bool ends = inverse_way > 0.0f ? cell + 1 < count : inverse_way < 0.0f && cell > 0;
    const float plane = static_cast<float>(cell + (inverse_way > 0.0f ? 1 : 0));
    return ends ? (plane - from) * inverse_way : infinite_distance;
  }

  // The ray, in units of cells; 0 is the inverse of a direction of 0:
  Vec3 origin_{}, direction_{}, inverse_{};
  float first_ = 0.0f, last_ = 0.0f;     ///< the distances between which there are cells
  Vec3 end_{};                           ///< where it leaves the present cell along each axis
  std::uint32_t x_ = 0, y_ = 0, z_ = 0;  ///< the present cell
  float t_ = 0.0f;                       ///< distance from the ray's origin
  float depth_ = 0.0f, depth_goal_ = 0.0f;
  float majorant_ = 0.0f;  ///< of the last cell
};

/// Walks from `t` until the integral of the majorants over the distance is `depth_goal`, or to
/// `t_max`. It depends only on its arguments, so a flight may pause at any collision.
template <bool has_sparse = false>
PT_HD MajorantWalk walk_majorants(const VolumeGrids& grids, const VolumeGrid& grid, const Ray& ray,
                                  float t, float t_max, float depth_goal) {
  CellWalk walk(grid, ray, t_max);
  CellWalk::State state = walk.begin(grid, t, depth_goal);
  while (state == CellWalk::State::walks) state = walk.step<has_sparse>(grids, grid);
  return walk.result(state, t_max);
}

}  // namespace pt
