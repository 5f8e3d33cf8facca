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
SceneData lamp_row() {
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
  prepare_scene(scene, options);
  return scene;
}

TEST(LightMap, NamesTheLampThatWasSampled) {
  using AllTraits = Traits<Accel::bvh2, Geometry::mixed, Lighting::full>;
  const SceneData data = lamp_row();
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

}  // namespace
}  // namespace pt
