// Light sampling far from the scene's origin and at every scale: no lamp shadows itself, what lies
// just below a lamp does, and a path's chance of finding a lamp is the density that weighs it.
#include "common/transport/shade_surface.h"
#include "render_serial.h"
#include "scene/lamp_rooms.h"
#include "statistics.h"

namespace pt {
namespace {

using Vec3d = glm::dvec3;

/// Mean of an image; equal seeds take the same paths wherever the room lies.
double room_mean(Lamp lamp, const RoomPlace& place, bool nee, int spp, int max_depth = 3) {
  Options options = image_options(24, 24, spp, max_depth);
  options.nee = nee;
  SceneData scene = lamp_room(lamp, place);
  prepare_scene(scene, options);
  const Image image = render(scene, options).image;
  double sum = 0;
  for (const float v : image.rgb) sum += v;
  return sum / static_cast<double>(image.rgb.size());
}

// Paths are the same but for rounding, so the means differ by less than their noise. What remains
// is that rays begin off their surface by its error bound, about 1e-6 d of a room of size 2.
TEST(FarLights, LightSamplingLosesNothingWhereverTheRoomLies) {
  for (const Lamp lamp : {Lamp::triangles, Lamp::quad, Lamp::sphere, Lamp::listed_sphere,
                          Lamp::instance, Lamp::mirror_instance, Lamp::point, Lamp::spot}) {
    const double here = room_mean(lamp, {}, true, 16);
    for (const float d : {10.0f, 100.0f, 300.0f, 1000.0f}) {
      EXPECT_NEAR(room_mean(lamp, {d}, true, 16) / here, 1, 5e-4 + 2e-6 * double{d})
          << name_of(lamp) << " at " << d;
    }
  }
}

TEST(FarLights, LightSamplingLosesNothingAtAnyScale) {
  for (const Lamp lamp : area_lamps) {
    const double here = room_mean(lamp, {}, true, 16);
    for (const float scale : {1e-3f, 1e5f}) {
      for (const float d : {0.0f, 100.0f}) {
        EXPECT_NEAR(room_mean(lamp, {d, scale}, true, 16) / here, 1, 1e-3)
            << name_of(lamp) << " at " << d << ", scale " << scale;
      }
    }
  }
}

// At the origin both ways agree, as other tests show. Each against itself there, they must change
// alike: the noise cancels but for paths that hit a lamp's rim. At d = 2e5, 1e5 times the room's
// size, a float's step is 1/64 and rays begin 0.2 off their surfaces: the pictures are those of
// other rooms by then, but both ways still see the same one within a few percent.
TEST(FarLights, BothWaysSeeTheSameFarRoom) {
  const auto compare = [](Lamp lamp, float d, int spp, double tolerance) {
    const double with = room_mean(lamp, {d}, true, spp) / room_mean(lamp, {}, true, spp);
    const double without = room_mean(lamp, {d}, false, spp) / room_mean(lamp, {}, false, spp);
    EXPECT_NEAR(with, without, tolerance) << name_of(lamp) << " at " << d;
  };
  for (const Lamp lamp : area_lamps) {
    compare(lamp, 1e3f, 200, 2e-3);
    compare(lamp, 1e4f, 200, 4e-3);
    compare(lamp, 2e5f, 100, 4e-2);
  }
}

/// A room's lamp alone, and a receiver of its light.
struct LampAlone {
  SceneData scene;
  RoomPlace place;

  LampAlone(Lamp lamp, const RoomPlace& where, bool occluder = false) : place(where) {
    const std::uint32_t black = scene.add_material(make_diffuse(Color(0.0f)));
    const std::uint32_t glow = scene.add_material(make_diffuse(Color(0.0f), Color(3, 2, 1)));
    add_lamp(scene, lamp, place, glow);
    if (occluder) {
      // A thousandth of the receivers' distance below the lamp, which it covers.
      const float y = 0.875f - 1e-3f;
      scene.meshes.push_back(parallelogram(place, {-1, y, -1}, {2, 0, 0}, {0, 0, 2}, black));
    } else {  // so that all kinds of lamps take the way of Lighting::full
      scene.meshes.push_back(parallelogram(place, {-1, 8, -1}, {2, 0, 0}, {0, 0, 2}, black));
    }
    Options options;
    options.accel = AccelKind::bvh2;
    prepare_scene(scene, options);
  }

