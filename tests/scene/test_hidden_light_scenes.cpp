// The scenes of hidden light: where light can pass, by rays of this test's own; that few paths find
// it; that light sampling alone cannot; and that all modes render them alike.
#include <gtest/gtest.h>

#include "common/scene/builtin/builtin_scenes.h"
#include "common/scene/builtin/quad_scenes.h"
#include "common/scene/prepare/prepare_scene.h"
#include "mode_cases.h"
#include "render_serial.h"
#include "scene/small_scenes.h"

namespace pt {
namespace {

using Vec3d = glm::dvec3;

/// Where the ray from `o` along `d` meets the quad, in units of `d`; infinite: nowhere.
double distance_to(const Quad& quad, const Vec3d& o, const Vec3d& d) {
  const Vec3d a(quad.edge_a), b(quad.edge_b), from = o - Vec3d(quad.corner);  // Cramer's rule
  const double determinant = -glm::dot(glm::cross(a, b), d);
  const double t = glm::dot(glm::cross(a, b), from) / determinant;
  const double u = glm::dot(glm::cross(b, from), d) / determinant;
  const double v = -glm::dot(glm::cross(a, from), d) / determinant;
  // A little more than the quad, for edges that touch.
  const bool meets = t > 1e-9 && u >= -1e-6 && u <= 1 + 1e-6 && v >= -1e-6 && v <= 1 + 1e-6;
  return meets ? t : HUGE_VAL;
}

double nearest_quad(const SceneData& scene, const Vec3d& o, const Vec3d& d) {
  double t = HUGE_VAL;
  for (const Quad& quad : scene.quads) t = std::min(t, distance_to(quad, o, d));
  return t;
}

/// The room's inside, walls excluded. Its corners are those of the floor that the scene has first.
Vec3d point_in_room(const SceneData& scene, TestRandom& random, double z_from, double z_to) {
  const Vec3d low(scene.quads[0].corner),
      high = Vec3d(scene.quads[1].corner) + Vec3d(scene.quads[1].edge_a);
  return {random.uniform(low.x + 0.01, high.x - 0.01), random.uniform(0.01, high.y - 0.01),
          random.uniform(z_from, z_to)};
}

double front_of(const SceneData& scene) {
  return static_cast<double>(scene.quads[0].corner.z) + scene.quads[0].edge_a.z;
}

const Quad& lamp_of(const SceneData& scene) {
  for (std::size_t i = 0; i < scene.quads.size(); ++i) {
    if (!is_black(scene.materials[scene.quad_material[i]].emission.radiance)) return scene.quads[i];
  }
  throw std::runtime_error("no lamp");
}

TEST(Ajar, IsClosedAndItsRoomsMeetInTheDoorwayAlone) {
  const SceneData scene = build_scene("ajar");
  TestRandom random;
  int others = 0;
  constexpr int rays = 300'000;
  for (int i = 0; i < rays; ++i) {
    const Vec3d o = point_in_room(scene, random, 0.01, front_of(scene) - 0.01);
    const Vec3d d = random.direction();
    const double t = nearest_quad(scene, o, d);
    ASSERT_LT(t, HUGE_VAL) << "a ray leaves the rooms";
    if ((o + t * d).z > -1e-4) continue;
    const Vec3d crossing = o - o.z / d.z * d;
    ASSERT_TRUE(crossing.x >= AjarDoorway::left && crossing.x <= AjarDoorway::right &&
                crossing.y >= 0 && crossing.y <= AjarDoorway::height)
        << "through the wall at " << crossing.x << ", " << crossing.y;
    // Beyond the door, not its front.
    const double angle = std::atan2(-(o + t * d).z, (o + t * d).x - AjarDoorway::left);
    others += angle > 0 && angle < 1.9 * pi_double / 180;
  }
  EXPECT_GT(others, rays / 10'000) << "the door is shut";
  EXPECT_LT(others, rays / 50) << "the door is wide open";
}

/// How many of random pairs of points of a room and of the lamp see each other, and of how many the
/// lamp's bright side is towards the room's point.
std::pair<int, int> lamp_views(const SceneData& scene, double z_from, double z_to) {
  const Quad& lamp = lamp_of(scene);
  TestRandom random;
  int facing = 0, free = 0;
  for (int i = 0; i < 200'000; ++i) {
    const Vec3d from = point_in_room(scene, random, z_from, z_to);
    const Vec3d to = Vec3d(lamp.corner) + random.uniform(0, 1) * Vec3d(lamp.edge_a) +
                     random.uniform(0, 1) * Vec3d(lamp.edge_b);
    if (glm::dot(from - to, Vec3d(lamp.normal)) <= 0) continue;
    ++facing;
    free += nearest_quad(scene, from, to - from) > 1 - 1e-6;
  }
  return {facing, free};
}

TEST(Ajar, NoPointOfTheCamerasRoomSeesTheLamp) {
  const SceneData scene = build_scene("ajar");
  EXPECT_LT(lamp_of(scene).corner.z, 0.0f);
  EXPECT_GT(scene.camera.look_from.z, 0.0f);
  const auto [facing, free] = lamp_views(scene, 0.01, front_of(scene) - 0.01);
  EXPECT_GT(facing, 1000);  // so that walls decide
  EXPECT_EQ(free, 0);
  const auto [facing_behind, free_behind] = lamp_views(scene, -2.9, -0.5);
  EXPECT_GT(free_behind, facing_behind / 2) << "the lamp is covered";
}

/// The share of paths that bring light, and their mean luminance.
std::pair<double, double> light_of(const std::string& name, int max_depth) {
  Options options = image_options(64, 64, 1, max_depth);
  options.scene = name;
  const SceneData scene = make_scene(options);
  double bright = 0, sum = 0;
  constexpr int seeds = 20;
  for (options.seed = 1; options.seed <= seeds; ++options.seed) {
    const Image image = render(scene, options).image;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
      bright += image.rgb[i] + image.rgb[i + 1] + image.rgb[i + 2] > 0;
      sum += (image.rgb[i] + image.rgb[i + 1] + image.rgb[i + 2]) / 3;
    }
  }
  constexpr double paths = 64.0 * 64 * seeds;
  return {bright / paths, sum / paths};
}

TEST(Ajar, FewPathsFindLight) {
  const auto [share, mean] = light_of("ajar", *build_scene("ajar").defaults.max_depth);
  EXPECT_GT(share, 0.002);
  EXPECT_LT(share, 0.05);
  EXPECT_GT(mean, 0.05);
  EXPECT_LT(mean, 2);
}

/// Whether all of the lamp is behind the ball for a point of the floor: a ray to each corner meets
/// it, and what is behind a ball is convex.
bool behind_ball(const SceneData& scene, const Vec3d& p) {
  const Sphere& ball = scene.spheres[0];
  const Quad& lamp = lamp_of(scene);
  for (const int corner : {0, 1, 2, 3}) {
    const Vec3d to = Vec3d(lamp.corner) + double(corner % 2) * Vec3d(lamp.edge_a) +
                     double(corner / 2) * Vec3d(lamp.edge_b);
    const Vec3d d = glm::normalize(to - p), c = Vec3d(ball.center) - p;
    const double b = glm::dot(d, c);
    if (glm::dot(c, c) - b * b >= static_cast<double>(ball.radius_squared)) return false;
  }
  return true;
}

/// What the floor would reflect at `p` if nothing were between it and the lamp, which is small.
double floor_radiance(const SceneData& scene, const Vec3d& p) {
  const Quad& lamp = lamp_of(scene);
  const Vec3d d = Vec3d(lamp.corner) - p;
  const double cosine = glm::normalize(d).y;  // at the lamp and at the floor, which are parallel
  const MaterialDescription& floor = scene.materials[0];  // that is where the scene begins
  const double radiance = scene.materials[1].emission.radiance.x;
  const double albedo = (floor.color(0).x + floor.color(0).y + floor.color(0).z) / 3;
  return albedo / pi_double * radiance * lamp.area * cosine * cosine / glm::dot(d, d);
}

// A camera that sees nothing but the floor in the ball's shadow, whose darkest part is convex.
TEST(Caustic, LightSamplingAloneLeavesTheShadowDark) {
  constexpr int size = 48, depth = 10;
  SceneData scene = build_scene("caustic");
  const Vec3d ball(scene.spheres[0].center), lamp(lamp_of(scene).corner);
  const Vec3d focus = ball - ball.y / (lamp.y - ball.y) * (lamp - ball);  // on the floor
  scene.camera = {Vec3(focus) + Vec3(-0.8f, 0.5f, 0.5f), Vec3(focus), {0, 1, 0}, 12, 0, 1};
  prepare_scene(scene);
  const Camera camera = make_camera(scene.camera, size, size);
  for (const float x : {0.0f, float{size}}) {
    for (const float y : {0.0f, float{size}}) {
      const Ray ray = camera_ray(camera, x, y, 0.5f, 0.5f);
      const Vec3d o(ray.origin), d(ray.direction);
      ASSERT_TRUE(behind_ball(scene, o - o.y / d.y * d)) << "the view is not in the shadow";
    }
  }
  const auto sum_of = [&](int max_depth) {
    double sum = 0;
    int bright = 0;
    const Image image = render(scene, image_options(size, size, 16, max_depth)).image;
    for (const float value : image.rgb) sum += value, bright += value > 0;
    return std::pair(sum / (3.0 * size * size), bright);
  };
  EXPECT_EQ(sum_of(2).first, 0.0);  // the floor asks the lamp: the ball is in the way
  const auto [mean, bright] = sum_of(depth);
  EXPECT_GT(mean, 3 * floor_radiance(scene, focus)) << "the ball does not focus the light";
  EXPECT_LT(bright, 3 * size * size / 2) << "of 16 samples each: chance finds the lamp often";
}

// The ring's far side throws light back on the floor before it, which the lamp lights, too.
TEST(Caustic, MirrorsAddLightWithinTheRing) {
  constexpr int size = 32;
  SceneData scene = build_scene("caustic");
  Vec3d center(0);
  int mirrors = 0;
  for (std::size_t i = 0; i < scene.quads.size(); ++i) {
    if (scene.materials[scene.quad_material[i]].kind != kind_of<Metal>) continue;
    center += Vec3d(scene.quads[i].corner), ++mirrors;
  }
  ASSERT_GT(mirrors, 100);
  center /= mirrors;
  EXPECT_NEAR(center.y, 0, 1e-6);
  const Vec3d to_lamp = Vec3d(lamp_of(scene).corner) - center;
  const Vec3d seen = center - 0.4 * glm::normalize(Vec3d(to_lamp.x, 0, to_lamp.z));
  scene.camera = {Vec3(seen) + Vec3(0.01f, 0.6f, 0), Vec3(seen), {0, 0, 1}, 12, 0, 1};
  prepare_scene(scene);
  const auto mean_of = [&](int max_depth) {
    double sum = 0;
    const Image image = render(scene, image_options(size, size, 64, max_depth)).image;
    for (const float value : image.rgb) sum += value;
    return sum / static_cast<double>(image.rgb.size());
  };
  const double direct = mean_of(2), all = mean_of(10);
  EXPECT_NEAR(direct, floor_radiance(scene, seen), 0.05 * direct);
  EXPECT_GT(all, 1.2 * direct);
}

TEST(HiddenLight, ModesAreEqualBitForBit) {
  for (const char* scene : {"ajar", "caustic"}) {
    const auto image_of = [&](const char* mode, const char* sampler) {
      return render_options(with(Options(), {{"device", "cpu"},
                                             {"mode", mode},
                                             {"scene", scene},
                                             {"sampler", sampler},
                                             {"width", "37"},
                                             {"height", "29"},
                                             {"spp", "8"},
                                             {"max-depth", "12"}}));
    };
    for (const char* sampler : {"independent", "sobol"}) {  // lean and general kernels
      SCOPED_TRACE(testing::Message() << scene << ", " << sampler);
      const Rendered serial = image_of("serial", sampler);
      double sum = 0;
      for (const float value : serial.image.rgb) sum += value;
      EXPECT_GT(sum, 0);
      expect_same(image_of("megakernel", sampler), serial);
      expect_same(image_of("wavefront", sampler), serial);
    }
  }
}

}  // namespace
}  // namespace pt
