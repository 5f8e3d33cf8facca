// A closed room of size 2 with one lamp of any kind, anywhere and of any size.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "common/scene/prepare/prepare_scene.h"

namespace pt {

enum class Lamp {
  triangles,        ///< two, as a mesh of the world
  quad,             ///< in a room of quads: Lighting::emitters
  sphere,           ///< in a room of quads: Lighting::emitters
  listed_sphere,    ///< beside triangles: Lighting::full
  instance,         ///< a mesh, turned and stretched unevenly
  mirror_instance,  ///< the same, mirrored
  point,
  spot
};

inline constexpr Lamp area_lamps[] = {Lamp::triangles,     Lamp::quad,     Lamp::sphere,
                                      Lamp::listed_sphere, Lamp::instance, Lamp::mirror_instance};

inline std::string name_of(Lamp lamp) {
  constexpr const char* names[] = {"triangles",     "quad",     "sphere",
                                   "listed sphere", "instance", "mirror instance",
                                   "point",         "spot"};
  return names[static_cast<int>(lamp)];
}

/// Where a room lies: x in room coordinates is at scale * (x + d) in each axis.
struct RoomPlace {
  float d = 0.0f, scale = 1.0f;

  Vec3 at(const Vec3& p) const { return scale * (p + d); }
};

/// Corner, edges; the front faces cross(a, b). All numbers are multiples of 1/8, so that floats
/// hold them at every d up to 10^6.
inline Mesh parallelogram(const RoomPlace& place, const Vec3& corner, const Vec3& a, const Vec3& b,
                          std::uint32_t material) {
  Mesh mesh;
  mesh.positions = {place.at(corner), place.at(corner + a), place.at(corner + a + b),
                    place.at(corner + b)};
  mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  mesh.material = material;
  return mesh;
}

inline void add_lamp(SceneData& scene, Lamp lamp, const RoomPlace& place, std::uint32_t glow) {
  const Vec3 corner(-0.5f, 0.875f, -0.5f), a(1, 0, 0), b(0, 0, 1);  // faces down
  const Vec3 middle(0, 0.875f, 0);
  DeltaLight delta;
  delta.position = place.at({0.25f, 0.75f, 0});
  delta.intensity = Color(place.scale * place.scale);
  switch (lamp) {
    case Lamp::triangles:
      scene.meshes.push_back(parallelogram(place, corner, a, b, glow));
      break;
    case Lamp::quad:
      scene.add_quad(place.at(corner), place.scale * a, place.scale * b, glow);
      break;
    case Lamp::sphere:
    case Lamp::listed_sphere:
      scene.add_sphere(place.at({0, 0.5f, 0}), 0.375f * place.scale, glow);
      break;
    case Lamp::point:
      scene.delta_lights.push_back(delta);
      break;
    case Lamp::spot:
      delta.kind = LightKind::spot;
      delta.direction = {0, -1, 0};
      delta.cos_inner = 0.9f, delta.cos_outer = 0.3f;
      scene.delta_lights.push_back(delta);
      break;
    default: {
      const float mirror = lamp == Lamp::mirror_instance ? -1.0f : 1.0f;
      scene.meshes.push_back(parallelogram({0, 1}, {-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, glow));
      scene.meshes.back().group = 1;
      const Vec3 stretch = place.scale * Vec3(0.5f * mirror, 2.0f, 0.4f);
      scene.instances.push_back(
          {1, translate(place.at(middle)) * rotate({0, 1, 0}, 30) * scale(stretch)});
    }
  }
}

/// Not prepared. The room's walls reflect a half.
inline SceneData lamp_room(Lamp lamp, const RoomPlace& place) {
  SceneData scene;
  scene.name = name_of(lamp) + " at " + std::to_string(place.d);
  const std::uint32_t wall = scene.add_material(make_diffuse(Color(0.5f)));
  const std::uint32_t glow = scene.add_material(make_diffuse(Color(0.0f), Color(3, 2, 1)));
  const bool quads = lamp == Lamp::quad || lamp == Lamp::sphere;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 a(0.0f), b(0.0f);
    a[(axis + 1) % 3] = 2, b[(axis + 2) % 3] = 2;
    for (const float side : {-1.0f, 1.0f}) {
      Vec3 corner(-1.0f);
      corner[axis] = side;
      if (quads) {
        scene.add_quad(place.at(corner), place.scale * a, place.scale * b, wall);
      } else {
        scene.meshes.push_back(parallelogram(place, corner, a, b, wall));
      }
    }
  }
  add_lamp(scene, lamp, place, glow);
  scene.camera = {
      place.at({0, -0.125f, 0.875f}), place.at({0, -0.25f, 0}), {0, 1, 0}, 70.0f, 0.0f, 1.0f};
  return scene;
}

}  // namespace pt
