#include "common/light/lights.h"

namespace pt {

bool has_position(LightKind kind) {
  return visit_light(Lights{}, kind, [](auto type) { return decltype(type)::type::has_position; });
}

std::optional<LightBounds> bounds_of(const Light& light) {
  return visit_light(Lights{}, light.kind, [&](auto type) -> std::optional<LightBounds> {
    using Type = typename decltype(type)::type;
    if constexpr (Type::has_position) {
      const LightBounds bounds = light.as<Type>().bounds();
      if (bounds.intensity > 0.0f) return bounds;
    }
    return std::nullopt;
  });
}

Light make_light(const DeltaLight& light, float scene_radius) {
  return visit_light(Lights{}, light.kind, [&]<class Type>(std::type_identity<Type>) {
    if constexpr (requires { Type::make(light); }) {
      Type own = Type::make(light);
      own.weight = inverse_pi * luminance(own.power(scene_radius));
      return Light::of(own);
    }
    return Light{};
  });
}

}  // namespace pt
