// Motion during the shutter's interval: transformations given at some times and interpolated
// between them, decomposed into a translation, a rotation and a symmetric matrix (Shoemake and Duff
// 1992, 'Matrix Animation and Polar Decomposition'; pbrt-v4, section 3.10). Times in the kernels
// are parts of the interval: 0 the shutter opens, 1 it closes.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/geometry/bounds.h"
#include "common/math/functions.h"
#include "common/math/transform.h"

namespace pt {

/// From one key to the next. All but the rotation is linear in time; the rotation turns evenly, the
/// shorter way.
struct alignas(16) MotionSegment {
  Vec3 translation{0.0f};
  float begin = 0.0f;  ///< time; before it the segment's first pose holds
  Vec3 translated{0.0f};
  float inverse_length = 0.0f;  ///< of the time; 0: it stands still
  Vec4 rotation{0, 0, 0, 1};    ///< quaternion (x, y, z, w) at the begin
  Vec4 towards{0, 0, 0, 0};     ///< unit quaternion across `rotation`, to which it turns
  Vec3 stretch[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  ///< rows of the symmetric matrix
  Vec3 stretched[3] = {Vec3(0.0f), Vec3(0.0f), Vec3(0.0f)};
  float turns = 0.0f;  ///< of the quaternion, in [0, 1/4]: half those of what is rotated
  float end = 0.0f;
};

/// At a part `u` in [0, 1] of the segment.
PT_HD Affine pose_in(const MotionSegment& segment, float u) {
  const SinCos turn = sincos_2pi(u * segment.turns);
  const auto turned = [&](float from, float to) {
    return fused_multiply_add(turn.cos, from, turn.sin * to);
  };
  const float x = turned(segment.rotation.x, segment.towards.x);
  const float y = turned(segment.rotation.y, segment.towards.y);
  const float z = turned(segment.rotation.z, segment.towards.z);
  const float w = turned(segment.rotation.w, segment.towards.w);
  // Of a quaternion that need not have unit length.
  const float s = 2.0f / fused_multiply_add(w, w, sum_of_products(x, x, y, y, z, z));
  const auto plus = [s](float a, float b, float c, float d) {
    return s * fused_multiply_add(a, b, c * d);
  };
  const auto squares = [s](float a, float b) { return 1.0f - s * fused_multiply_add(a, a, b * b); };
  const Vec3 rows[3] = {{squares(y, z), plus(x, y, -z, w), plus(x, z, y, w)},
                        {plus(x, y, z, w), squares(x, z), plus(y, z, -x, w)},
                        {plus(x, z, -y, w), plus(y, z, x, w), squares(x, y)}};
  Vec3 stretch[3];
  for (int i = 0; i < 3; ++i) stretch[i] = add_scaled(segment.stretch[i], u, segment.stretched[i]);
  const Vec3 translation = add_scaled(segment.translation, u, segment.translated);
  Affine pose;
  for (int i = 0; i < 3; ++i)
    pose.row[i] = Vec4(weighted_sum(rows[i], stretch[0], stretch[1], stretch[2]), translation[i]);
  return pose;
}

/// The segments of one thing that moves, in the order of time; none: it stands still.
struct MotionTrack {
  std::uint32_t first = 0, count = 0;

  PT_HD bool moves() const { return count > 0; }
};

/// Before the first key and after the last one their poses hold.
PT_HD Affine pose_at(const MotionSegment* segments, const MotionTrack& track, float time) {
  std::uint32_t i = track.first;
  while (i + 1 < track.first + track.count && time >= segments[i].end) ++i;
  const MotionSegment& segment = segments[i];
  const float u = (time - segment.begin) * segment.inverse_length;
  return pose_in(segment, fminf(fmaxf(u, 0.0f), 1.0f));
}

/// A sphere's motion.
struct alignas(16) SphereTrack {
  Vec3 center{0.0f};  ///< in the space that the poses take to the world
  MotionTrack track;
};

/// What moves a light that is a triangle or a sphere.
struct MovingLight {
  static constexpr std::uint32_t none = 0xffffffffu;

