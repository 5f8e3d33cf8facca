// Which light a surface is that a ray met: among lamps of all kinds in one scene, in instances of
// unequal sizes, the density that sampled a lamp is the one that weighs a path that finds it.
#include "common/transport/intersect.h"
#include "common/transport/sample_light.h"
#include "render_serial.h"
#include "scene/lamp_rooms.h"
#include "statistics.h"

namespace pt {
namespace {

/// From left to right: two instances of a group of two lamps, a lamp by itself, a sphere. A mesh
/// that does not shine comes before each.
SceneData lamp_row(LightSelection selection) {
  SceneData scene;
  const std::uint32_t black = scene.add_material(make_diffuse(Color(0.0f)));
  const std::uint32_t glow[] = {scene.add_material(make_diffuse(Color(0.0f), {5, 1, 1})),
                                scene.add_material(make_diffuse(Color(0.0f), {1, 2, 9}))};
  const auto add = [&](std::uint32_t group, const Vec3& corner, std::uint32_t material) {
    scene.meshes.push_back(parallelogram({}, corner, {0.6f, 0, 0}, {0, 0, 1}, material));
    scene.meshes.back().group = group;
  };
  add(1, {-0.3f, 0.3f, -0.5f}, black);
  add(1, {-0.8f, 0, -0.5f}, glow[0]);
  add(1, {0.2f, 0, -0.5f}, glow[1]);
  add(0, {2, 1.5f, -0.5f}, black);
  add(0, {2, 1, -0.5f}, glow[1]);
  scene.instances.push_back({1, translate({-4, 1, 0}) * scale(Vec3(1.5f, 1, 1))});
  scene.instances.push_back({1, translate({-1, 1, 0}) * scale(Vec3(0.5f, 1, 0.6f))});
  scene.add_sphere({5, 1, 0}, 0.4f, glow[0]);
  Options options;
  options.accel = AccelKind::bvh2;  // as the kernels' traits below
  options.light_selection = selection;
  prepare_scene(scene, options);
  return scene;
}

// A plan counts emitters before the lights are listed. Chosen uniformly, each weighs 1.
TEST(LightMap, EmittersAreCountedBeforeTheyAreListed) {
  Options options;
  options.kernel_set = KernelSet::general, options.light_selection = LightSelection::uniform;
  const auto counts_of = [&](SceneData scene) {
    prepare_scene(scene, options);
    return std::pair(static_cast<double>(scene.properties.emitters),
                     static_cast<double>(scene.light_list.total_weight));
  };
  const auto expect_count = [&](const SceneData& scene, double expected) {
    const auto [counted, listed] = counts_of(scene);
    EXPECT_EQ(counted, expected);
    EXPECT_NEAR(listed, std::max(expected, 1.0), 1e-5);  // it is a divisor
  };
  SceneData scene = lamp_row(LightSelection::automatic);
  expect_count(scene, 6);
  const std::uint32_t dark = scene.add_material(make_diffuse(Color(1.0f)));
  const std::uint32_t glow = scene.add_material(make_diffuse(Color(0.0f), Color(1.0f)));
  const std::uint32_t masked = scene.add_material(make_diffuse(Color(0.0f), Color(1.0f)));
  scene.materials[masked].opacity.offset = 0.5f;
  scene.meshes.push_back(parallelogram({}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}, glow));  // no area
  scene.meshes.push_back(parallelogram({}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, masked));
  scene.add_sphere({0, 9, 0}, 1, dark);
  expect_count(scene, 6);
  scene.add_quad({0, 5, 0}, {1, 0, 0}, {0, 0, 1}, glow);
  expect_count(scene, 7);
  scene.add_quad({0, 6, 0}, {1, 0, 0}, {0, 0, 1}, glow);  // quads of a material are one mesh
  expect_count(scene, 7);
  scene.add_quad({0, 7, 0}, {1, 0, 0}, {0, 0, 1}, dark);
  expect_count(scene, 7);
  for (const Color& intensity : {Color(0.0f), Color(1.0f)}) {
    DeltaLight light;
    light.intensity = intensity;
    scene.delta_lights.push_back(light);
  }
  expect_count(scene, 8);
  scene.sun.one_minus_cos = 1e-4f, scene.sun.radiance = Color(2.0f);
  expect_count(scene, 9);
}

void expect_sampled_lamps(LightSelection selection) {
  using AllTraits = Traits<Accel::bvh2, Geometry::mixed, Lighting::full>;
  const SceneData data = lamp_row(selection);
  ASSERT_EQ(data.light_list.lights.size(), 2 * 2 * 2 + 2 + 1u);
  const Scene scene = host_view(data, 8, 8);
  TestRandom random(5);
  std::vector<int> found(data.light_list.lights.size());
  int compared = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 from(random.uniform(-5, 6), random.uniform(-2, 0.5), random.uniform(-1, 1));
    const Vec4 u(random.unit(), random.unit(), random.unit(), random.unit());
    const Receiver receiver = make_receiver(normalize(Vec3(random.direction())), true);
    const LightChoice choice = scene.light_selector.sample(from, receiver, u.z, u.w);
    ASSERT_EQ(choice.pmf, scene.light_selector.pmf(from, receiver, choice.light));
    const IncidentLight light = sample_light<AllTraits>(scene, from, receiver, u);
    if (light.pdf <= 0) continue;
    const Ray ray{from, light.wi};
    const Hit hit = intersect_closest<AllTraits>(scene, ray);
    // Another lamp may lie between, and a ray to a rim may miss.
    if (hit.is_miss() || std::abs(hit.t / glm::length(light.end) - 1) > 1e-3f) continue;
    ++compared;
    ++found[choice.light];
    ASSERT_NEAR(light_pdf<AllTraits>(scene, ray, receiver, hit) / light.pdf, 1, 1e-3)
        << "light " << choice.light;
  }
  EXPECT_GT(compared, 10'000);
  for (const int count : found) EXPECT_GT(count, 50);
}

TEST(LightMap, NamesTheLampThatWasSampled) {
  for (const LightSelection selection : {LightSelection::power, LightSelection::tree}) {
    SCOPED_TRACE(static_cast<int>(selection));
    expect_sampled_lamps(selection);
  }
}

}  // namespace
}  // namespace pt
