// Light from infinitely far: a constant, or a picture of all directions that is resampled to our
// map.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/load/files/images/image_files.h"
#include "common/scene/load/pbrt/description/transforms.h"
#include "common/scene/load/pbrt/lights/equal_area.h"
#include "common/scene/load/pbrt/lights/lights.h"

namespace pt::pbrt {
namespace {

constexpr int most_columns = 4096;
constexpr int samples = 4;  // of a pixel of our map, along each side

struct Picture {
  Image image;
  bool is_equal_area = true;  ///< else by longitude and latitude, as earlier versions have it

  Color at(const Vec3& d) const {
    Vec2 uv = equal_area_square(d);
    if (!is_equal_area) {
      const float phi = std::atan2(d.y, d.x);
      uv = {phi * 0.5f * inverse_pi + (phi < 0.0f ? 1.0f : 0.0f),
            std::acos(glm::clamp(d.z, -1.0f, 1.0f)) * inverse_pi};
    }
    const auto cell = [](float t, int n) {
      return std::clamp(static_cast<int>(t * static_cast<float>(n)), 0, n - 1);
    };
    const float* p = image.pixel(cell(uv.x, image.width), cell(uv.y, image.height));
    const auto light = [](float v) { return std::isfinite(v) && v > 0.0f ? v : 0.0f; };
    return {light(p[0]), light(p[1]), light(p[2])};
  }
};

Picture read_picture(const std::filesystem::path& path, const Place& place) {
  Picture picture;
  try {
    picture.image = read_radiance_image(path);
  } catch (const Error& error) {
    fail(place, error.what());
  }
  const auto& [image, equal_area] = picture;
  if (image.width != image.height) {
    if (image.width != 2 * image.height) {
      fail(place, fmt::format("{}: {}x{} pixels; expected a square, in pbrt's equal-area map, or "
                              "twice as wide as high",
                              path.string(), image.width, image.height));
    }
    picture.is_equal_area = false;
  }
  return picture;
}

/// Of the picture around a pixel of our map, which lies in the world as it is.
Color mean_around(const Picture& picture, const Affine& to_light, const EnvironmentData& map, int x,
                  int y) {
  Color sum(0.0f);
  for (int j = 0; j < samples; ++j) {
    const double row = y + (j + 0.5) / samples - 0.5;
    const double theta = std::clamp(row / (map.height - 1), 0.0, 1.0) * double{pi};
    for (int i = 0; i < samples; ++i) {
      const double phi = 2 * double{pi} * ((x + (i + 0.5) / samples) / map.width - 0.5);
      const Vec3 d(std::sin(theta) * std::sin(phi), std::cos(theta),
                   -std::sin(theta) * std::cos(phi));
      sum += picture.at(glm::normalize(to_light.vector(d)));
    }
  }
  return sum / static_cast<float>(samples * samples);
}

/// As pbrt computes it of an equal-area map, with a solid angle of 2 pi over the number of its
/// pixels for each: half of the light that falls on a surface that faces +z.
double illuminance_of(const Picture& picture) {
  constexpr int rows = 512, columns = 1024;
  double sum = 0;
  for (int j = 0; j < rows; ++j) {
    const double z = (j + 0.5) / rows, r = std::sqrt(1 - z * z);
    for (int i = 0; i < columns; ++i) {
      const double phi = 2 * double{pi} * (i + 0.5) / columns;
      const Color c = picture.at(Vec3(r * std::cos(phi), r * std::sin(phi), z));
      sum += z * double{dot(c, Color(0.2126f, 0.7152f, 0.0722f))};
    }
  }
  return double{pi} * sum / (double{rows} * columns);
}

void add_picture(Context& context, const Entity& entity, const Picture& picture, float scale) {
  const Affine to_light = inverse(entity.to_world);
  EnvironmentData& map = context.scene.environment;
  const int side = picture.is_equal_area ? 2 * picture.image.width : picture.image.width;
  map.width = std::clamp(side, 64, most_columns);
  map.height = map.width / 2 + 1;
  map.pixels.clear();
  map.pixels.reserve(static_cast<std::size_t>(map.width) * map.height);
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      map.pixels.push_back(scale * mean_around(picture, to_light, map, x, y));
    }
  }
  map.to_world = {};
}

}  // namespace

void add_infinite(Context& context, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  if (const Parameter* portal = parameters.find("portal")) {
    context.reporter.warn_once("portal", portal->place,
                               "'portal' of an infinite light is not supported: its light comes "
                               "from all around");
  }
  const float scale = read_light_scale(context, parameters);
  const float illuminance = parameters.number("illuminance", 0.0f);
  const Parameter* filename = parameters.find("filename", {"string"});
  const bool has_color = parameters.find("L") != nullptr;
  if (!filename) {
    const Color white = to_srgb(Color(1.0f), entity.space);
    const Color radiance = scale * (illuminance > 0.0f ? illuminance / pi : 1.0f) *
                           read_color(context, parameters, "L", white, Quantity::illuminant);
    context.scene.sky.nadir += radiance;
    context.scene.sky.zenith += radiance;
    return;
  }
  if (has_color) fail(filename->place, "an infinite light of both 'L' and 'filename'");
  if (context.scene.environment.width > 0) {
    return context.reporter.warn_once("environments", parameters.place(),
                                      "more than one infinite light with a picture: the first is "
                                      "used");
  }
  if (!is_invertible(entity.to_world)) {
    fail(parameters.place(), "an infinite light whose transformation has no inverse");
  }
  const Picture picture = read_picture(
      context.resolve(filename->place, parameters.text("filename", "")), filename->place);
  double factor = 1;
  if (illuminance > 0.0f) {
    const double own = illuminance_of(picture);
    if (own > 0) factor = illuminance / own;
  }
  add_picture(context, entity, picture, scale * static_cast<float>(factor));
}

}  // namespace pt::pbrt
