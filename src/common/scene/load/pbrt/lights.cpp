// Lights that are not on a shape.
#include <algorithm>
#include <cmath>

#include "common/light/light.h"
#include "common/light/point_lights.h"
#include "common/math/transform.h"
#include "common/scene/load/files/importer.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/pbrt/scene_parts.h"
#include "common/scene/load/pbrt/syntax/description.h"

namespace pt::pbrt {
namespace {

// Spots in a space that is scaled differently along its axes.

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
  const Vec3 up = glm::cross(right, light.direction);
  const float tangent = std::tan(angle);
  const auto place = [](std::uint32_t i) {
    return 2.0f * (static_cast<float>(i) + 0.5f) / float{picture_side} - 1.0f;
  };
  return make_float_image(picture_side, picture_side, [&](auto x, auto y) {
    const Vec3 world = light.direction + tangent * (place(x) * right - place(y) * up);
    return Color(spot_share(light, glm::dot(glm::normalize(to_light.vector(world)), axis)));
  });
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
        "a spot wider than 80 degrees, or one of more than {}, in a space that is not scaled alike "
        "along all axes: its cone is round",
        most_spots);
  }
  const Affine to_light = inverse(entity.to_world);
  light.right = make_frame(light.direction).tangent;
  Texture look;
  look.wrap_u = look.wrap_v = TextureWrap::clamp;
  light.texture =
      context.textures.add_image(picture_of(to_light, axis, light, angle, light.right), look);
  light.cos_inner = light.cos_outer = std::cos(angle);
}

namespace {

/// scale * `name`; where a `power` is given, that over `sphere`, the integral of the light's share
/// over all directions, replaces the scale's unit.
Color read_intensity(Context& context, const Entity& entity, const char* name, const char* power,
                     float sphere) {
  const Parameters& parameters = entity.parameters;
  const Color white = to_srgb(Color(1.0f), entity.space);
  const Color color = read_color(context, parameters, name, white, Quantity::illuminant);
  const float all = parameters.number(power, 0.0f);
  return read_light_scale(context, parameters) * (all > 0.0f ? all / sphere : 1.0f) * color;
}

void add_point(Context& context, const Entity& entity) {
  DeltaLight light;
  light.kind = LightKind::point;
  light.intensity = read_intensity(context, entity, "I", "power", 4.0f * pi);
  light.position = entity.to_world.point(entity.parameters.point("from", Vec3(0.0f)));
  context.scene.delta_lights.push_back(light);
}

Vec3 read_direction(const Entity& entity, const Vec3& from) {
  const Vec3 to = entity.parameters.point("to", Vec3(0, 0, 1));
  const Vec3 direction = entity.to_world.vector(to - from);
  const float length = glm::length(direction);
  if (length > 0.0f && std::isfinite(length)) return direction / length;
  fail(entity.parameters.place(), "{}: expected two different points 'from' and 'to'",
       entity.parameters.what());
}

void add_spot(Context& context, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  const float cone = parameters.number("coneangle", 30.0f);
  const float delta = parameters.number("conedeltaangle", 5.0f);
  if (!(cone > 0.0f && cone <= 180.0f && delta >= 0.0f)) {
    fail(parameters.place(),
         "spot: coneangle {} and conedeltaangle {}; expected degrees with 0 < coneangle <= 180 and "
         "0 <= conedeltaangle",
         cone, delta);
  }
  if (delta > 2.0f * cone) {
    context.reporter.warn_once(
        "narrow spot", parameters.place(),
        "a conedeltaangle of more than twice the coneangle: the spot falls off from its axis on");
  }
  DeltaLight light;
  light.kind = LightKind::spot;
  light.falloff = SpotFalloff::smooth;
  // As pbrt, the cosine of what is left, which the default of 5 makes negative in narrow cones.
  light.cos_inner = cosine_of_degrees(delta > 2.0f * cone ? 0.0f : cone - delta);
  light.cos_outer = cosine_of_degrees(cone);
  const float sphere =
      2.0f * pi * ((1.0f - light.cos_inner) + 0.5f * (light.cos_inner - light.cos_outer));
  light.intensity = read_intensity(context, entity, "I", "power", sphere);
  const Vec3 from = parameters.point("from", Vec3(0.0f));
  light.position = entity.to_world.point(from);
  light.direction = read_direction(entity, from);
  if (!uniform_scale(entity.to_world)) {
    const Vec3 to = parameters.point("to", Vec3(0, 0, 1));
    stretch_spot(context, entity, glm::normalize(to - from), light);
  }
  context.scene.delta_lights.push_back(light);
}

void add_distant(Context& context, const Entity& entity) {
  DeltaLight light;
  light.kind = LightKind::directional;
  light.intensity = read_intensity(context, entity, "L", "illuminance", 1.0f);
  light.direction = read_direction(entity, entity.parameters.point("from", Vec3(0.0f)));
  context.scene.delta_lights.push_back(light);
}

using Adder = void (*)(Context&, const Entity&);

const std::map<std::string_view, Adder>& adders() {
  static const std::map<std::string_view, Adder> table = {
      {"point", add_point}, {"spot", add_spot}, {"distant", add_distant}};
  return table;
}

}  // namespace

const Parameter* find_picture(const Parameters& parameters) {
  const Parameter* filename = parameters.find("filename", {"string"});
  return filename ? filename : parameters.find("mapname", {"string"});
}

Color read_light_scale(Context& context, const Parameters& parameters) {
  const Parameter* given = parameters.find("scale");
  const bool is_color = given && given->type != "float" && given->type != "integer";
  const Color scale =
      context.imaging_ratio *
      (is_color ? read_color(context, parameters, "scale", Color(1.0f), Quantity::unbounded)
                : Color(parameters.number("scale", 1.0f)));
  for (int i = 0; i < 3; ++i) {
    if (scale[i] >= 0.0f && std::isfinite(scale[i])) continue;
    fail(parameters.place(), "{}: a scale below 0", parameters.what());
  }
  return scale;
}

void add_lights(Context& context) {
  SkyLights sky;
  for (const EntityPointer& entity : context.description.lights) {
    const Parameters& parameters = entity->parameters;
    const auto adder = adders().find(entity->type);
    const bool is_infinite = entity->type == "infinite";
    if (adder == adders().end() && !is_infinite) {
      context.reporter.warn_once(
          "light " + entity->type, parameters.place(),
          "light '{}' is not supported: it is left out; expected point, spot, distant or infinite",
          entity->type);
      continue;
    }
    context.reporter.attempt(parameters.what(), "is left out", [&] {
      if (is_infinite) {
        sky.add(context, *entity);
      } else {
        adder->second(context, *entity);
      }
      parameters.ignore({"samples", "nsamples"});  // of pbrt-v3
      parameters.report_unused(context.reporter);
      context.lit = true;
    });
  }
  sky.store(context.scene);
}

}  // namespace pt::pbrt
