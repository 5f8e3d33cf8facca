// `envmap`: a picture of all directions.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/load/files/images/image_files.h"
#include "common/scene/load/mitsuba/emitters.h"
#include "common/scene/load/mitsuba/surfaces/textures.h"
#include "common/scene/load/mitsuba/xml/transforms.h"

namespace pt::mitsuba {
namespace {

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

std::vector<Color> scaled_pixels(const Image& image, float scale, bool mirrored) {
  std::vector<Color> pixels;
  pixels.reserve(static_cast<std::size_t>(image.width) * image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float* p = image.pixel(mirrored ? image.width - 1 - x : x, y);
      // A picture may hold negative or infinite pixels; light does not.
      const auto light = [&](float v) { return std::isfinite(v) && v > 0.0f ? scale * v : 0.0f; };
      pixels.push_back({light(p[0]), light(p[1]), light(p[2])});
    }
  }
  return pixels;
}

}  // namespace

// Mitsuba's picture begins at -z and goes towards +x, so that its middle column is +z; ours is -z.
// That is half a turn about y.
void add_environment_map(Context& context, const Object& emitter) {
  const Element* filename = emitter.find("filename");
  if (!filename) fail(emitter.element(), "emitter 'envmap' has no filename");
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
    const auto path = context.resolve(*filename, filename->required("value"));
    const Image image = read_radiance_image(path);
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

}  // namespace pt::mitsuba
