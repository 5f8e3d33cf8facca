// What a page can change: settings, and a camera that moves around the point that it looks at.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "common/options/options.h"
#include "common/scene/data/camera.h"

namespace pt {

/// The position of a camera relative to its first one.
struct Orbit {
  double yaw = 0;    ///< degrees about the camera's up vector; positive: to its right
  double pitch = 0;  ///< degrees towards the up vector
  double zoom = 1;   ///< factor of the distance from the point looked at, > 0

  bool operator==(const Orbit&) const = default;
};

/// Limits of a camera's pitch, in degrees. They keep it a degree away from the poles, the
/// directions of its up vector, or at its first distance if that is less.
struct PitchRange {
  double least = 0, most = 0;
};
PitchRange pitch_range(const CameraParameters& camera);

/// The moved camera, with its pitch clamped. It keeps its up vector. The plane in focus moves with
/// the distance; an orthographic camera sees less the nearer it is. Without a movement no bit
/// changes. `camera` is valid (check_camera).
CameraParameters orbit_camera(const CameraParameters& camera, const Orbit& orbit);

struct SettingsChange {
  std::optional<Orbit> orbit;
  std::optional<std::vector<Mode>> modes;
  std::optional<float> exposure;  ///< stops
};

/// Reads JSON such as {"orbit": {"yaw": 10, "pitch": -5, "zoom": 1.5}, "mode": "split", "exposure":
/// 1}; each key is optional. Throws Error that names the key and what was expected.
SettingsChange read_change(std::string_view json);

/// The mode's name, or "split" for several.
std::string mode_name(const std::vector<Mode>& modes);

}  // namespace pt
