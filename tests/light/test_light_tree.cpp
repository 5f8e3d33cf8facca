// The choice of a light: whatever the selection, the probabilities sum to 1 and are those with
// which lights are named, and a tree's bounds leave out only what gives nothing.
#include <set>

#include "common/transport/sample_light.h"
#include "render_serial.h"
#include "scene/lamp_rooms.h"
#include "statistics.h"

namespace pt {
namespace {

constexpr LightSelection all_selections[] = {LightSelection::uniform, LightSelection::power,
                                             LightSelection::tree};

/// Lights of all kinds, of very unequal sizes and strengths, one of them black.
SceneData many_kinds(int count, bool map, LightSelection selection) {
  SceneData scene;
  scene.name = "many kinds";
  TestRandom random(17);
  const std::uint32_t black = scene.add_material(make_diffuse(Color(0.0f)));
  scene.meshes.push_back(parallelogram({}, {-9, -9, -9}, {18, 0, 0}, {0, 0, 18}, black));
  for (int i = 0; i < count; ++i) {
    const auto strength = static_cast<float>(std::pow(10, random.uniform(-2, 2)));
    const Color radiance = strength * Color(1, 0.8f, 0.3f);
    const auto material = scene.add_material(make_diffuse(Color(0.0f), radiance));
    const Vec3 place = Vec3(random.point(5)), way = normalize(Vec3(random.direction()));
    const auto size = static_cast<float>(std::pow(10, random.uniform(-2, 0)));
    if (i % 4 == 0) {
      scene.add_sphere(place, size, material);
    } else if (i % 4 == 1) {
      DeltaLight light;
      light.kind = i % 8 == 1 ? LightKind::point : LightKind::spot;
      light.position = place, light.direction = way, light.intensity = radiance;
      light.cos_inner = std::cos(0.3f + 0.1f * static_cast<float>(i % 3));
      light.cos_outer = std::cos(0.5f + 0.5f * static_cast<float>(i % 5));
      scene.delta_lights.push_back(light);
    } else {
      scene.meshes.push_back(parallelogram({}, place, size * way,
                                           size * normalize(Vec3(random.direction())), material));
    }
  }
  DeltaLight far;
  far.kind = LightKind::directional;
  far.direction = {0, -1, 0};
  scene.delta_lights.push_back(far);
  if (map) {
    scene.environment = {4, 2, std::vector<Color>(8, Color(1.0f)), Affine()};
  }
  Options options;
  options.light_selection = selection;
  prepare_scene(scene, options);
  return scene;
}

TEST(LightSelector, ProbabilitiesSumToOneAndAreThoseOfTheChoice) {
  for (const bool map : {false, true}) {
    for (const LightSelection selection : all_selections) {
      const SceneData data = many_kinds(40, map, selection);
      const LightSelector& selector = host_view(data, 8, 8).light_selector;
      const auto lights = static_cast<std::uint32_t>(data.light_list.lights.size());
      TestRandom random(3);
      for (int place = 0; place < 12; ++place) {
        const Vec3 from = Vec3(random.point(6));
        const Receiver receiver =
            place % 3 == 0 ? Receiver{}
                           : make_receiver(normalize(Vec3(random.direction())), place % 3 == 1);
        constexpr int samples = 40'000;
        std::vector<double> counts(lights + 1), expected(lights + 1);
        double sum = 0;
        for (std::uint32_t i = 0; i <= lights; ++i) {
          const std::uint32_t light = i < lights ? i : environment_light;
          expected[i] = samples * double{selector.pmf(from, receiver, light)};
          sum += expected[i] / samples;
        }
        ASSERT_NEAR(sum, 1, 1e-5);
        for (int i = 0; i < samples; ++i) {
          const LightChoice choice = selector.sample(from, receiver, random.unit(), random.unit());
          ASSERT_EQ(choice.pmf, selector.pmf(from, receiver, choice.light));
          ++counts[choice.light == environment_light ? lights : choice.light];
        }
        expect_counts(counts, expected, "selection " + std::to_string(static_cast<int>(selection)));
      }
    }
  }
}

// A lamp of many triangles counts as one; so do a sphere, a point and the environment.
TEST(LightSelector, UniformChoosesAmongLamps) {
  const SceneData data = many_kinds(40, true, LightSelection::uniform);
  const LightSelector& selector = host_view(data, 8, 8).light_selector;
  const double share = 1.0 / 42;  // with the directional light and the environment
  EXPECT_NEAR(selector.pmf(Vec3(0.0f), {}, environment_light), share, 1e-6);
  const std::vector<Light>& lights = data.light_list.lights;
  for (std::uint32_t i = 0; i < lights.size(); ++i) {
    const bool triangle = is_triangle(lights[i].kind);  // one half of a parallelogram
    EXPECT_NEAR(selector.pmf(Vec3(0.0f), {}, i), triangle ? share / 2 : share, 1e-6) << i;
  }
}

/// Whether any of the light reaches `from`, by sampling it.
bool gives(const Scene& scene, const Light& light, const Vec3& from, const Vec3& normal,
           TestRandom& random) {
  for (int i = 0; i < 30; ++i) {
    const IncidentLight s = sample_listed_light(scene, light, from, random.unit(), random.unit());
    if (s.pdf > 0 && !is_black(s.radiance) && glm::dot(s.wi, normal) > 1e-3f) return true;
  }
  return false;
}

TEST(LightTree, WhatGivesLightCanBeChosen) {
  const SceneData data = many_kinds(120, false, LightSelection::tree);
  const Scene scene = host_view(data, 8, 8);
  TestRandom random(4);
  int given = 0, impossible = 0;
  for (int place = 0; place < 300; ++place) {
    const Vec3 from = Vec3(random.point(6)), normal = normalize(Vec3(random.direction()));
    const Receiver receiver = make_receiver(normal, false);
    for (std::uint32_t i = 0; i < data.light_list.lights.size(); ++i) {
      const bool possible = scene.light_selector.pmf(from, receiver, i) > 0;
      impossible += !possible;
      if (!gives(scene, data.light_list.lights[i], from, normal, random)) continue;
      ++given;
      ASSERT_TRUE(possible) << "light " << i << " at place " << place;
    }
  }
  EXPECT_GT(given, 5000);
  EXPECT_GT(impossible, 2000);  // else bounds bound nothing
}

TEST(LightTree, FindsEachOfManyLights) {
  SceneData scene;
  const std::uint32_t glow = scene.add_material(make_diffuse(Color(0.0f), Color(1.0f)));
  Mesh mesh;  // all in one place, so that nothing tells them apart: the depth stays bounded
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles.assign(20'000, {{0, 1, 2}});
  mesh.material = glow;
  scene.meshes.push_back(mesh);
  prepare_scene(scene);
  const LightSelector& selector = host_view(scene, 8, 8).light_selector;
  std::set<std::uint32_t> found;
  TestRandom random(8);
  for (int i = 0; i < 200'000; ++i) {
    found.insert(selector.sample({0, 0, 3}, {}, random.unit(), random.unit()).light);
  }
  // Each of n lights is missed with a probability of e^-10.
  EXPECT_NEAR(static_cast<double>(found.size()), 2e4 * (1 - std::exp(-10.0)), 5);
  EXPECT_NEAR(selector.pmf({0, 0, 3}, {}, 7'777), 5e-5, 2.5e-5);
}

TEST(Receiver, KeepsTheNormalAndTheSides) {
  TestRandom random(6);
  for (int i = 0; i < 100'000; ++i) {
    const Vec3 n = i < 6 ? Vec3(i / 2 == 0, i / 2 == 1, i / 2 == 2) * (i % 2 ? 1.0f : -1.0f)
                         : normalize(Vec3(random.direction()));
    for (const bool both : {false, true}) {
      const Receiver receiver = make_receiver(n, both);
      ASSERT_NE(receiver.bits, 0u);
      ASSERT_LT(glm::length(receiver_normal(receiver) - n), 2e-4f);
      ASSERT_EQ((receiver.bits & Receiver::both_sides) != 0, both);
    }
  }
}

/// Two rooms, a wall between, a thousand lamps under both ceilings, of which the camera sees one
/// room's floor.
SceneData two_rooms(int lamps_of_a_room) {
  SceneData scene;
  scene.name = "two rooms";
  const std::uint32_t white = scene.add_material(make_diffuse(Color(0.6f)));
  scene.meshes.push_back(parallelogram({}, {-10, 0, -5}, {0, 0, 10}, {20, 0, 0}, white));
  scene.meshes.push_back(parallelogram({}, {0, 0, -5}, {0, 4, 0}, {0, 0, 10}, white));
  TestRandom random(12);
  for (int i = 0; i < 2 * lamps_of_a_room; ++i) {
    const float side = i % 2 == 0 ? -1.0f : 1.0f;
    const Color radiance = static_cast<float>(random.uniform(1, 20)) * Color(1, 0.9f, 0.7f);
    const Vec3 place(side * random.uniform(0.3, 9.7), random.uniform(0.5, 3.5),
                     random.uniform(-4.7, 4.7));
    const std::uint32_t material = scene.add_material(make_diffuse(Color(0.0f), radiance));
    scene.meshes.push_back(parallelogram({}, place, {0.05f, 0, 0}, {0, 0, 0.05f}, material));
  }
  scene.camera = {{-5, 3.9f, 0}, {-5, 0, 0}, {1, 0, 0}, 90.0f, 0.0f, 1.0f};
  return scene;
}

/// The image's mean over all pixels, and the mean variance of a pixel, from renders with some
/// seeds.
struct Noise {
  MeanEstimate mean;
  double variance = 0;
};

Noise noise_of(const SceneData& source, LightSelection selection, int seeds) {
  Options options = image_options(24, 24, 16, 3);
  options.light_selection = selection;
  SceneData scene = source;
  prepare_scene(scene, options);
  std::vector<MeanEstimate> pixels(24 * 24 * 3);
  Noise noise;
  for (int i = 0; i < seeds; ++i) {
    options.seed = static_cast<std::uint64_t>(i) + 1;
    const Image image = render(scene, options).image;
    double sum = 0;
    for (std::size_t k = 0; k < image.rgb.size(); ++k)
      pixels[k].add(image.rgb[k]), sum += image.rgb[k];
    noise.mean.add(sum / static_cast<double>(image.rgb.size()));
  }
  for (const MeanEstimate& pixel : pixels) {
    noise.variance += pixel.sigma() * pixel.sigma() * seeds / static_cast<double>(pixels.size());
  }
  return noise;
}

TEST(LightTree, AThousandLampsInTwoRooms) {
  const SceneData scene = two_rooms(500);
  const Noise tree = noise_of(scene, LightSelection::tree, 16);
  for (const LightSelection other : {LightSelection::uniform, LightSelection::power}) {
    const Noise noise = noise_of(scene, other, 16);
    const double difference = tree.mean.mean() - noise.mean.mean();
    EXPECT_LT(std::abs(difference), 5 * std::hypot(tree.mean.sigma(), noise.mean.sigma()));
    EXPECT_LT(noise.mean.sigma(), 2e-2 * noise.mean.mean()) << "too noisy to tell";
    RecordProperty("factor", std::to_string(noise.variance / tree.variance));
    EXPECT_GT(noise.variance, 5 * tree.variance) << noise.variance << " " << tree.variance;
  }
}

}  // namespace
}  // namespace pt
