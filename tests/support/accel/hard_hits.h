// Meshes and rays at which structures would part if a box could hide a hit: what is met, and where,
// is decided by the last bits.
#pragma once

#include <array>

#include "accel/triangle_rays.h"
#include "common/geometry/mesh.h"
#include "common/rays/ray_file.h"

namespace pt {

/// Slivers of aspect 10^6, some along the axes, all over a cube.
inline Mesh make_slivers(int count) {
  TestRandom random(71);
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3 a = point_in_cube(random, 10);
    Vec3 along = point_in_cube(random, 8);
    if (i % 3 == 0) along = {along.x, 0, 0};
    const Vec3 b = a + along;
    add_triangle(mesh, a, b, a + random.unit() * along + 1e-6f * point_in_cube(random, 8));
  }
  return mesh;
}

/// Fans whose needles share their tips.
inline Mesh make_fans(int count) {
  TestRandom random(72);
  Mesh mesh;
  for (int i = 0; i < count;) {
    const Vec3 tip = point_in_cube(random, 10), axis = point_in_cube(random, 10);
    Vec3 last = tip + axis;
    for (int k = 0; k < 20 && i < count; ++k, ++i) {
      const Vec3 next = last + 1e-3f * point_in_cube(random, 1);
      add_triangle(mesh, tip, last, next);
      last = next;
    }
  }
  return mesh;
}

/// Sheets in nearly one plane, slanted and straight, 1 ulp to 1e-3 apart.
inline Mesh make_sheets(int count) {
  TestRandom random(73);
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const bool slanted = i % 2 == 0;
    const auto height = [&](float x, float y, float gap) {
      return (slanted ? 0.3f * x - 0.7f * y : 5.0f) + gap;
    };
    const float gap = i % 4 < 2 ? 5e-7f * static_cast<float>(random.below(4))
                                : 1e-3f * random.unit() * random.unit();
    Vec3 v[3];
    for (Vec3& p : v) {
      p = point_in_cube(random, 10);
      p.z = height(p.x, p.y, gap);
    }
    add_triangle(mesh, v[0], v[1], v[2]);
  }
  return mesh;
}

/// A floor of two triangles, 2000 units wide, with specks on it; some lie in its plane.
inline Mesh make_huge_beside_tiny(int count) {
  TestRandom random(74);
  Mesh mesh;
  add_triangle(mesh, {-1000, 0, -1000}, {1000, 0, -1000}, {1000, 0, 1000});
  add_triangle(mesh, {-1000, 0, -1000}, {1000, 0, 1000}, {-1000, 0, 1000});
  for (int i = 2; i < count; ++i) {
    Vec3 p = point_in_cube(random, 10);
    p.y = i % 3 == 0 ? 0.0f : 1e-3f * random.unit();
    const auto speck = [&] {
      const Vec3 by = point_in_cube(random, 1e-2);
      return p + (i % 3 == 0 ? Vec3(by.x, 0, by.z) : by);
    };
    const Vec3 q = speck();
    add_triangle(mesh, p, q, speck());
  }
  return mesh;
}

inline const MeshKind hard_mesh_kinds[] = {
    {"slivers", make_slivers},
    {"fans", make_fans},
    {"sheets", make_sheets},
    {"huge_beside_tiny", make_huge_beside_tiny},
    {"slivers_far_away",
     [](int n) {
       return moved(make_slivers(n), 1, {3e4f, -1e4f, 5e4f});
     }},
    {"sheets_far_away",
     [](int n) {
       return moved(make_sheets(n), 1, {-2e3f, 7e3f, 1e4f});
     }},
    {"tiny_fans",
     [](int n) {
       return moved(make_fans(n), 1e-4f, {0.1f, 0.2f, 0.3f});
     }},
    {"needles", make_needles},
    {"slanted", make_slanted},
    {"coincident", make_coincident},
    {"flat_grid", [](int n) { return make_flat_grid(strips(2 * n)); }},
    {"soup", [](int n) { return make_soup(n, 3); }},
};

/// From beside a surface: as far away as rounding puts it, or as new rays begin.
inline Ray leaving_ray(const Target& target, TestRandom& random) {
  const Vec3 from = target.on_surface(random);
  const float off = target.size() * static_cast<float>(random.log_uniform(1e-8, 1e-5));
  Vec3 toward = point_in_cube(random, 1);
  if (random.bits() % 4 == 0) toward = target.along_surface(random) + 1e-5f * toward;
  return {from + off * Vec3(random.direction()), ray_to(Vec3(0.0f), toward).direction};
}

/// Rays of all kinds, `each` of a kind.
inline RaySet hard_rays(const Mesh& mesh, int each, RayType type = RayType::closest) {
  const Target target(mesh);
  TestRandom random(75);
  RaySet rays;
  rays.type = type;
  const auto add = [&](const Ray& ray) {
    rays.rays.push_back({ray.origin, 0.0f, ray.direction, infinite_distance});
  };
  for (const auto& kind : ray_kinds) {
    for (int i = 0; i < each; ++i) add(kind.make(target, random));
  }
  for (int i = 0; i < 3 * each; ++i) add(leaving_ray(target, random));
  return rays;
}

/// Instances that turn, stretch and mirror their group, each twice.
inline std::vector<Instance> hard_instances(int count) {
  TestRandom random(76);
  std::vector<Instance> instances;
  for (int i = 0; i < count; ++i) {
    const float mirror = i % 2 == 0 ? 1.0f : -1.0f;
    const Affine place = translate(point_in_cube(random, i % 3 == 0 ? 0 : 30)) *
                         rotate(point_in_cube(random, 1), i % 4 < 2 ? 90.0f : 37.0f) *
                         scale({0.1f + random.unit(), 1.0f, 0.01f + mirror * random.unit()});
    instances.insert(instances.end(), {{1, place}, {1, place}});
  }
  return instances;
}

}  // namespace pt
