#include "common/scene/load/pbrt/media/sample_box.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/scene/load/pbrt/description/transforms.h"

namespace pt::pbrt {
namespace {

Vec3 size_of(const SampleBox& box) { return Vec3(box.size[0], box.size[1], box.size[2]); }

/// From the cube [0, 1]^3 to the world.
Affine cube_to_world(const SampleBox& box) {
  return box.to_world * translate(box.low) * scale(box.high - box.low);
}

std::uint32_t read_side_of_grid(const Parameters& parameters, const char* name) {
  constexpr int most = 1 << 16;
  const int side = parameters.integer(name, 1);
  if (side >= 1 && side <= most) return static_cast<std::uint32_t>(side);
  fail(parameters.find(name)->place,
       fmt::format("'integer {}' of {}; expected 1 to {} samples", name, side, most));
}

}  // namespace

Vec3 SampleBox::center(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
  return low + (high - low) * (Vec3(i, j, k) + Vec3(0.5f)) / size_of(*this);
}

SampleBox read_box(const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  const Vec3 p0 = parameters.point("p0", Vec3(0.0f)), p1 = parameters.point("p1", Vec3(1.0f));
  SampleBox box;
  box.low = glm::min(p0, p1), box.high = glm::max(p0, p1);
  box.to_world = entity.to_world;
  if (!is_invertible(cube_to_world(box))) {
    fail(parameters.place(),
         fmt::format("{}: a grid without volume; expected p0 and p1 that differ in all "
                     "coordinates, and a transformation that has an inverse",
                     parameters.what()));
  }
  return box;
}

SampleBox read_sample_box(const Entity& entity) {
  SampleBox box = read_box(entity);
  const char* const names[] = {"nx", "ny", "nz"};
  for (int axis = 0; axis < 3; ++axis) {
    box.size[axis] = read_side_of_grid(entity.parameters, names[axis]);
  }
  return box;
}

std::vector<float> channels_of(const std::vector<Color>& colors, std::uint32_t channels) {
  std::vector<float> values;
  values.reserve(colors.size() * channels);
  for (const Color& c : colors) {
    values.push_back(c.x);
    if (channels == 3) values.insert(values.end(), {c.y, c.z});
  }
  return values;
}

VolumeData plain_volume(const SampleBox& box, std::uint32_t channels, std::vector<float> values) {
  VolumeData volume;
  std::copy(std::begin(box.size), std::end(box.size), std::begin(volume.size));
  volume.channels = channels;
  volume.values = std::move(values);
  volume.to_world = cube_to_world(box);
  return volume;
}

VolumeData faded_volume(const SampleBox& box, std::uint32_t channels,
                        const std::vector<float>& values) {
  return with_rim_of_zeros(plain_volume(box, channels, values));
}

}  // namespace pt::pbrt
