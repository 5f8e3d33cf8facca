// Spots in a space that is scaled differently along its axes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/light/delta_light.h"
#include "common/light/light.h"
#include "common/light/light_bounds.h"
#include "common/light/spot_light.h"
#include "common/math/frame.h"
#include "common/scene/load/pbrt/lights/lights.h"

namespace pt::pbrt {
namespace {

constexpr std::uint32_t picture_side = 512;
constexpr std::size_t most_spots = 100;        // 3 MB each
constexpr float widest = 80.0f * pi / 180.0f;  // beyond, a picture on a plane has too few texels

/// The angle in the world, about the light's direction, within which all of its light is.
float outer_angle(const Affine& to_world, const Vec3& axis, const DeltaLight& light) {
  constexpr int steps = 256;
  const Frame frame = make_frame(axis);
  const float sine = std::sqrt(std::max(1.0f - light.cos_outer * light.cos_outer, 0.0f));
  float least = 1.0f;
  for (int i = 0; i < steps; ++i) {
    const float turn = 2.0f * pi * static_cast<float>(i) / float{steps};
    const Vec3 edge = light.cos_outer * axis + sine * std::cos(turn) * frame.tangent +
                      sine * std::sin(turn) * frame.bitangent;
    least = std::min(least, glm::dot(glm::normalize(to_world.vector(edge)), light.direction));
  }
  return std::acos(std::clamp(least, -1.0f, 1.0f)) + 1e-3f;  // edges between those tried
}

/// The share of the intensity over the square around a cone of this angle (see SpotLight::uv).
TextureImage picture_of(const Affine& to_light, const Vec3& axis, const DeltaLight& light,
                        float angle, const Vec3& right) {
  TextureImage image{TextureFormat::rgb32f, picture_side, picture_side, {}};
  image.texels.resize(std::size_t{12} * picture_side * picture_side);
  std::byte* next = image.texels.data();
  const Vec3 up = glm::cross(right, light.direction);
  const float tangent = std::tan(angle);
  const auto place = [](std::uint32_t i) {
    return 2.0f * (static_cast<float>(i) + 0.5f) / float{picture_side} - 1.0f;
  };
  for (std::uint32_t y = 0; y < picture_side; ++y) {
    for (std::uint32_t x = 0; x < picture_side; ++x, next += 12) {
      const Vec3 world = light.direction + tangent * (place(x) * right - place(y) * up);
      const Vec3 own = glm::normalize(to_light.vector(world));
      const Color share(spot_share(light, glm::dot(own, axis)));
      std::memcpy(next, &share, sizeof share);
    }
  }
  return image;
}

}  // namespace

void stretch_spot(Context& context, const Entity& entity, const Vec3& axis, DeltaLight& light) {
  const float angle =
      light.cos_outer > 0.0f ? outer_angle(entity.to_world, axis, light) : 0.5f * pi;
  const auto& spots = context.scene.delta_lights;
  const auto pictures = static_cast<std::size_t>(
      std::ranges::count_if(spots, [](const DeltaLight& l) { return l.texture != no_texture; }));
  if (!(angle < widest) || pictures >= most_spots) {
    return context.reporter.warn_once(
        "wide spot", entity.parameters.place(),
        fmt::format("a spot wider than 80 degrees, or one of more than {}, in a space that is not "
                    "scaled alike along all axes: its cone is round",
                    most_spots));
  }
  const Affine to_light = inverse(entity.to_world);
  light.right = make_frame(light.direction).tangent;
  Texture look;
  look.wrap_u = look.wrap_v = TextureWrap::clamp;
  light.texture =
      context.textures.add_image(picture_of(to_light, axis, light, angle, light.right), look);
  light.cos_inner = light.cos_outer = std::cos(angle);
}

}  // namespace pt::pbrt
