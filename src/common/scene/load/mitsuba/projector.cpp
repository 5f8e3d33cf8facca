#include <cmath>

#include "common/scene/load/mitsuba/emitters.h"
#include "common/scene/load/mitsuba/sensor.h"
#include "common/scene/load/mitsuba/surfaces/textures.h"

namespace pt::mitsuba {

/// The picture's pixels are squares across the axis. At distance 1 along that, a plane across it
/// receives pi * scale * irradiance, as in Mitsuba 3.9.
void add_projector(Context& context, const Object& emitter) {
  emitter.ignore({"sampling_weight"});
  DeltaLight light;
  light.kind = LightKind::projector;
  const ColorTexture picture =
      read_color_texture(context, emitter, "irradiance", Color(1.0f), Quantity::emission);
  light.texture = picture.texture;
  light.intensity = pi * emitter.number("scale", 1.0f) * picture.color;
  int width = 1, height = 1;
  if (picture.texture != no_texture) {
    const Texture& texture = context.scene.textures[picture.texture];
    if (texture.width > 0) width = static_cast<int>(texture.width);
    if (texture.height > 0) height = static_cast<int>(texture.height);
  }
  CameraParameters view;
  read_fov(emitter, view);
  // As a camera: it looks along its z, with y up and x to the left of the picture.
  const Affine to_world = emitter.transform("to_world");
  light.position = to_world.translation();
  light.direction = glm::normalize(to_world.vector({0, 0, 1}));
  const Vec3 right = glm::normalize(to_world.vector({-1, 0, 0}));
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  light.right = right / (vertical_tangent(view, width, height) * aspect);
  const bool mirrors =
      glm::dot(glm::cross(right, light.direction), to_world.vector({0, 1, 0})) < 0.0f;
  light.aspect = mirrors ? -aspect : aspect;
  context.scene.delta_lights.push_back(light);
}

}  // namespace pt::mitsuba
