#include "common/light/lights.h"

namespace pt {

bool has_position(LightKind kind) {
  return visit_light(Lights{}, kind, [](auto type) { return decltype(type)::type::has_position; });
}

std::optional<LightBounds> bounds_of(const Light& light) {
  return visit_light(Lights{}, light.kind, [&](auto type) -> std::optional<LightBounds> {
    using Type = typename decltype(type)::type;
    if constexpr (Type::has_position) {
      const LightBounds bounds = Type::bounds(light);
      if (bounds.intensity > 0.0f) return bounds;
    }
    return std::nullopt;
  });
}

Color delta_light_power(const DeltaLight& light, float scene_radius) {
  return visit_light(Lights{}, light.kind, [&](auto type) {
    using Type = typename decltype(type)::type;
    if constexpr (requires { Type::power(light, scene_radius); }) {
      return Type::power(light, scene_radius);
    }
    return Color(0.0f);
  });
}

Light make_light(const DeltaLight& delta, float scene_radius) {
  Light light{};
  light.kind = delta.kind;
  light.a = delta.position;
  light.b = delta.direction;
  light.c = {delta.cos_inner, delta.cos_outer,
             bits_to_float(static_cast<std::uint32_t>(delta.falloff))};
  light.radiance = delta.intensity;
  light.triangle = light.emission_texture = no_texture;
  visit_light(Lights{}, delta.kind, [&](auto type) {
    using Type = typename decltype(type)::type;
    if constexpr (requires { Type::store(delta, light); }) Type::store(delta, light);
  });
  light.weight = inverse_pi * luminance(delta_light_power(delta, scene_radius));
  return light;
}

}  // namespace pt
