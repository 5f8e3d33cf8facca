// A point that throws a picture.
#pragma once

#include <cmath>

#include "common/light/light_bounds.h"

namespace pt {

/// What a projector sends in a direction: its picture at `uv`, times `factor`.
struct Projection {
  Vec2 uv;
  float factor = 0.0f;
};

PT_HD Projection project(const Light& light, const Vec3& direction) {
  const float cosine = dot(light.b, direction);
  const Vec3 up = bits_to_float(light.triangle) * cross_rounded(light.c, light.b);
  const float u = 0.5f + 0.5f * dot(light.c, direction) / cosine;
  const float v = 0.5f + 0.5f * dot(up, direction) / cosine;
  const bool inside = cosine > 0.0f && u >= 0.0f && u <= 1.0f && v >= 0.0f && v <= 1.0f;
  return {{u, v}, inside ? 1.0f / (cosine * cosine * cosine) : 0.0f};
}

struct ProjectorLight {
  static constexpr LightKind kind = LightKind::projector;
  static constexpr bool has_position = true;

  PT_HD static PlainLight sample(const Light& light, const Vec3& from, float, float) {
    PlainLight result =
        sample_place(light.a, light.radiance, from, [](const Vec3&) { return 1.0f; });
    const Projection projection = project(light, -result.incident.wi);
    result.uv = projection.uv;
    result.incident.radiance *= projection.factor;
    return result;
  }

  /// The cone around the picture's corners.
  static LightBounds bounds(const Light& light) {
    LightBounds bounds = bounds_of_place(light);
    const float right2 = glm::dot(light.c, light.c), aspect = bits_to_float(light.triangle);
    bounds.axis = light.b;
    bounds.cone = std::atan(std::sqrt((1.0f + 1.0f / (aspect * aspect)) / right2));
    bounds.emission = 1e-3f;
    return bounds;
  }

  static Color power(const DeltaLight& light, float) {
    return 4.0f / (dot(light.right, light.right) * fabsf(light.aspect)) * light.intensity;
  }

  static void store(const DeltaLight& projector, Light& light) {
    light.c = projector.right;
    light.triangle = float_to_bits(projector.aspect);
    light.emission_texture = projector.texture;
  }
};

}  // namespace pt
