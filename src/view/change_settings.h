// Changes of settings that a page sends.
#pragma once

#include <optional>
#include <string_view>

#include "view/live_render.h"

namespace pt {

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
