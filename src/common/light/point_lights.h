// Lights at a point: they shine everywhere, into a cone, or through a picture.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/light/light.h"
#include "common/math/functions.h"
#include "common/math/transform.h"

namespace pt {

/// A sample of `intensity` times share(wi) from `position`. Black at the position itself.
template <class Share>
PT_HD PlainLight sample_place(const Vec3& position, const Color& intensity, const Vec3& from,
                              const Share& share) {
  PlainLight result;
  IncidentLight& incident = result.incident;
  incident.pdf = 1.0f, incident.is_delta = true;
  const Vec3 to_light = position - from;
  const float distance2 = dot(to_light, to_light);
  if (distance2 == 0.0f) return result;
  const float inverse_distance = inverse_sqrt(distance2);
  const Vec3 wi = inverse_distance * to_light;
  // A light on a surface shines in front of it: its position has been rounded.
  const float error = 4.0f * half_ulp * max_abs(position) * inverse_distance + light_rounding;
  incident.wi = wi;
  incident.end = fmaxf(1.0f - error, 0.5f) * to_light;
  incident.radiance = intensity * (share(wi) / distance2);
  return result;
}

/// The bounds of a light at a point that shines everywhere.
inline LightBounds bounds_of_place(const Vec3& position, const Color& intensity) {
  LightBounds bounds;
  bounds.box.grow(position);
  bounds.cone = half_turn;
  bounds.emission = quarter_turn;
  bounds.intensity = luminance(intensity);
  return bounds;
}

struct alignas(16) PointLight {
  static constexpr LightKind type = LightKind::point;
  static constexpr bool has_position = true;

  Vec3 position{0.0f};
  LightKind kind = type;
  float unused_a[3] = {};
  float weight = 0.0f;
  float unused_b[4] = {};
  Color radiance{0.0f};  ///< intensity, W / sr
  std::uint32_t emission_texture = no_texture;

  static PointLight make(const DeltaLight& light) {
    PointLight result;
    result.position = light.position, result.radiance = light.intensity;
    return result;
  }
  PT_HD PlainLight sample(const Vec3& from, float, float) const {
    return sample_place(position, radiance, from, [](const Vec3&) { return 1.0f; });
  }
  LightBounds bounds() const { return bounds_of_place(position, radiance); }
  Color power(float) const { return 4.0f * pi * radiance; }
};

/// Between 0 and 1: the share of its intensity that a spot light sends at an angle to its axis.
/// `Spot` is a DeltaLight or a SpotLight.
template <class Spot>
PT_HD float spot_share(const Spot& light, float cosine) {
  if (cosine >= light.cos_inner) return 1.0f;
  if (cosine <= light.cos_outer) return 0.0f;
  if (light.falloff == SpotFalloff::linear_angle) {
    const float outer = acosf(light.cos_outer);
    return (outer - acosf(cosine)) / (outer - acosf(light.cos_inner));
  }
  const float t = (cosine - light.cos_outer) / (light.cos_inner - light.cos_outer);
  return light.falloff == SpotFalloff::smooth ? t * t * (3.0f - 2.0f * t) : t * t;
}

/// Shines into a cone, with or without a picture, which fills the cone of the outer angle.
struct alignas(16) SpotLight {
  static constexpr LightKind type = LightKind::spot;
  static constexpr bool has_position = true;

  Vec3 position{0.0f};
  LightKind kind = type;
  Vec3 direction{0, 0, -1};  ///< away from the light, unit length
  float weight = 0.0f;
  float cos_inner = 1.0f, cos_outer = -1.0f;
  SpotFalloff falloff = SpotFalloff::smooth;
  float roll = 0.0f;     ///< rotation of the picture about the axis, in turns: see roll_of()
  Color radiance{0.0f};  ///< intensity, W / sr
  std::uint32_t emission_texture = no_texture;

  static SpotLight make(const DeltaLight& light) {
    SpotLight result;
    result.position = light.position, result.direction = light.direction;
    result.cos_inner = light.cos_inner, result.cos_outer = light.cos_outer;
    result.falloff = light.falloff;
    result.radiance = light.intensity;
    if (light.texture == no_texture) return result;
    result.roll = roll_of(light);
    result.emission_texture = light.texture;
    return result;
  }

  PT_HD PlainLight sample(const Vec3& from, float, float) const {
    PlainLight result = sample_place(position, radiance, from, [&](const Vec3& wi) {
      return spot_share(*this, -dot(direction, wi));
    });
    if (emission_texture != no_texture) result.uv = uv_of(-result.incident.wi);
    return result;
  }

