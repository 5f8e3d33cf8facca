// Random scenes that are hard on an acceleration structure, each kind in its own way.
#pragma once

#include <algorithm>
#include <functional>
#include <ostream>

#include "common/scene/prepare/prepare_scene.h"
#include "statistics.h"

namespace pt {

inline Vec3 random_point(TestRandom& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

inline void add_sphere(SceneData& scene, TestRandom& random, const Vec3& center, double size) {
  scene.add_sphere(center, static_cast<float>(random.log_uniform(0.01, 1) * size), 0);
}

inline void add_quad(SceneData& scene, TestRandom& random, const Vec3& corner, double size) {
  Vec3 a = random_point(random, size), b = random_point(random, size);
  if (random.bits() % 2) a.y = b.y = 0;  // a flat box
  scene.add_quad(corner, a, b, 0);
}

inline const Vec3 far_away(1000, -700, 300);

struct SceneKind {
  const char* name;
  std::function<void(SceneData&, TestRandom&, int count)> fill;
};

inline void PrintTo(const SceneKind& kind, std::ostream* out) { *out << kind.name; }

inline const SceneKind scene_kinds[] = {
    {"spheres",
     [](SceneData& scene, TestRandom& random, int n) {
       for (int i = 0; i < n; ++i) add_sphere(scene, random, random_point(random, 10), 2);
     }},
    {"quads",
     [](SceneData& scene, TestRandom& random, int n) {
       for (int i = 0; i < n; ++i) add_quad(scene, random, random_point(random, 10), 2);
     }},
    {"mixed_with_a_ground",
     [](SceneData& scene, TestRandom& random, int n) {
       for (int i = 0; i < n; ++i) {
         const Vec3 p = random_point(random, 10);
         random.bits() % 3 ? add_sphere(scene, random, p, 1) : add_quad(scene, random, p, 3);
       }
       scene.add_sphere({0, -1010, 0}, 1000, 0);
     }},
    {"coincident",
     [](SceneData& scene, TestRandom& random, int n) {
       for (int i = 0; i < (n + 1) / 2; ++i) {
         const Vec3 p = random_point(random, 5);
         random.bits() % 2 ? add_sphere(scene, random, p, 2) : add_quad(scene, random, p, 2);
       }
       const std::size_t spheres = scene.spheres.size(), quads = scene.quads.size();
       for (std::size_t i = 0; i < spheres; ++i) {
         scene.spheres.push_back(Sphere(scene.spheres[i]));
         scene.sphere_material.push_back(0);
       }
       for (std::size_t i = 0; i < quads; ++i) {
         scene.quads.push_back(Quad(scene.quads[i]));
         scene.quad_material.push_back(0);
       }
     }},
    {"concentric",
     [](SceneData& scene, TestRandom& random, int n) {
       for (int i = 0; i < n; ++i) {
         const Vec3 a = random_point(random, 2), b = random_point(random, 2);
         random.bits() % 2 ? add_sphere(scene, random, {1, 2, 3}, 3)
                           : scene.add_quad(Vec3(1, 2, 3) - 0.5f * (a + b), a, b, 0);
       }
     }},
    {"far_from_the_origin",
     [](SceneData& scene, TestRandom& random, int n) {
       for (int i = 0; i < n; ++i) {
         const Vec3 p = far_away + random_point(random, 10);
         scene.add_sphere(p, static_cast<float>(random.log_uniform(0.1, 1)), 0);
       }
     }},
    {"ever_farther_apart",  // a splitting plane separates one at a time
     [](SceneData& scene, TestRandom&, int n) {
       for (int i = 0; i < n; ++i) {
         const float x = std::ldexp(0.01f, std::min(i, 40) / 2);
         scene.add_sphere({x, 0.5f * x, 0}, 0.1f * x, 0);
       }
     }},
};

inline SceneData make_random_scene(const SceneKind& kind, int count) {
  SceneData scene;
  scene.name = kind.name;
  scene.add_material(MaterialDescription());
  TestRandom random(static_cast<std::uint64_t>(count));
  kind.fill(scene, random, count);
  scene.camera.look_from = {12, 12, 12};
  Options options;
  options.accel = AccelKind::bvh2;
  prepare_scene(scene, options);
  return scene;
}

}  // namespace pt
