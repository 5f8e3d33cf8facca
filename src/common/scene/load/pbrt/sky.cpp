// Light from infinitely far: a constant, or a picture of all directions that is resampled to our
// map.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/math/vec.h"
#include "common/scene/load/files/images/image_files.h"
#include "common/scene/load/pbrt/scene_parts.h"
#include "common/scene/load/pbrt/syntax/description.h"

namespace pt::pbrt {
namespace {

/// pbrt's map of the sphere to a square that keeps areas (Clarberg 2008, 'Fast Equal-Area Mapping
/// of the (Hemi)Sphere using SIMD'): the point of the unit square for a unit vector; the upper
/// hemisphere, +z, is the square whose corners lie in the middle of the edges.
Vec2 equal_area_square(const Vec3& direction) {
  const double x = std::abs(direction.x), y = std::abs(direction.y);
  const double r = std::sqrt(std::max(0.0, 1.0 - std::abs(double{direction.z})));
  const double turn = x == 0 && y == 0 ? 0 : std::atan2(y, x) * 2 / double{pi};  // of a quadrant
  double v = turn * r, u = r - v;
  if (direction.z < 0.0f) {
    std::swap(u, v);
    u = 1 - u, v = 1 - v;
  }
  return {0.5 * (std::copysign(u, double{direction.x}) + 1),
          0.5 * (std::copysign(v, double{direction.y}) + 1)};
}

constexpr int most_columns = 4096;
constexpr std::size_t most_pictures = 16;  // each is looked up for all of our map
constexpr int samples = 4;                 // of a pixel of our map, along each side

/// A square is pbrt-v4's map; 'mapname' is pbrt-v3's.
SkyPicture read_picture(Context& context, const std::filesystem::path& path,
                        const Parameter& filename) {
  SkyPicture picture;
  picture.image = read_radiance_image(path);
  const Image& image = picture.image;
  picture.is_equal_area = image.width == image.height && filename.name == "filename";
  if (!picture.is_equal_area && image.width != 2 * image.height) {
    context.reporter.warn_once("sky shape", filename.place,
                               "{}: {}x{} pixels are taken for longitude and latitude; expected a "
                               "square, in pbrt's equal-area map, or twice as wide as high",
                               path.string(), image.width, image.height);
  }
  return picture;
}

/// The mean of the picture over a pixel of our map, which lies in world space.
Color mean_around(const SkyPicture& picture, const EnvironmentData& map, int x, int y) {
  Color sum(0.0f);
  for (int j = 0; j < samples; ++j) {
    const double row = y + (j + 0.5) / samples - 0.5;
    const double theta = std::clamp(row / (map.height - 1), 0.0, 1.0) * double{pi};
    for (int i = 0; i < samples; ++i) {
      const double phi = 2 * double{pi} * ((x + (i + 0.5) / samples) / map.width - 0.5);
      const Vec3 d(std::sin(theta) * std::sin(phi), std::cos(theta),
                   -std::sin(theta) * std::cos(phi));
      sum += picture.at(glm::normalize(picture.to_light.vector(d)));
    }
  }
  return sum / static_cast<float>(samples * samples);
}

/// As pbrt computes it of an equal-area map, with a solid angle of 2 pi over the number of its
/// pixels for each: half of the light that falls on a surface that faces +z.
double illuminance_of(const SkyPicture& picture) {
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

int columns_for(const SkyPicture& picture) {
  const int width = picture.image.width;
  return std::clamp(picture.is_equal_area ? 2 * width : width, 64, most_columns);
}

}  // namespace

Color SkyPicture::at(const Vec3& d) const {
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

void SkyLights::add(Context& context, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  if (const Parameter* portal = parameters.find("portal")) {
    context.reporter.warn_once(
        "portal", portal->place,
        "'portal' of an infinite light is not supported: its light comes from all around");
  }
  Color scale = read_light_scale(context, parameters);
  const float illuminance = parameters.number("illuminance", 0.0f);
  const Parameter* filename = find_picture(parameters);
  const bool is_earlier = filename && filename->name == "mapname";
  const Color white = to_srgb(Color(1.0f), entity.space);
  if (filename && !is_earlier && parameters.find("L")) {
    context.reporter.warn_once("L of a picture", filename->place,
                               "an infinite light of both 'L' and 'filename': 'L' is ignored");
  } else {
    scale *=
        read_color(context, parameters, "L", filename ? Color(1.0f) : white, Quantity::illuminant);
  }
  if (filename) {
    if (pictures_.size() == most_pictures) {
      fail(filename->place, "more than {} infinite lights with pictures", most_pictures);
    }
    if (!is_invertible(entity.to_world)) {
      fail(parameters.place(), "an infinite light whose transformation has no inverse");
    }
    const bool has_picture = attempt_file(context, *filename, "a constant sky", [&] {
      const std::string name = parameters.text(filename->name, "");
      SkyPicture picture = read_picture(context, context.resolve(filename->place, name), *filename);
      const double own = illuminance > 0.0f ? illuminance_of(picture) : 0.0;
      picture.scale = scale * (own > 0 ? static_cast<float>(illuminance / own) : 1.0f);
      picture.to_light = inverse(entity.to_world);
      pictures_.push_back(std::move(picture));
    });
    if (has_picture) return;
    // Its scale is nothing without it: half of white in the image.
    if (!(illuminance > 0.0f)) scale = Color(0.5f);
  }
  const Color radiance = scale * (illuminance > 0.0f ? illuminance / pi : 1.0f);
  context.scene.sky.nadir += radiance;
  context.scene.sky.zenith += radiance;
}

void SkyLights::store(SceneData& scene) const {
  if (pictures_.empty()) return;
  EnvironmentData& map = scene.environment;
  map.width = 0;
  for (const SkyPicture& picture : pictures_) map.width = std::max(map.width, columns_for(picture));
  map.height = map.width / 2 + 1;
  map.pixels.assign(static_cast<std::size_t>(map.width) * map.height, Color(0.0f));
  tbb::parallel_for(0, map.height, [&](int y) {
    for (int x = 0; x < map.width; ++x) {
      Color& sum = map.pixels[static_cast<std::size_t>(y) * map.width + x];
      for (const SkyPicture& picture : pictures_) {
        sum += picture.scale * mean_around(picture, map, x, y);
      }
    }
  });
  map.to_world = {};
}

}  // namespace pt::pbrt
