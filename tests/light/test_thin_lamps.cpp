// No lamp shadows itself: those that are far smaller than their distance, and slivers. Unlike those
// of test_far_lights.cpp they lie at any angle.
#include <gtest/gtest.h>

#include "common/accel/embree/embree_tree.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/transport/shade_surface.h"
#include "statistics.h"

namespace pt {
namespace {

/// A triangle of length 1 that shines, anywhere.
struct ThinLamp {
  Vec3 v[3];

  /// `aspect`: its length over its height, about; `far`: its distance from the scene's origin.
  ThinLamp(double aspect, double far, TestRandom& random) {
    const glm::dvec3 along = random.direction(), across = random.direction() / aspect;
    v[0] = Vec3(far * random.direction());
    v[1] = v[0] + Vec3(along);
    v[2] = v[0] + Vec3(random.uniform(0, 1) * along + across);
  }

  SceneData scene(AccelKind accel) const {
    SceneData scene;
    Mesh mesh;
    mesh.positions = {v[0], v[1], v[2]};
    mesh.triangles = {{{0, 1, 2}}};
    mesh.material = scene.add_material(make_diffuse(Color(0.0f), Color(3, 2, 1)));
    scene.meshes.push_back(mesh);
    Options options;
    options.accel = accel;
    prepare_scene(scene, options);
    return scene;
  }

  /// A surface that faces the lamp, up to 1,000 times as far away as the lamp is long.
  SurfacePoint receiver(TestRandom& random) const {
    const glm::dvec3 from_lamp = random.direction();
    const Vec3 position = 0.5f * (v[0] + v[1]) + Vec3(random.log_uniform(0.1, 1e3) * from_lamp);
    return {position, Vec3(-from_lamp), 16.0f * half_ulp * max_abs(position)};
  }
};

struct Shadows {
  int asked = 0, blocked = 0;
};

template <Accel accel>
void ask(const ThinLamp& lamp, AccelKind kind, TestRandom random, Shadows& shadows) {
  using FullTraits = Traits<accel, Geometry::mixed, Lighting::full>;
  const SceneData data = lamp.scene(kind);
  const Scene scene = host_view(data, 8, 8);
  for (int i = 0; i < 1000; ++i) {
    const SurfacePoint point = lamp.receiver(random);
    const Vec3 from = spawn_origin(point, point.normal);
    const Vec4 u(random.unit(), random.unit(), random.unit(), random.unit());
    const IncidentLight light = sample_light<FullTraits>(scene, from, {}, u);
    if (light.pdf <= 0 || glm::dot(light.wi, point.normal) <= 0) continue;
    ++shadows.asked;
    const ShadowRay shadow = spawn_shadow_ray<FullTraits>(point, from, light, Color(1.0f));
    shadows.blocked += intersect_shadow<FullTraits>(scene, shadow);
  }
}

template <Accel accel>
void expect_no_shadows(AccelKind kind, std::initializer_list<double> aspects) {
  for (const double aspect : aspects) {
    for (const double far : {0.0, 1e2, 1e3}) {
      TestRandom random(6);
      Shadows shadows;
      for (int i = 0; i < 40; ++i) {
        const ThinLamp lamp(aspect, far, random);
        ask<accel>(lamp, kind, random, shadows);
      }
      EXPECT_GT(shadows.asked, 15000);
      EXPECT_EQ(shadows.blocked, 0) << "aspect " << aspect << " at " << far;
    }
  }
}

// The bound of a hit (docs/design/tracing.md) and that of a sampled point leave no room for a
// blocked ray, however thin the lamp.
TEST(ThinLamps, DoNotShadowThemselves) {
  expect_no_shadows<Accel::bvh2>(AccelKind::bvh2, {1, 1e3, 1e5});
  expect_no_shadows<Accel::cwbvh>(AccelKind::cwbvh, {1, 1e3});
}

// Embree's distances on slivers are as much worse as these are thin.
TEST(ThinLamps, DoNotShadowThemselvesInEmbree) {
  if (embree_version().empty()) GTEST_SKIP() << "built without Embree";
  expect_no_shadows<Accel::embree>(AccelKind::embree, {1, 30, 1e3});
}

}  // namespace
}  // namespace pt
