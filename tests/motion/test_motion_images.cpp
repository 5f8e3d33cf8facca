// Images of what moves against integrals over time in closed form, and against renders of scenes
// that stand still.
#include <gtest/gtest.h>

#include "common/film/aov.h"
#include "common/scene/prepare/prepare_steps.h"
#include "scene/motion_images.h"

namespace pt {
namespace {

class MotionOfSampler : public testing::TestWithParam<SamplerKind> {};
INSTANTIATE_TEST_SUITE_P(Samplers, MotionOfSampler,
                         testing::Values(SamplerKind::independent, SamplerKind::stratified,
                                         SamplerKind::sobol));

TEST_P(MotionOfSampler, AMovingSquareIsItsIntegralOverTime) {
  Options options = motion_options(16, 1, 16384);
  options.sampler = GetParam();
  SceneData scene = band_scene();
  scene.motion.instances = {{0, {{0.0f, {}}, {1.0f, translate({6, 0, 0})}}}};
  expect_band(image_of_motion(scene, options), [](int x) { return seen_part(x, 6); });
  scene.motion.shutter = {0.25f, 0.75f};  // half of the way, from its quarter on
  for (Vec3& p : scene.meshes[0].positions) p.x -= 1.5f;
  expect_band(image_of_motion(scene, options), [](int x) { return seen_part(x, 3); });
}

TEST_P(MotionOfSampler, AMovingCameraIsItsIntegralOverTime) {
  Options options = motion_options(16, 1, 16384);
  options.sampler = GetParam();
  SceneData scene = band_scene();
  const Affine place = translate({8, 0, 10});
  scene.motion.camera = {{0.0f, place}, {1.0f, translate({-6, 0, 0}) * place}};
  expect_band(image_of_motion(scene, options), [](int x) { return seen_part(x, 6); });
}

TEST_P(MotionOfSampler, ADeformingSquareIsItsIntegralOverTime) {
  Options options = motion_options(16, 1, 16384);
  options.sampler = GetParam();
  SceneData scene = band_scene();
  Mesh& mesh = scene.meshes[0];
  mesh.later_positions = {mesh.positions};
  for (Vec3& p : mesh.later_positions[0]) p.x += 6;
  scene.materials[0] = make_diffuse(Color(0.0f));
  scene.sky.nadir = scene.sky.zenith = Color(1.0f);  // before which it is black
  const auto expected = [](int x) { return 1 - seen_part(x, 6); };
  expect_band_everywhere(scene, options, expected);
}

TEST(MotionImages, ACameraAndAThingThatMoveTogetherStandStill) {
  SceneData scene = band_scene();
  const Affine place = translate({8, 0, 10});
  scene.motion.camera = {{0.0f, place}, {1.0f, translate({3, 2, 1}) * place}};
  scene.motion.instances = {{0, {{0.0f, {}}, {1.0f, translate({3, 2, 1})}}}};
  expect_band(image_of_motion(scene, motion_options(16, 1, 64)),
              [](int x) { return x >= 2 && x < 5 ? 1.0 : 0.0; });
}

/// Layers by name, of one sample a pixel unless `spp` says.
class MotionLayers {
 public:
  MotionLayers(const SceneData& scene, int width, int height, int spp = 1,
               const char* accel = "bvh2") {
    Options options = motion_options(width, height, spp);
    options.aovs = aov_bit<aov::Motion> | aov_bit<aov::Depth> | aov_bit<aov::Position> |
                   aov_bit<aov::Primitive>;
    image_ = image_of_motion(scene, options, accel);
  }
  float depth(std::size_t i) const { return layer("depth").values[i]; }
  bool is_hit(std::size_t i) const { return layer("primitive").numbers[i] != no_primitive; }
  Vec2 motion(std::size_t i) const {
    const std::vector<float>& v = layer("motion").values;
    return {v[2 * i], v[2 * i + 1]};
  }
  Vec3 position(std::size_t i) const {
    const std::vector<float>& v = layer("position").values;
    return {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
  }
  std::size_t count() const { return static_cast<std::size_t>(image_.width * image_.height); }

 private:
  const ImageLayer& layer(const std::string& name) const {
    return *std::ranges::find(image_.layers, name, &ImageLayer::name);
  }
  Image image_;
};

void expect_near(const Vec2& found, const Vec2& expected, std::size_t pixel) {
  EXPECT_NEAR(found.x, expected.x, 2e-3) << pixel;
  EXPECT_NEAR(found.y, expected.y, 2e-3) << pixel;
}

TEST(MotionLayers, OfWhatGoesAreItsWayWhereItIsSeen) {
  SceneData scene = band_scene();
  scene.motion.instances = {{0, {{0.0f, {}}, {1.0f, translate({6, -2, 0})}}}};
  SceneData deforming = band_scene();
  deforming.materials[0] = make_diffuse(Color(0.0f));
  deforming.meshes[0].later_positions = {deforming.meshes[0].positions};
  for (Vec3& p : deforming.meshes[0].later_positions[0]) p += Vec3(6, -2, 0);
  for (const char* accel : {"bvh2", "brute"}) {
    for (const SceneData& moving : {scene, deforming}) {
      const MotionLayers layers(moving, 16, 1, 16384, accel);
      for (std::size_t x = 0; x < 16; ++x) {
        const auto part = static_cast<float>(seen_part(static_cast<int>(x), 6));
        EXPECT_NEAR(layers.motion(x).x, 6 * part, 0.12) << x;
        EXPECT_NEAR(layers.motion(x).y, 2 * part, 0.04) << x;                   // down
        EXPECT_FLOAT_EQ(layers.depth(x), x >= 5 && x < 8 ? 10.0f : 0.0f) << x;  // halfway
      }
    }
  }
}

/// A wall in the plane z = 0, seen from the distance of 10, 24 x 16 pixels at 2 a unit there.
SceneData wall_scene() {
  SceneData scene;
  scene.name = "wall";
  scene.camera.look_from = {0, 0, 10}, scene.camera.look_at = {0, 0, 0};
  scene.camera.fov_degrees = 2 * std::atan(0.4f) * 180 / pi;
  scene.add_material(make_diffuse(Color(0.5f)));
  scene.meshes = {square_of(-99, 99, -99, 99, 0, 0)};
  return scene;
}

TEST(MotionLayers, OfAMovingCameraAreTheProjectionsOfWhatStands) {
  SceneData scene = wall_scene();
  scene.motion.camera = {{0.0f, translate({0, 0, 10})}, {1.0f, translate({1, 0.5f, 8})}};
  const MotionLayers layers(scene, 24, 16);
  for (std::size_t i = 0; i < layers.count(); ++i) {
    const Vec3 p = layers.position(i);
    const Vec2 from = 20.0f * Vec2(p.x, -p.y) / 10.0f;  // 20 pixels: the distance of the image
    const Vec2 to = 20.0f * Vec2(p.x - 1, -(p.y - 0.5f)) / 8.0f;
    expect_near(layers.motion(i), to - from, i);
    // One sample a pixel, with its ray from another place at mid-shutter.
    const Vec2 at(static_cast<float>(i % 24) - 11.5f, static_cast<float>(i / 24) - 7.5f);
    EXPECT_NEAR(layers.depth(i), 9 * std::sqrt(1 + glm::dot(at, at) / 400), 0.25) << i;
  }
  scene.motion.instances = {{0, {{0.0f, {}}, {1.0f, translate({1, 0.5f, -2})}}}};
  scene.meshes[0].group = 1, scene.instances = {{1, {}}};
  const MotionLayers together(scene, 24, 16);
  for (std::size_t i = 0; i < together.count(); ++i) expect_near(together.motion(i), Vec2(0.0f), i);
}

TEST(MotionLayers, OfAWheelAreItsChords) {
  SceneData scene = wall_scene();
  scene.meshes[0].group = 1, scene.instances = {{1, {}}};
  scene.motion.instances = {{0, {{0.0f, {}}, {1.0f, rotate({0, 0, 1}, 60)}}}};
  const MotionLayers layers(scene, 24, 16);
  for (std::size_t i = 0; i < layers.count(); ++i) {
    const Vec2 p(layers.position(i)), motion(layers.motion(i).x, -layers.motion(i).y);
    EXPECT_NEAR(glm::length(motion), 2 * glm::length(p), 2e-3) << i;  // 2 pixels r 2 sin 30
    EXPECT_GT(p.x * motion.y - p.y * motion.x, 0.0f) << i;            // counterclockwise
  }
}

TEST(MotionLayers, OfAShearedMeshGrowWithItsHeight) {
  SceneData scene = wall_scene();
  scene.meshes[0].later_positions = {scene.meshes[0].positions};
  for (Vec3& p : scene.meshes[0].later_positions[0]) p.x += 0.75f * p.y;
  const MotionLayers layers(scene, 24, 16);
  for (std::size_t i = 0; i < layers.count(); ++i)
    expect_near(layers.motion(i), {2 * 0.75f * layers.position(i).y, 0}, i);
}

TEST(MotionLayers, AreZeroWhereNothingMovesOrNothingIsSeen) {
  SceneData scene = wall_scene();
  const MotionLayers still(scene, 24, 16);
  scene.meshes.push_back(square_of(-1, 1, -1, 1, 1, 0, 1));
  scene.instances = {{1, {}}};
  scene.motion.instances = {{0, {{0.0f, {}}, {1.0f, translate({1, 0, 0})}}}};
  const MotionLayers beside(scene, 24, 16);
  std::size_t moving = 0;
  for (std::size_t i = 0; i < still.count(); ++i) {
    EXPECT_EQ(still.motion(i), Vec2(0.0f));
    if (beside.position(i).z < 0.5f) {
      EXPECT_EQ(beside.motion(i), Vec2(0.0f)) << i;
    } else {
      expect_near(beside.motion(i), {20.0f / 9, 0}, i), ++moving;
    }
  }
  EXPECT_GT(moving, 10u);
  SceneData passed = wall_scene();  // by the camera, which then has it behind
  passed.motion.camera = {{0.0f, translate({0, 0, 10})}, {1.0f, translate({0, 0, -30})}};
  const MotionLayers behind(passed, 24, 16);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < behind.count(); ++i) {
    hits += behind.is_hit(i);
    EXPECT_EQ(behind.motion(i), Vec2(0.0f)) << i;
  }
  EXPECT_GT(hits, 10u);
}

TEST(MotionImages, AreTheSameInAllModesAndStructures) {
  for (const SamplerKind sampler :
       {SamplerKind::independent, SamplerKind::stratified, SamplerKind::sobol}) {
    Options options = motion_options(40, 30, 4, 5);
    options.sampler = sampler;
    SceneData stiff = moving_room();  // nothing deforms, so there may be wide trees
    stiff.meshes[3].stop_deforming();
    const std::pair<const SceneData, std::vector<std::string>> rooms[] = {
        {moving_room(), {"bvh2", "brute"}},
        {glowing_room(), {"bvh2", "brute"}},
        {stiff, {"bvh2", "brute", "cwbvh"}}};
    for (const auto& [room, accels] : rooms) {
      options.mode = Mode::serial;
      const std::vector<float> serial = image_of_motion(room, options).rgb;
      for (const std::string& accel : accels) {
        options.mode = Mode::megakernel;
        EXPECT_EQ(image_of_motion(room, options, accel).rgb, serial) << accel;
        options.mode = Mode::wavefront;
        for (const Stages stages : {Stages::split, Stages::fused}) {
          options.stages = stages, options.finish_paths = 0, options.pool_size = 333;
          EXPECT_EQ(image_of_motion(room, options, accel).rgb, serial) << accel;
        }
        options.stages = Stages::automatic, options.finish_paths = {}, options.pool_size = 0;
      }
    }
  }
}

/// The room as it stands at a part of the shutter's interval.
SceneData room_at(float time) {
  SceneData scene = moving_room();
  prepare_motion(scene);
  const Motion motion = scene.motion.prepared->view;
  for (const std::uint32_t i : {0u, 1u}) scene.instances[i].to_world = motion.to_world(i, time);
  const Affine camera = pose_at(motion.segments, motion.camera, time);
  scene.camera.look_from = camera.translation();
  scene.camera.look_at = camera.point({0, 0, -1});
  scene.camera.up = camera.vector({0, 1, 0});
  scene.motion = {};
  Mesh& folded = scene.meshes[3];
  for (std::size_t i = 0; i < 4; ++i) {
    folded.positions[i] += time * (folded.later_positions[0][i] - folded.positions[i]);
    folded.normals[i] =
        normalize(folded.normals[i] + time * (folded.later_normals[0][i] - folded.normals[i]));
  }
  folded.stop_deforming();
  return scene;
}

TEST(MotionImages, AtAnInstantAreThoseOfTheRoomThen) {
  for (const float time : {-3.0f, 0.0f, 0.3f, 0.75f, 1.0f, 9.0f}) {
    SceneData held = moving_room();
    held.motion.shutter = {2, 4};
    for (auto& moving : held.motion.instances)
      for (TransformKey& key : moving.keys) key.time = 2 + 2 * key.time;
    for (TransformKey& key : held.motion.camera) key.time = 2 + 2 * key.time;
    hold_still_at(held, 2 + 2 * time);
    const SceneData room = room_at(std::clamp(time, 0.0f, 1.0f));
    EXPECT_FALSE(held.moves());
    const auto expect_close = [&](const Vec3& a, const Vec3& b, const char* what) {
      EXPECT_LT(glm::length(a - b), 1e-5f) << what << " at " << time;
    };
    for (std::size_t i = 0; i < room.instances.size(); ++i)
      for (const Vec3 p : {Vec3(0.0f), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
        expect_close(held.instances[i].to_world.point(p), room.instances[i].to_world.point(p),
                     "instance");
    for (std::size_t i = 0; i < 4; ++i) {
      expect_close(held.meshes[3].positions[i], room.meshes[3].positions[i], "vertex");
      expect_close(held.meshes[3].normals[i], room.meshes[3].normals[i], "normal");
    }
    expect_close(held.camera.look_from, room.camera.look_from, "camera");
    expect_close(normalize(held.camera.look_at - held.camera.look_from),
                 normalize(room.camera.look_at - room.camera.look_from), "view");
  }
}

/// Lights that move are found by sampling them and by hitting them: both alone are right.
void expect_mean_of_other_estimators(const std::vector<MeanEstimate>& means, const SceneData& room,
                                     Options options) {
  options.nee = false, options.spp = 256;
  expect_same_means(means, means_of(room, options), "without light sampling");
  options.nee = true, options.spp = 64, options.mis = MisHeuristic::balance;
  options.light_selection = LightSelection::uniform;
  expect_same_means(means, means_of(room, options), "balance heuristic");
}

TEST(MotionImages, AreTheMeanOfScenesThatStandStill) {
  Options options = motion_options(32, 24, 32, 3);
  const SceneData room = moving_room();
  const auto moving = expect_mean_of_still(room, options, room_at);
  expect_mean_of_other_estimators(moving, room, options);
  const SceneData glowing = glowing_room();
  expect_mean_of_other_estimators(expect_mean_of_still(glowing, options, held(glowing)), glowing,
                                  options);
}

TEST(MotionImages, ALightTreeKnowsWhereLampsGo) {
  Options options = motion_options(64, 6, 16, 2);
  const SceneData scene = passing_lamps();
  options.light_selection = LightSelection::power;
  const auto by_power = means_of(scene, options);
  options.light_selection = LightSelection::tree;
  const auto by_tree = means_of(scene, options);
  expect_same_means(by_power, by_tree, "light tree");
  double power = 0, tree = 0;
  for (std::size_t i = 0; i < by_tree.size(); ++i)
    power += by_power[i].sigma() * by_power[i].sigma(),
        tree += by_tree[i].sigma() * by_tree[i].sigma();
  EXPECT_LT(tree, 0.4 * power);
}

TEST(MotionImages, OfWhiteThingsInAWhiteSkyAreWhite) {
  SceneData scene = moving_room();
  for (MaterialDescription& material : scene.materials) material = make_diffuse(Color(1.0f));
  scene.sky.nadir = scene.sky.zenith = Color(1.0f);
  const Image image = image_of_motion(scene, motion_options(24, 18, 16, 200));
  for (const float value : image.rgb) EXPECT_NEAR(value, 1.0f, 1e-3f);
}

}  // namespace
}  // namespace pt
