#include "common/scene/builtin/dial_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "common/error/error.h"
#include "common/scene/builtin/name_parts.h"
#include "common/scene/builtin/sphere_world.h"

namespace pt {
DialSettings parse_dial(const SceneName& scene) {
  DialSettings settings;
  if (scene.parameter.empty()) return settings;
  std::string_view rest = scene.parameter;
  const bool has_coherence = rest.find(':') != std::string_view::npos;
  const std::string_view materials = next_part(rest);
  if (!read_part(materials, 1u, dial_materials_most, settings.materials)) {
    refuse_part(scene, 'K', materials, "a whole number of materials from 1 to 32", "dial:K:C:F");
  }
  if (!has_coherence) return settings;
  const bool has_form = rest.find(':') != std::string_view::npos;
  const std::string_view coherence = next_part(rest);
  if (!read_part(coherence, 0.0f, 1.0f, settings.coherence)) {
    refuse_part(scene, 'C', coherence, "a coherence from 0 to 1", "dial:K:C:F");
  }
  if (!has_form) return settings;
  if (rest != "open" && rest != "closed")
    refuse_part(scene, 'F', rest, "open or closed", "dial:K:C:F");
  settings.closed = rest == "closed";
  return settings;
}

std::uint32_t dial_material_of(const DialSettings& settings, std::uint32_t cell,
                               std::uint32_t column, std::uint32_t columns) {
  WorldRandom random(cell);
  if (random.next() < settings.coherence) return column * settings.materials / columns;
  const float count = static_cast<float>(settings.materials);
  return std::min(static_cast<std::uint32_t>(random.next(0, count)), settings.materials - 1);
}

}  // namespace pt