  /// Beyond the inner angle, the falloff is at most a cosine that is positive up to the outer
  /// angle.
  LightBounds bounds() const {
    LightBounds bounds = bounds_of_place(position, radiance);
    const float inner = std::acos(std::clamp(cos_inner, -1.0f, 1.0f));
    const float outer = std::acos(std::clamp(cos_outer, -1.0f, 1.0f));
    bounds.axis = direction;
    bounds.cone = std::max(inner, outer - quarter_turn);
    bounds.emission = std::max(outer - bounds.cone, 1e-3f);
    return bounds;
  }

  /// pbrt's estimate: the cone of the mean of both angles' cosines.
  Color power(float) const {
    return 2.0f * pi * (1.0f - 0.5f * (cos_inner + cos_outer)) * radiance;
  }

 private:
  /// The angle of the picture's u axis in the frame of the light's axis, in turns from 0 to 1, less
  /// 1 where the picture is mirrored.
  static float roll_of(const DeltaLight& spot) {
    const Frame frame = make_frame(spot.direction);
    const float angle =
        std::atan2(glm::dot(spot.right, frame.bitangent), glm::dot(spot.right, frame.tangent));
    const float turns = angle / (2.0f * pi);
    const float positive = turns < 0.0f ? turns + 1.0f : turns;
    return spot.aspect < 0.0f ? positive - 1.0f : positive;
  }

  /// The picture's coordinates in a direction from the light.
  PT_HD Vec2 uv_of(const Vec3& away) const {
    const Frame frame = make_frame(direction);
    const SinCos turn = sincos_2pi(roll);
    const Vec3 right = turn.cos * frame.tangent + turn.sin * frame.bitangent;
    const Vec3 up = (roll < 0.0f ? -1.0f : 1.0f) * glm::cross(right, direction);
    const float cos_edge = cos_inner < cos_outer ? cos_inner : cos_outer;
    const float tangent = sqrtf(fmaxf(1.0f - cos_edge * cos_edge, 0.0f)) / cos_edge;
    const float scale = 0.5f / (dot(direction, away) * tangent);
    return {0.5f + scale * dot(right, away), 0.5f + scale * dot(up, away)};
  }
};

/// The light of a projector in a direction: its picture at `uv`, times `factor`.
struct Projection {
  Vec2 uv;
  float factor = 0.0f;
};

/// Projects a picture.
struct alignas(16) ProjectorLight {
  static constexpr LightKind type = LightKind::projector;
  static constexpr bool has_position = true;

  Vec3 position{0.0f};
  LightKind kind = type;
  Vec3 direction{0, 0, -1};  ///< the axis, unit length
  float weight = 0.0f;
  Vec3 right{1, 0, 0};   ///< direction of the picture's u, of length 1 / tan(fov / 2)
  float aspect = 1.0f;   ///< width over height; negative: mirrored
  Color radiance{0.0f};  ///< intensity on the axis, W / sr
  std::uint32_t emission_texture = no_texture;

  static ProjectorLight make(const DeltaLight& light) {
    ProjectorLight result;
    result.position = light.position, result.direction = light.direction;
    result.right = light.right, result.aspect = light.aspect;
    result.radiance = light.intensity;
    result.emission_texture = light.texture;
    return result;
  }

  PT_HD Projection project(const Vec3& away) const {
    const float cosine = dot(direction, away);
    const Vec3 up = aspect * glm::cross(right, direction);
    const float u = 0.5f + 0.5f * dot(right, away) / cosine;
    const float v = 0.5f + 0.5f * dot(up, away) / cosine;
    const bool inside = cosine > 0.0f && u >= 0.0f && u <= 1.0f && v >= 0.0f && v <= 1.0f;
    return {{u, v}, inside ? 1.0f / (cosine * cosine * cosine) : 0.0f};
  }

  PT_HD PlainLight sample(const Vec3& from, float, float) const {
    PlainLight result = sample_place(position, radiance, from, [](const Vec3&) { return 1.0f; });
    const Projection projection = project(-result.incident.wi);
    result.uv = projection.uv;
    result.incident.radiance *= projection.factor;
    return result;
  }

  /// The cone around the picture's corners.
  LightBounds bounds() const {
    LightBounds bounds = bounds_of_place(position, radiance);
    const float right2 = glm::dot(right, right);
    bounds.axis = direction;
    bounds.cone = std::atan(std::sqrt((1.0f + 1.0f / (aspect * aspect)) / right2));
    bounds.emission = 1e-3f;
    return bounds;
  }

  Color power(float) const { return 4.0f / (dot(right, right) * fabsf(aspect)) * radiance; }
};

}  // namespace pt
