// `sunsky`, and 0.x's `sky` and `sun`: the sky becomes a map of all directions, the sun a light.
#include <cmath>

#include "common/light/sky/sunsky.h"
#include "common/scene/load/mitsuba/scene_parts.h"
#include "common/scene/load/mitsuba/surfaces/textures.h"
#include "common/scene/load/mitsuba/xml/elements.h"

namespace pt::mitsuba {
namespace {

/// The sky's map has a row on the horizon.
constexpr int columns = 1024, rows = 513;
constexpr double sun_aperture = 0.5358;  ///< degrees, as seen from the ground

double number_between(const Object& emitter, const char* name, double fallback, double lowest,
                      double highest) {
  const double value = emitter.number(name).value_or(fallback);
  if (!(value >= lowest && value <= highest)) {
    fail(emitter.element(), "emitter '{}': {} {}; expected {} to {}", emitter.type(), name, value,
         lowest, highest);
  }
  return value;
}

SunTime read_time(const Object& emitter) {
  SunTime t;
  const auto set = [&](const char* name, double& value) {
    value = emitter.number(name).value_or(value);
  };
  set("latitude", t.latitude), set("longitude", t.longitude), set("timezone", t.timezone);
  set("hour", t.hour), set("minute", t.minute), set("second", t.second);
  t.year = emitter.integer("year").value_or(t.year);
  t.month = static_cast<int>(number_between(emitter, "month", t.month, 1, 12));
  t.day = static_cast<int>(number_between(emitter, "day", t.day, 1, 31));
  return t;
}

/// From the model's space, where +z is up, to the world; 0.x has +y up.
Affine model_to_world(const Context& context, const Object& emitter) {
  const Affine map = emitter.transform("to_world");
  return context.modern ? map : map * rotate({1, 0, 0}, -90.0f);
}

/// In the model's space. A file gives it in the world's.
Vec3 read_sun_direction(const Object& emitter, const Affine& to_world) {
  const SunTime time = read_time(emitter);
  if (emitter.find("sun_direction") == nullptr) return sun_direction(time);
  const Vec3 direction = emitter.vector("sun_direction", Vec3(0.0f));
  if (!(glm::length(direction) > 0.0f)) {
    fail(emitter.element(), "sun_direction has length zero");
  }
  return glm::normalize(inverse(to_world).vector(direction));
}

/// A map whose zenith is +y: x and z of its space are the model's x and -y.
void add_sky_map(Context& context, const Object& emitter, const SkyModel& model, const Vec3& sun,
                 float scale, const Affine& to_world) {
  EnvironmentData& map = context.scene.environment;
  if (map.width > 0) {
    return context.warn_once("second sky", emitter.element(),
                             "the sky is left out: there is an environment already");
  }
  map.width = columns, map.height = rows;
  map.pixels.assign(std::size_t{columns} * rows, Color(0.0f));
  for (int y = 0; y <= rows / 2; ++y) {
    const double theta = double{pi} * y / (rows - 1),
                 cos_theta = y == rows / 2 ? 0 : std::cos(theta);
    // The horizon's row reaches half a step below it, where it is dark.
    const float share = y == rows / 2 ? 0.5f * scale : scale;
    for (int x = 0; x < columns; ++x) {
      const double phi = 2 * double{pi} * ((x + 0.5) / columns - 0.5);
      const glm::dvec3 d(std::sin(theta) * std::sin(phi), std::sin(theta) * std::cos(phi),
                         cos_theta);
      const glm::dvec3 s(sun);
      const double angle = std::atan2(glm::length(glm::cross(d, s)), glm::dot(d, s));
      map.pixels[static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)] =
          share * model.radiance(cos_theta, angle);
    }
  }
  map.to_world = to_world * rotate({1, 0, 0}, 90.0f);
}

void add_sun_disk(Context& context, const Object& emitter, const Color& irradiance,
                  const Vec3& direction, double aperture) {
  if (context.scene.sun.one_minus_cos > 0.0f) {
    return context.warn_once("second sun", emitter.element(),
                             "more than one sun: the first is used");
  }
  const double half_sine = std::sin(0.25 * aperture * double{pi} / 180);
  const double one_minus_cos = 2 * half_sine * half_sine;
  Sun& sun = context.scene.sun;
  sun.direction = direction;
  sun.one_minus_cos = static_cast<float>(one_minus_cos);
  sun.radiance = irradiance / static_cast<float>(2 * double{pi} * one_minus_cos);
}

}  // namespace

void add_daylight(Context& context, const Object& emitter) {
  const std::string type = emitter.type();
  emitter.ignore({"sampling_weight", "resolution", "samples", "stretch"});
  const float scale = emitter.number("scale", 1.0f);
  const float sky_scale = type == "sun" ? 0.0f : scale * emitter.number("sky_scale", 1.0f);
  const float sun_scale = type == "sky" ? 0.0f : scale * emitter.number("sun_scale", 1.0f);
  const double turbidity = number_between(emitter, "turbidity", 3, 1, 10);
  const double aperture = sun_aperture * emitter.number("sun_radius_scale", 1.0f);
  const double seen_aperture = number_between(emitter, "sun_aperture", aperture, 0.01, 179);
  const Color albedo = read_plain_color(
      context, emitter, "albedo", Color(context.modern ? 0.3f : 0.15f), Quantity::reflectance);
  if (emitter.boolean("complex_sun", false)) {
    context.warn_once("complex sun", emitter.element(),
                      "the sun's limb is as bright as its middle: complex_sun is ignored");
  }
  const Affine to_world = model_to_world(context, emitter);
  const Vec3 sun = read_sun_direction(emitter, to_world);
  if (sun.z < 0.0f) {
    return context.warn_once("sun below horizon", emitter.element(),
                             "the sun is below the horizon: sky and sun are black");
  }
  const double elevation = std::atan2(double{sun.z}, std::hypot(double{sun.x}, double{sun.y}));
  if (sky_scale > 0.0f) {
    add_sky_map(context, emitter, SkyModel(turbidity, albedo, elevation), sun, sky_scale, to_world);
  }
  const Color irradiance = sun_scale * sun_irradiance(turbidity, elevation);
  if (!is_black(irradiance)) {
    add_sun_disk(context, emitter, irradiance, glm::normalize(to_world.vector(sun)), seen_aperture);
  }
}

}  // namespace pt::mitsuba
