// What of a scene moves while the shutter is open.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/accel/nodes.h"
#include "common/geometry/mesh.h"
#include "common/geometry/motion.h"
#include "common/geometry/triangle.h"

namespace pt {

/// A transformation at a time, in seconds.
struct TransformKey {
  float time = 0.0f;
  Affine to_world;

  bool operator==(const TransformKey&) const = default;
};

/// Throws Error, which begins with `what`, for keys between which nothing can be interpolated.
void check_keys(const std::vector<TransformKey>& keys, const std::string& what);

/// When light reaches the film, in seconds; it opens before it closes.
struct Shutter {
  float open = 0.0f, close = 1.0f;

  bool operator==(const Shutter&) const = default;
};

/// What the host's kernels read; `view` points to the rest, so it is never copied.
struct PreparedMotion {
  MotionTracks tracks;
  std::vector<SphereTrack> spheres;       ///< see Motion
  std::vector<MovingLight> lights;        ///< see Motion
  std::vector<Triangle> later_triangles;  ///< see Motion
  std::vector<CornerAttributes> later_corners;
  std::vector<Bvh2Node> later_nodes;
  Motion view;

  PreparedMotion() = default;
  PreparedMotion(const PreparedMotion&) = delete;
  PreparedMotion& operator=(const PreparedMotion&) = delete;

  /// Calls function(pointer in `motion`, vector) for each array: the only list of them.
  template <class Function>
  void for_each_array(Motion& motion, Function&& function) const {
    function(motion.segments, tracks.segments);
    function(motion.instances, tracks.instances);
    function(motion.spheres, spheres);
    function(motion.lights, lights);
    function(motion.triangles.elements, later_triangles);
    function(motion.corners.elements, later_corners);
    function(motion.nodes.elements, later_nodes);
  }
  /// When arrays have changed.
  void update_view() {
    for_each_array(view, [](auto*& pointer, const auto& values) {
      pointer = values.empty() ? nullptr : values.data();
    });
    view.light_count = static_cast<std::uint32_t>(lights.size());
    const auto of_a_set = [this](const auto& sets) {
      return static_cast<std::uint32_t>(sets.size() / std::max(view.vertex_steps, 1u));
    };
    view.triangles.count = of_a_set(later_triangles), view.corners.count = of_a_set(later_corners);
    view.nodes.count = of_a_set(later_nodes);
  }
};

/// Keys are two or more, in the order of time; before the first and after the last one nothing
/// moves.
struct MotionData {
  struct MovingInstance {
    std::uint32_t instance = 0;
    std::vector<TransformKey> keys;
  };
  struct MovingSphere {
    std::uint32_t sphere = 0;
    std::vector<TransformKey> keys;

    /// The centre in the space of the keys, of a sphere where it is at the first one.
    Vec3 own_center(const Vec3& center) const {
      return inverse(keys.front().to_world).point(center);
    }
  };

  Shutter shutter;
  std::vector<TransformKey> camera;  ///< poses of the camera's space, which the first key's pose
                                     ///< takes to what the scene's camera says; those of loaders
                                     ///< have it look along z, with x to the left and y up; empty:
                                     ///< it stands
  std::vector<MovingInstance> instances;     ///< whose Instance::to_world is then the first key's
  std::vector<MovingSphere> spheres;         ///< which then are where the first key has them; keys
                                             ///< turn and move
  std::shared_ptr<PreparedMotion> prepared;  ///< of the above, by prepare_motion(); null: it stands

  bool moves() const { return !camera.empty() || !instances.empty() || !spheres.empty(); }
  const MotionTracks& tracks() const {
    static const MotionTracks none;
    return prepared ? prepared->tracks : none;
  }
};

}  // namespace pt
