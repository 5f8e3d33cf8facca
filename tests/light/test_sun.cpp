// The sun: a disk infinitely far away, and the sky's model, whose values are Mitsuba 3.9.1's.
#include "common/light/distant_lights.h"
#include "common/light/sky/sunsky.h"
#include "common/scene/prepare/prepare_scene.h"
#include "render_serial.h"
#include "scene/lamp_rooms.h"
#include "statistics.h"

namespace pt {
namespace {

Sun make_sun(const Vec3& direction, double half_angle, const Color& radiance) {
  const double s = std::sin(0.5 * half_angle);
  return {glm::normalize(direction), static_cast<float>(2 * s * s), radiance};
}

TEST(Sun, SamplesAreUniformOverTheDisk) {
  for (const double half_angle : {0.2679 * pi_double / 180, 0.02, 0.7}) {
    const Sun sun = make_sun({0.3f, 0.8f, -0.4f}, half_angle, Color(1.0f));
    const glm::dvec3 axis(sun.direction), side = glm::normalize(glm::cross(axis, {0, 1, 0}));
    TestRandom random(2);
    std::vector<double> rings(8), sectors(8);
    constexpr int samples = 100'000;
    int seen = 0;
    for (int i = 0; i < samples; ++i) {
      const LightSample s =
          sample_sun(sun.direction, sun.one_minus_cos, random.unit(), random.unit());
      ASSERT_NEAR(s.pdf * 2 * pi_double * (1 - std::cos(half_angle)), 1, 1e-5);
      const glm::dvec3 wi(s.wi), apart = wi - axis;
      // 1 - cos is half the square of the chord, and uniform over a cap.
      ++rings[cell_of(glm::dot(apart, apart) / (2 * sun.one_minus_cos), 8)];
      const double phi = std::atan2(glm::dot(apart, glm::cross(axis, side)), glm::dot(apart, side));
      ++sectors[cell_of(phi / (2 * pi_double) + 0.5, 8)];
      seen += is_in_sun(sun, s.wi);
    }
    expect_uniform(rings, samples, "rings");
    expect_uniform(sectors, samples, "sectors");
    EXPECT_GT(seen, samples * 0.9995);  // rounding at the rim: 1e-7 of 5e-3
  }
}

TEST(Sun, IsSeenWithinItsAngle) {
  const double half_angle = 0.2679 * pi_double / 180;
  const Sun sun = make_sun({0.3f, 0.8f, -0.4f}, half_angle, Color(1.0f));
  const glm::dvec3 axis = glm::normalize(glm::dvec3(sun.direction));
  const glm::dvec3 side = glm::normalize(glm::cross(axis, {0, 1, 0}));
  for (const double share : {0.0, 0.5, 0.9999, 1.0001, 1.5, 100.0, 500.0}) {
    const double a = share * half_angle;
    const glm::dvec3 d = std::cos(a) * axis + std::sin(a) * side;
    EXPECT_EQ(is_in_sun(sun, Vec3(d)), share < 1) << share;
  }
  EXPECT_FALSE(is_in_sun(Sun(), {0, 0, 1}));
}

/// A floor of albedo 1/2, seen in one point.
SceneData floor_in_the_sun(const Sun& sun, bool more_lights) {
  SceneData scene;
  scene.name = "sun";
  const std::uint32_t grey = scene.add_material(make_diffuse(Color(0.5f)));
  scene.meshes.push_back(parallelogram({}, {-9, 0, -9}, {0, 0, 18}, {18, 0, 0}, grey));
  scene.camera = {{0.3f, 0.1f, -0.2f}, {0, 0, 0}, {0, 1, 0}, 0.002f, 0.0f, 0.4f};
  scene.sun = sun;
  if (more_lights) {
    DeltaLight point;  // gives intensity / 4 at right angles
    point.position = {0, 2, 0}, point.intensity = Color(0.4f);
    DeltaLight far;
    far.kind = LightKind::directional, far.direction = {0, -1, 0}, far.intensity = Color(0.2f);
    scene.delta_lights = {point, far};
    scene.environment = {4, 2, std::vector<Color>(8, Color(0.05f)), Affine()};
  }
  return scene;
}

// pi L sin^2 of the half angle, times the cosine of its middle: exact as long as the disk is above
// the horizon.
TEST(Sun, GivesItsIrradiance) {
  for (const double half_angle : {0.2679 * pi_double / 180, 0.5}) {
    for (const bool more_lights : {false, true}) {
      for (const LightSelection selection :
           {LightSelection::uniform, LightSelection::power, LightSelection::tree}) {
        for (const bool nee : {true, false}) {
          if (!nee && (half_angle < 0.1 || more_lights)) continue;  // found by chance
          const Sun sun = make_sun({0.3f, 0.8f, -0.4f}, half_angle, {3, 2, 1});
          const double sine = std::sin(half_angle);
          double expected = 0.5 * 2 * sine * sine * double{sun.direction.y};
          if (more_lights) expected += 0.5 * (0.1 + 0.2 + 0.05 * pi_double) / pi_double;
          Options options = image_options(64, 64, 16, 2);
          options.nee = nee;
          options.light_selection = selection;
          SceneData scene = floor_in_the_sun(sun, more_lights);
          prepare_scene(scene, options);
          const Image image = render(scene, options).image;
          MeanEstimate mean;
          for (std::size_t i = 1; i < image.rgb.size(); i += 3) mean.add(image.rgb[i]);
          SCOPED_TRACE(testing::Message()
                       << half_angle << " " << static_cast<int>(selection) << ", nee " << nee);
          EXPECT_NEAR(mean.mean(), expected, 5 * mean.sigma() + 1e-4 * expected);
          EXPECT_LT(mean.sigma(), 1e-2 * expected);
        }
      }
    }
  }
}

// As likely as parallel rays of its irradiance.
TEST(Sun, IsChosenByItsIrradiance) {
  const double half_angle = 0.01;
  SceneData with_sun = floor_in_the_sun(make_sun({0, 1, 0}, half_angle, {3, 2, 1}), false);
  SceneData with_rays = floor_in_the_sun({}, false);
  DeltaLight far;
  far.kind = LightKind::directional, far.direction = {0, -1, 0};
  far.intensity = static_cast<float>(pi_double * half_angle * half_angle) * Color(3, 2, 1);
  with_rays.delta_lights.push_back(far);
  prepare_scene(with_sun), prepare_scene(with_rays);
  const float expected = with_rays.light_list.lights.at(0).weight;
  EXPECT_GT(expected, 0.0f);
  EXPECT_NEAR(with_sun.light_list.lights.at(0).weight / expected, 1, 1e-3);
}

// A camera that looks at it, and one beside it.
TEST(Sun, IsSeen) {
  const Sun sun = make_sun({0.0f, 0.6f, 0.8f}, 0.1, {3, 2, 1});
  SceneData scene = floor_in_the_sun(sun, false);
  scene.camera = {{0, 1, 0}, {0, 1.6f, 0.8f}, {0, 1, 0}, 1.0f, 0.0f, 1.0f};
  prepare_scene(scene);
  EXPECT_EQ(render(scene, image_options(4, 4, 4)).image.rgb[4], 2.0f);
  scene.camera.look_at = {0.3f, 1.6f, 0.8f};
  EXPECT_EQ(render(scene, image_options(4, 4, 4)).image.rgb[4], 0.0f);
}

void expect_close(const Color& found, const Color& expected, double tolerance) {
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(found[c], expected[c], tolerance * double{expected[c]}) << "channel " << c;
  }
}

// What Mitsuba 3.9.1's `sunsky` shows there: turbidity 3, albedo 0.3, sun at (0, 0.6, 0.8).
TEST(Sunsky, SkyIsThatOfMitsuba) {
  const SkyModel sky(3, Color(0.3f), std::asin(0.8));
  const auto at = [&](double x, double y, double z) {
    const double length = std::sqrt(x * x + y * y + z * z);
    return sky.radiance(z / length, std::acos((0.6 * y + 0.8 * z) / length));
  };
  expect_close(at(0, 0, 1), {0.02908008f, 0.04823563f, 0.0955867f}, 1e-4);
  expect_close(at(0, 1, 0), {0.1924643f, 0.21913503f, 0.20454611f}, 1e-4);
  expect_close(at(1, 0, 0), {0.13901243f, 0.15611643f, 0.13385685f}, 1e-4);
  expect_close(at(0.9998, 0, 0.02), {0.14153433f, 0.18154782f, 0.20749627f}, 1e-4);
  expect_close(at(0.7, 0, 0.714), {0.03221959f, 0.05856199f, 0.11576091f}, 1e-4);
  EXPECT_TRUE(is_black(sky.radiance(-0.01, 1)));
}

TEST(Sunsky, SunIsThatOfMitsuba) {
  expect_close(sun_irradiance(3, 0.02), {0.26227943f, 0.07084908f, 0}, 5e-3);
  expect_close(sun_irradiance(3, 0.1), {0.70326011f, 0.33754212f, 0.06311576f}, 5e-3);
  expect_close(sun_irradiance(2.5, 0.3), {1.2642851f, 0.90243302f, 0.47447191f}, 5e-3);
  expect_close(sun_irradiance(7.3, 0.7), {1.20201632f, 0.95831375f, 0.69646344f}, 5e-3);
  expect_close(sun_irradiance(2.5, 1.2), {1.52600448f, 1.28665886f, 1.00451735f}, 5e-3);
}

// Mitsuba computes with floats: 6e-5 apart, a hundredth of the sun's radius.
TEST(Sunsky, SunStandsWhereItDoes) {
  EXPECT_LT(glm::length(sun_direction({}) - Vec3(0.0513854f, 0.691748f, 0.720308f)), 1e-4);
  const SunTime sydney{-33.9, 151.2, 10, 2013, 1, 20, 9, 30, 10};
  EXPECT_LT(glm::length(sun_direction(sydney) - Vec3(-0.121386f, -0.5908f, 0.797635f)), 1e-4);
}

}  // namespace
}  // namespace pt
