#include "common/scene/load/mitsuba/emitters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/scene/load/mitsuba/surfaces/textures.h"

namespace pt::mitsuba {
namespace {

Color radiance_of(Context& context, const Object& emitter, std::string_view name) {
  emitter.ignore({"sampling_weight"});
  return read_plain_color(context, emitter, emission_name(emitter, name), Color(1.0f),
                          Quantity::emission);
}

void add_point(Context& context, const Object& emitter) {
  DeltaLight light;
  light.kind = LightKind::point;
  light.intensity = radiance_of(context, emitter, "intensity");
  const Vec3 moved = emitter.transform("to_world").translation();
  light.position = emitter.vector("position", moved);
  context.scene.delta_lights.push_back(light);
}

float cosine(float degrees) { return std::cos(degrees * pi / 180.0f); }

void add_spot(Context& context, const Object& emitter) {
  DeltaLight light;
  light.kind = LightKind::spot;
  light.falloff = SpotFalloff::linear_angle;
  light.intensity = radiance_of(context, emitter, "intensity");
  const Affine to_world = emitter.transform("to_world");
  light.position = to_world.translation();
  light.direction = glm::normalize(to_world.vector({0, 0, 1}));
  float cutoff = emitter.number("cutoff_angle", 20.0f);
  float beam = emitter.number("beam_width", 0.75f * cutoff);
  if (!(cutoff > 0.0f && cutoff <= 180.0f && beam >= 0.0f && beam <= cutoff)) {
    const float given_beam = beam, given_cutoff = cutoff;
    cutoff = std::clamp(cutoff, 0.0f, 180.0f), beam = std::clamp(beam, 0.0f, cutoff);
    context.warn_once("spot angles", emitter.element(),
                      fmt::format("spot: beam_width {} and cutoff_angle {}; expected degrees with "
                                  "0 <= beam_width <= cutoff_angle <= 180: {} and {} are used",
                                  given_beam, given_cutoff, beam, cutoff));
    if (cutoff == 0.0f) return;
  }
  light.cos_inner = cosine(beam);
  light.cos_outer = cosine(cutoff);
  const ColorTexture picture =
      read_color_texture(context, emitter, "texture", Color(1.0f), Quantity::reflectance);
  light.intensity *= picture.color;
  light.texture = picture.texture;
  light.right = glm::normalize(to_world.vector({1, 0, 0}));
  if (to_world.determinant() < 0.0f) light.aspect = -1.0f;
  context.scene.delta_lights.push_back(light);
}

void add_directional(Context& context, const Object& emitter) {
  DeltaLight light;
  light.kind = LightKind::directional;
  light.intensity = radiance_of(context, emitter, "irradiance");
  const Vec3 along = emitter.transform("to_world").vector({0, 0, 1});
  const Vec3 direction = emitter.vector("direction", along);
  if (!(glm::length(direction) > 0.0f)) {
    return context.warn_once("direction", emitter.element(),
                             "directional: the direction has length zero: the light is left out");
  }
  light.direction = glm::normalize(direction);
  context.scene.delta_lights.push_back(light);
}

void add_sky(Context& context, const Color& radiance) {
  context.scene.sky.nadir += radiance;
  context.scene.sky.zenith += radiance;
}

void add_constant(Context& context, const Object& emitter) {
  add_sky(context, radiance_of(context, emitter, "radiance"));
}

using Adder = void (*)(Context&, const Object&);

const std::map<std::string_view, Adder>& adders() {
  static const std::map<std::string_view, Adder> table = {
      {"point", add_point},       {"spot", add_spot},           {"directional", add_directional},
      {"constant", add_constant}, {"sky", add_daylight},        {"sun", add_daylight},
      {"sunsky", add_daylight},   {"projector", add_projector},
  };
  return table;
}

std::string why_left_out(const std::string& type) {
  if (type == "envmap") return "more than one environment: the first is used";
  if (type == "area") return "an emitter 'area' that is in no shape: it is left out";
  return fmt::format("emitter '{}' is not supported: it is left out", type);
}

}  // namespace

void add_emitter(Context& context, const Object& emitter) {
  if (context.on_shapes.contains(&emitter)) return;  // they refer to it
  const std::string type = emitter.type();
  if (type == "envmap" && context.scene.environment.width == 0) {
    add_environment_map(context, emitter);
    return context.add_lit();
  }
  const auto adder = adders().find(type);
  if (adder == adders().end()) {
    context.warn_once("emitter " + type, emitter.element(), why_left_out(type));
    return context.add_left_out(emitter);
  }
  auto& lights = context.scene.delta_lights;
  const std::size_t before = lights.size();
  adder->second(context, emitter);
  if (lights.size() > before && !emitter.id().empty())
    context.scene.names.delta_lights[static_cast<std::uint32_t>(before)] = emitter.id();
  context.add_lit();
}

}  // namespace pt::mitsuba
