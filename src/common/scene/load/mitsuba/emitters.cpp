// <emitter>s that are not on a shape.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "common/scene/load/files/images/image_files.h"
#include "common/scene/load/files/importer.h"
#include "common/scene/load/mitsuba/scene_parts.h"
#include "common/scene/load/mitsuba/surfaces/textures.h"
#include "common/scene/load/mitsuba/xml/elements.h"

namespace pt::mitsuba {
namespace {

// `envmap`: a picture of all directions.

/// The rotation in a map, by Gram and Schmidt; `mirrored` tells whether the map mirrored as well
/// (in x, before the rotation).
Affine rotation_of(const Affine& map, bool& mirrored) {
  const Vec3 z = glm::normalize(map.vector({0, 0, 1}));
  const Vec3 y = glm::normalize(map.vector({0, 1, 0}) - glm::dot(map.vector({0, 1, 0}), z) * z);
  const Vec3 x = glm::cross(y, z);
  mirrored = map.determinant() < 0.0f;
  Affine rotation;
  for (int i = 0; i < 3; ++i) rotation.row[i] = {x[i], y[i], z[i], 0.0f};
  return rotation;
}

bool is_scaled_rotation(const Affine& map, const Affine& rotation, bool mirrored) {
  const float size = glm::length(map.vector({0, 0, 1}));
  for (int i = 0; i < 3; ++i) {
    Vec3 axis(0.0f);
    axis[i] = 1.0f;
    const float sign = mirrored && i == 0 ? -1.0f : 1.0f;
    if (glm::length(map.vector(axis) / size - sign * rotation.vector(axis)) > 1e-3f) return false;
  }
  return true;
}

/// Of a picture of floats.
Image floats_of(const TextureImage& picture) {
  Image image{static_cast<int>(picture.width), static_cast<int>(picture.height), {}};
  image.rgb.resize(picture.texels.size() / sizeof(float));
  std::memcpy(image.rgb.data(), picture.texels.data(), picture.texels.size());
  return image;
}

std::vector<Color> scaled_pixels(const Image& image, float scale, bool mirrored) {
  const auto width = static_cast<std::size_t>(image.width);
  std::vector<Color> pixels(width * static_cast<std::size_t>(image.height));
  // A picture may hold negative or infinite pixels; light does not.
  const auto light = [&](float v) { return std::isfinite(v) && v > 0.0f ? scale * v : 0.0f; };
  tbb::parallel_for(0, image.height, [&](int y) {
    Color* const row = &pixels[static_cast<std::size_t>(y) * width];
    for (int x = 0; x < image.width; ++x) {
      const float* p = image.pixel(mirrored ? image.width - 1 - x : x, y);
      row[x] = {light(p[0]), light(p[1]), light(p[2])};
    }
  });
  return pixels;
}

/// Fills the scene's environment with an `envmap`.
// Mitsuba's picture begins at -z and goes towards +x, so that its middle column is +z; ours is -z.
// That is half a turn about y.
void add_environment_map(Context& context, const Object& emitter) {
  const Element* filename = emitter.find("filename");
  const TextureImage* data = context.memory_image(emitter);
  if (!filename && !data) fail(emitter.element(), "emitter 'envmap' has no filename");
  const float scale = emitter.number("scale", 1.0f);
  emitter.ignore({"sampling_weight", "cache", "mis_compensation"});
  const Affine to_world = emitter.transform("to_world");
  bool mirrored = false;
  const Affine rotation = rotation_of(to_world, mirrored);
  if (!is_scaled_rotation(to_world, rotation, mirrored)) {
    context.warn_once("envmap shear", emitter.element(),
                      "to_world of 'envmap' is no rotation: the nearest one is used");
  }
  EnvironmentData& environment = context.scene.environment;
  try {
    const Image image =
        data ? floats_of(*data)
             : read_radiance_image(context.resolve(*filename, filename->required("value")));
    environment.width = image.width;
    environment.height = image.height;
    environment.pixels = scaled_pixels(image, scale, mirrored);
  } catch (const Error& error) {
    context.warn_unreadable(*filename, error.what(), "radiance 1 from all sides is used");
    environment.width = environment.height = 1;
    environment.pixels = {Color(scale)};
  }
  environment.to_world = rotation * rotate({0, 1, 0}, 180.0f);
}

/// `projector`: a point light that shows a picture. The picture's pixels are squares across the
/// axis. At distance 1 along that, a plane across it receives pi * scale * irradiance, as in
/// Mitsuba 3.9.
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
                      "spot: beam_width {} and cutoff_angle {}; expected degrees with 0 <= "
                      "beam_width <= cutoff_angle <= 180: {} and {} are used",
                      given_beam, given_cutoff, beam, cutoff);
    if (cutoff == 0.0f) return;
  }
  light.cos_inner = cosine_of_degrees(beam);
  light.cos_outer = cosine_of_degrees(cutoff);
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

}  // namespace

std::vector<std::string> emitter_types() {
  std::vector<std::string> types = {"area", "envmap"};
  for (const auto& entry : adders()) types.emplace_back(entry.first);
  return types;
}

namespace {

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