  /// A point of a floor below the lamp, or of anything between.
  SurfacePoint receiver(TestRandom& random) const {
    const auto unit = [&] { return static_cast<float>(random.uniform(-1, 1)); };
    const float depth = static_cast<float>(random.log_uniform(1e-2, 2));
    const Vec3 position = place.at({unit(), 0.875f - depth, unit()});
    const Vec3 normal = glm::normalize(Vec3(0.3f * unit(), 1, 0.3f * unit()));
    return {position, normal, 16.0f * half_ulp * max_abs(position)};
  }
};

using FullTraits = Traits<Accel::bvh2, Geometry::mixed, Lighting::full>;

TEST(FarLights, NoLampShadowsItselfAndDensitiesAgree) {
  for (const Lamp lamp : area_lamps) {
    for (const float scale : {1e-3f, 1.0f, 1e5f}) {
      for (const float d : {0.0f, 10.0f, 1000.0f, 1e4f}) {
        SCOPED_TRACE(name_of(lamp) + " at " + std::to_string(d) + " scale " +
                     std::to_string(scale));
        const LampAlone alone(lamp, {d, scale});
        const Scene scene = host_view(alone.scene, 8, 8);
        TestRandom random(3);
        int asked = 0, blocked = 0, missed = 0, unlike = 0;
        for (int i = 0; i < 4000; ++i) {
          const SurfacePoint point = alone.receiver(random);
          const Vec3 from = spawn_origin(point, {0, 1, 0});
          const Vec4 u(random.unit(), random.unit(), random.unit(), random.unit());
          const IncidentLight light = sample_light<FullTraits>(scene, from, {}, u);
          if (light.pdf <= 0 || glm::dot(light.wi, point.normal) <= 0) continue;
          ++asked;
          const ShadowRay shadow = spawn_shadow_ray<FullTraits>(point, from, light, Color(1.0f));
          blocked += intersect_shadow<FullTraits>(scene, shadow);
          const Hit hit = intersect_closest<FullTraits>(scene, {from, light.wi});
          if (hit.is_miss()) {
            ++missed;  // a lamp's rim
            continue;
          }
          const float pdf = light_pdf<FullTraits>(scene, {from, light.wi}, {}, hit);
          // An instance's rays are rounded in its own space, by coordinates over distances.
          unlike += std::abs(pdf / light.pdf - 1) > 1e-3f + 3e-5f * d / (hit.t / scale);
        }
        EXPECT_GT(asked, 1000);
        EXPECT_EQ(blocked, 0);
        EXPECT_LT(missed, asked * (0.02 + 4e-6 * double{d}));
        EXPECT_LT(unlike, asked / 100);
      }
    }
  }
}

TEST(FarLights, WhatLiesJustBelowALampBlocksIt) {
  for (const Lamp lamp : {Lamp::triangles, Lamp::quad, Lamp::instance, Lamp::mirror_instance}) {
    for (const float scale : {1e-3f, 1.0f, 1e5f}) {
      for (const float d : {0.0f, 10.0f, 100.0f}) {
        const LampAlone alone(lamp, {d, scale}, true);
        const Scene scene = host_view(alone.scene, 8, 8);
        TestRandom random(4);
        int free = 0;
        for (int i = 0; i < 4000; ++i) {
          const SurfacePoint point = alone.receiver(random);
          const Vec3 from = spawn_origin(point, {0, 1, 0});
          const Vec4 u(random.unit(), random.unit(), random.unit(), random.unit());
          const IncidentLight light = sample_light<FullTraits>(scene, from, {}, u);
          if (light.pdf <= 0 || glm::dot(light.wi, point.normal) <= 0) continue;
          free += !intersect_shadow<FullTraits>(
              scene, spawn_shadow_ray<FullTraits>(point, from, light, Color(1.0f)));
        }
        EXPECT_EQ(free, 0) << name_of(lamp) << " at " << d << " scale " << scale;
      }
    }
  }
}

// The lamp's own bound must cover what the packed one loses.
TEST(FarLights, PackedErrorsAreRoundedUp) {
  TestRandom random(5);
  for (int i = 0; i < 10'000; ++i) {
    const LightError error{static_cast<float>(random.log_uniform(1e-30, 1e30)),
                           static_cast<float>(random.log_uniform(1e-10, 1))};
    const LightError packed = pack_light_error(error).unpack();
    ASSERT_GE(packed.absolute, error.absolute);
    ASSERT_LE(packed.absolute, 1.01f * error.absolute);
    ASSERT_GE(packed.relative, error.relative);
    ASSERT_LE(packed.relative, 2.0f * error.relative);
  }
  EXPECT_EQ(pack_light_error({}).unpack().absolute, 0.0f);
  EXPECT_EQ(pack_light_error({0.0f, light_rounding}).unpack().relative, light_rounding);
}

}  // namespace
}  // namespace pt
