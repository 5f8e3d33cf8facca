// A camera that is led about what it looks at.
#pragma once

#include "common/scene/data/camera.h"

namespace pt {

/// Where a camera is, as seen from where it was.
struct Orbit {
  double yaw = 0;    ///< degrees about the camera's up vector; positive: to its right
  double pitch = 0;  ///< degrees towards the up vector
  double zoom = 1;   ///< distance from the point looked at, in parts of the old one, > 0

  bool operator==(const Orbit&) const = default;
};

/// What a camera's pitch may be, in degrees: so that it stays away from the poles, the directions
/// of its up vector, by a degree, or by as much as before where that is less.
struct PitchRange {
  double least = 0, most = 0;
};
PitchRange pitch_range(const CameraParameters& camera);

/// The camera, moved; its pitch as near to what is asked for as may be. It keeps its up vector. The
/// plane in focus moves with the distance; an orthographic camera sees the less the nearer it is.
/// At rest nothing changes in any bit. `camera` describes one (check_camera).
CameraParameters orbit_camera(const CameraParameters& camera, const Orbit& orbit);

}  // namespace pt
