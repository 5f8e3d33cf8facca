// The random sphere scenes, built by one function on the host or by one thread of the device's
// create_world kernel, as in the paper. Products and sums are rounded one by one, so that both
// give the same bits.
#pragma once

#include "common/geometry/sphere.h"
#include "common/sampling/random.h"
#include "common/sampling/warp.h"
#include "common/scene/data/material_description.h"

namespace pt {

enum class SphereWorldKind { spheres, rtow };

/// Receives up to `capacity` spheres with a material each.
struct SphereWorld {
  Sphere* spheres;
  MaterialDescription* materials;
  std::uint32_t capacity;
  std::uint32_t count = 0;

  PT_HD void add(const Vec3& center, float radius, const MaterialDescription& material) {
    if (count == capacity) return;
    spheres[count] = {center, radius * radius};
    materials[count] = material;
    ++count;
  }
};

/// Random numbers of object `index`, independent of how many others there are.
class WorldRandom {
 public:
  PT_HD explicit WorldRandom(std::uint32_t index) : index_(index) {}

  PT_HD float next() {
    if (used_ == 4) {
      const Uint4 bits = philox4x32_10({block_++, 0, index_, 0}, seed, 0);
      values_ = {to_unit_float(bits.x), to_unit_float(bits.y), to_unit_float(bits.z),
                 to_unit_float(bits.w)};
      used_ = 0;
    }
    return values_[used_++];
  }

  /// lo + u (hi - lo)
  PT_HD float next(float lo, float hi) { return lo + next() * (hi - lo); }

 private:
  static constexpr std::uint32_t seed = 1984;  // the CUDA port's seed of its world
  std::uint32_t index_;
  std::uint32_t block_ = 0;
  int used_ = 4;
  Vec4 values_ = Vec4(0.0f);
};

PT_HD Color random_diffuse_albedo(WorldRandom& random) {
  Color albedo;
  for (int i = 0; i < 3; ++i) albedo[i] = random.next() * random.next();
  return albedo;
}

PT_HD MaterialDescription random_metal(WorldRandom& random) {
  Color albedo;
  for (int i = 0; i < 3; ++i) albedo[i] = random.next(0.5f, 1.0f);
  return make_metal(albedo, random.next(0.0f, 0.5f));
}

inline constexpr float ground_radius = 1000.0f;

PT_HD void add_ground(SphereWorld& world) {
  world.add({0.0f, -ground_radius, 0.0f}, ground_radius, make_diffuse(Color(0.5f)));
}

/// A sphere's height when it touches the ground sphere at horizontal distance (x, z).
PT_HD float height_on_ground(float x, float z, float radius) {
  const float distance2 = x * x + z * z;
  return radius - distance2 * (0.5f / ground_radius);
}

/// The paper's scene: a ground and `count` random spheres, 70 % diffuse and 30 % metal. They are
/// spread evenly by the R2 sequence (Roberts 2018) over a square whose area grows with their
/// number.
PT_HD void create_spheres(SphereWorld& world, std::uint32_t count) {
  add_ground(world);
  const float side = 1.3f * sqrtf(static_cast<float>(count));
  for (std::uint32_t i = 0; i < count; ++i) {
    WorldRandom random(i);
    const float radius = random.next(0.2f, 0.45f);
    const float x = (to_unit_float(3242174889u * i) - 0.5f) * side;
    const float z = (to_unit_float(2447445414u * i) - 0.5f) * side;
    const bool metal = random.next() < 0.3f;
    world.add({x, height_on_ground(x, z, radius), z}, radius,
              metal ? random_metal(random) : make_diffuse(random_diffuse_albedo(random)));
  }
}

/// The final scene of 'Ray Tracing in One Weekend': a grid of small spheres around three large
/// ones.
PT_HD void create_rtow(SphereWorld& world) {
  add_ground(world);
  for (int a = -11; a < 11; ++a) {
    for (int b = -11; b < 11; ++b) {
      WorldRandom random(static_cast<std::uint32_t>((a + 11) * 22 + b + 11));
      const float x = static_cast<float>(a) + 0.9f * random.next();
      const float z = static_cast<float>(b) + 0.9f * random.next();
      const float choice = random.next();
      const float dx = x - 4.0f;
      // Not inside the large metal sphere.
      if (dx * dx + z * z <= 0.81f) continue;
      const MaterialDescription material = choice < 0.8f
                                               ? make_diffuse(random_diffuse_albedo(random))
                                           : choice < 0.95f ? random_metal(random)
                                                            : make_dielectric(Color(1.0f), 1.5f);
      world.add({x, 0.2f, z}, 0.2f, material);
    }
  }
  world.add({0.0f, 1.0f, 0.0f}, 1.0f, make_dielectric(Color(1.0f), 1.5f));
  world.add({-4.0f, 1.0f, 0.0f}, 1.0f, make_diffuse({0.4f, 0.2f, 0.1f}));
  world.add({4.0f, 1.0f, 0.0f}, 1.0f, make_metal({0.7f, 0.6f, 0.5f}, 0.0f));
}

PT_HD void create_sphere_world(SphereWorld& world, SphereWorldKind kind, std::uint32_t count) {
  kind == SphereWorldKind::spheres ? create_spheres(world, count) : create_rtow(world);
}

/// No world of this kind has more spheres.
PT_HD std::uint32_t sphere_world_capacity(SphereWorldKind kind, std::uint32_t count) {
  return kind == SphereWorldKind::spheres ? count + 1 : 22 * 22 + 4;
}

}  // namespace pt