  std::uint32_t primitive =
      none;                       ///< a slot of the tree of triangles, or a sphere; none: it stands
  std::uint32_t instance = none;  ///< of the triangle; none: it lies in the world
};

/// A time between two of the sets of vertices that deform: the part of the way from `set` to the
/// next one.
struct VertexTime {
  std::uint32_t set;
  float part;
};

/// `steps`: from the first set to the last one; not 0.
PT_HD VertexTime vertex_time(float time, std::uint32_t steps) {
  const float at = time * static_cast<float>(steps);
  const std::uint32_t set = static_cast<std::uint32_t>(at);
  const std::uint32_t begin = set < steps ? set : steps - 1;
  return {begin, at - static_cast<float>(begin)};
}

/// What all sets but the first have of vertices that deform; the first is the scene's own array.
template <class Element>
struct LaterSets {
  const Element* elements = nullptr;  ///< set after set; null: the first is all
  std::uint32_t count = 0;            ///< of a set

  PT_HD Element of(const Element* first, std::uint32_t set, std::uint32_t i) const {
    return load_wide(set == 0 ? first + i : elements + (std::size_t{set - 1} * count + i));
  }
};

struct Bvh2Node;
struct Triangle;
struct CornerAttributes;

/// A view of all that moves in a scene.
struct Motion {
  const MotionSegment* segments = nullptr;
  const MotionTrack* instances = nullptr;  ///< [InstanceRecord::index]
  const SphereTrack* spheres = nullptr;    ///< [sphere]; null: none moves
  const MovingLight* lights = nullptr;     ///< [light]
  std::uint32_t light_count = 0;           ///< those after them are not moved
  std::uint32_t vertex_steps = 0;          ///< between sets of vertices; 0: no mesh deforms
  LaterSets<Triangle> triangles;           ///< [slot], of which the vertices count
  LaterSets<CornerAttributes> corners;     ///< [triangle id], of which the normals count
  LaterSets<Bvh2Node> nodes;  ///< [node]; the boxes of those that are not over instances
  MotionTrack camera;
  Affine to_camera;  ///< from the world, at the pose that the scene's camera describes

  PT_HD MovingLight light(std::uint32_t index) const {
    return index < light_count ? lights[index] : MovingLight();
  }
  PT_HD Affine to_world(std::uint32_t instance, float time) const {
    return pose_at(segments, instances[instance], time);
  }
};

// On the host.

/// All that moves.
struct MotionTracks {
  std::vector<MotionSegment> segments;
  std::vector<MotionTrack> instances;  ///< by instance, and one for the meshes of group 0
  std::vector<MotionTrack> spheres;    ///< by MotionData::spheres
  MotionTrack camera;

  bool moves(std::size_t instance) const {
    return instance < instances.size() && instances[instance].moves();
  }
};

/// Calls visit(pose) for the poses between `from` and `to`, parts of the segment, that a bound of
/// the motion needs. Of two that follow each other the path of each point p lies within the result
/// times |p|, plus what rounding does, of the line between its places: on an arc of angular speed w
/// and with the matrix growing by D from S, |x''| <= w^2 |S p| + 2 w |D p|, and a path leaves its
/// chord by no more than h^2 / 8 of that. Points have lengths as seen from the object's origin.
template <class Visit>
double sample_poses(const MotionSegment& segment, double from, double to, Visit&& visit) {
  const double speed = 4 * double{pi} * double{segment.turns};
  double size = 0, growth = 0;  // of the matrices, as vectors of nine numbers: above their norms
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double begin = std::abs(double{segment.stretch[i][j]});
      const double change = std::abs(double{segment.stretched[i][j]});
      size += (begin + change) * (begin + change), growth += change * change;
    }
  }
  const double length = to - from;
  const int steps =
      speed > 0 && length > 0 ? 1 + static_cast<int>(speed * length * 40 / double{pi}) : 1;
  for (int i = 0; i <= steps; ++i)
    visit(pose_in(segment, static_cast<float>(from + length * i / steps)));
  const double h = length / steps;
  return (speed * speed * std::sqrt(size) + 2 * speed * std::sqrt(growth)) * h * h / 8;
}

/// Calls visit(pose), as sample_poses, for all that the shutter sees of a track; the largest of
/// its results.
template <class Visit>
double sample_poses(const std::vector<MotionSegment>& segments, const MotionTrack& track,
                    Visit&& visit) {
  double deviation = 0;
  for (std::uint32_t i = track.first; i < track.first + track.count; ++i) {
    const MotionSegment& segment = segments[i];
    const double scale = double{segment.inverse_length};
    const auto part = [&](double time) {
      return std::clamp((time - double{segment.begin}) * scale, 0.0, 1.0);
    };
    deviation = std::max(deviation, sample_poses(segment, part(0), part(1), visit));
  }
  return deviation;
}

}  // namespace pt
