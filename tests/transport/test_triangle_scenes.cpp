// Scenes with triangles through the whole renderer: what is known of an image must be in it.
#include <cmath>
#include <filesystem>

#include "common/accel/embree/embree_tree.h"
#include "common/error/error.h"
#include "common/image/compare/compare.h"
#include "common/scene/builtin/builtin_scenes.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/scene/prepare/prepare_steps.h"
#include "mode_cases.h"
#include "render_serial.h"
#include "scene/mixed_scene.h"
#include "shared_file.h"
#include "statistics.h"
#include "temp_folder.h"

namespace pt {
namespace {

Mesh floor_mesh(float half, std::uint32_t material) {
  Mesh mesh;
  mesh.positions = {{-half, 0, -half}, {-half, 0, half}, {half, 0, half}, {half, 0, -half}};
  mesh.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  mesh.material = material;
  return mesh;
}

/// A grey floor seen from above, without any light.
SceneData floor_scene(float albedo = 0.5f) {
  SceneData scene;
  scene.name = "floor";
  scene.meshes.push_back(floor_mesh(10, scene.add_material(make_diffuse(Color(albedo)))));
  scene.camera = {{0, 4, 0.01f}, {0, 0, 0}, {0, 1, 0}, 20.0f, 0.0f, 4.0f};
  return scene;
}

Image render_scene(SceneData scene, Options options) {
  prepare_scene(scene, options);
  return render(scene, options).image;
}

double mean_of(const Image& image) {
  double sum = 0;
  for (const float v : image.rgb) sum += v;
  return sum / static_cast<double>(image.rgb.size());
}

/// Mean and standard error over independent renders.
MeanEstimate estimate(const SceneData& scene, Options options, int renders) {
  MeanEstimate mean;
  for (int i = 0; i < renders; ++i) {
    options.seed = static_cast<std::uint64_t>(i) + 1;
    mean.add(mean_of(render_scene(scene, options)));
  }
  return mean;
}

void expect_equal_means(const MeanEstimate& a, const MeanEstimate& b) {
  EXPECT_NEAR(a.mean(), b.mean(), 5 * std::hypot(a.sigma(), b.sigma()) + 1e-6 * a.mean());
}

SceneData quads_as_triangles(const char* name) {
  Options options;
  options.scene = name;
  SceneData scene = build_scene(options);
  convert_quads(scene);
  return scene;
}

TEST(TriangleScenes, FurnaceIsOneEverywhere) {
  for (const std::string& accel : structures(AccelKind::brute)) {
    Options options = image_options(24, 16, 4, 400);
    find_option("accel").set(options, accel);
    const Image image = render_scene(quads_as_triangles("furnace"), options);
    MeanEstimate mean;
    for (const float value : image.rgb) mean.add(value);
    EXPECT_NEAR(mean.mean(), 1.0, 5 * mean.sigma() + 1e-5) << accel;
  }
}

TEST(TriangleScenes, CornellBoxOfTrianglesIsThatOfQuads) {
  const Options options = image_options(32, 32, 16, 6);
  Options named = options;
  named.scene = "cornell";
  expect_equal_means(estimate(quads_as_triangles("cornell"), options, 12),
                     estimate(build_scene(named), options, 12));
}

TEST(TriangleScenes, LightSamplingDoesNotChangeTheMean) {
  Options with_it = image_options(24, 24, 64, 4), without = with_it;
  without.nee = false;
  const SceneData scene = quads_as_triangles("cornell");
  expect_equal_means(estimate(scene, with_it, 10), estimate(scene, without, 10));
}

TEST(TriangleScenes, RussianRouletteDoesNotChangeTheMean) {
  Options with_it = image_options(24, 24, 32, 12), without = with_it;
  with_it.rr_depth = 2;
  const SceneData scene = quads_as_triangles("cornell");
  const MeanEstimate with_roulette = estimate(scene, with_it, 10);
  expect_equal_means(with_roulette, estimate(scene, without, 10));
}

// Irradiance of a point light: I cos / d^2; radiance = albedo / pi times that.
TEST(TriangleScenes, PointLightFollowsTheInverseSquare) {
  SceneData scene = floor_scene();
  scene.delta_lights.push_back({});
  scene.delta_lights[0].position = {1.0f, 2.0f, 0.0f};
  scene.delta_lights[0].intensity = Color(3.0f);
  Options options = image_options(9, 9, 1, 3);
  const Image image = render_scene(scene, options);
  // The centre pixel sees the origin, give or take its own size.
  const double d2 = 5.0, cosine = 2.0 / std::sqrt(d2);
  EXPECT_NEAR(image.pixel(4, 4)[0], 0.5 / pi_double * 3.0 * cosine / d2, 0.01);
}

TEST(TriangleScenes, DirectionalLightGivesItsIrradiance) {
  SceneData scene = floor_scene(0.8f);
  scene.delta_lights.push_back({});
  scene.delta_lights[0].kind = LightKind::directional;
  scene.delta_lights[0].direction = glm::normalize(Vec3(1, -1, 0));
  scene.delta_lights[0].intensity = Color(2.0f);
  const Image image = render_scene(scene, image_options(5, 5, 4, 2));
  for (const float v : image.rgb) {
    EXPECT_NEAR(v, 0.8 / pi_double * 2.0 * std::sqrt(0.5), 1e-5);
  }
}

SceneData under_environment(SceneData scene, const std::function<Color(int row, int column)>& f) {
  EnvironmentData& environment = scene.environment;
  environment.width = 16, environment.height = 8;
  for (int j = 0; j < 8; ++j) {
    for (int i = 0; i < 16; ++i) environment.pixels.push_back(f(j, i));
  }
  return scene;
}

TEST(TriangleScenes, FloorUnderAConstantEnvironmentReflectsItsAlbedo) {
  const SceneData scene = under_environment(floor_scene(), [](int, int) { return Color(1.0f); });
  for (const bool nee : {true, false}) {
    Options options = image_options(16, 16, 64, 3);
    options.nee = nee;
    MeanEstimate mean;
    for (const float v : render_scene(scene, options).rgb) mean.add(v);
    EXPECT_NEAR(mean.mean(), 0.5, 5 * mean.sigma()) << "nee " << nee;
  }
}

TEST(TriangleScenes, EnvironmentSamplingDoesNotChangeTheMean) {
  const SceneData scene = under_environment(floor_scene(), [](int row, int column) {
    return row == 1 && column == 3 ? Color(40.0f, 20.0f, 10.0f) : Color(0.2f);
  });
  Options with_it = image_options(16, 16, 64, 3), without = with_it;
  without.nee = false, without.spp = 256;
  expect_equal_means(estimate(scene, with_it, 8), estimate(scene, without, 8));
}

/// A tilted, stretched and mirrored copy of a small emitter above a floor: once as an instance,
/// once baked.
SceneData placed_emitter(bool instance, bool mirrored) {
  SceneData scene = floor_scene();
  Mesh lamp;
  lamp.positions = {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}};
  lamp.triangles = {{{0, 1, 2}}};  // shines downwards
  lamp.material = scene.add_material(make_diffuse(Color(0.0f), Color(5.0f)));
  Affine to_world = translate({0.5f, 2.0f, 0}) * rotate({0, 0, 1}, 20.0f);
  to_world = to_world * scale({mirrored ? -0.7f : 0.7f, 1.0f, 1.3f});
  if (instance) {
    lamp.group = 1;
    scene.instances.push_back({1, to_world});
  } else {
    for (Vec3& p : lamp.positions) p = to_world.point(p);
    if (mirrored) std::swap(lamp.triangles[0].v[1], lamp.triangles[0].v[2]);
  }
  scene.meshes.push_back(lamp);
  scene.camera = {{4, 3, 0.01f}, {0, 0, 0}, {0, 1, 0}, 30.0f, 0.0f, 4.0f};
  return scene;
}

TEST(TriangleScenes, AnInstanceShinesAsItsBakedCopy) {
  for (const bool mirrored : {false, true}) {
    for (const bool nee : {true, false}) {
      Options options = image_options(16, 16, 64, 3);
      options.nee = nee;
      const MeanEstimate placed = estimate(placed_emitter(true, mirrored), options, 8);
      EXPECT_GT(placed.mean(), 0.01);
      SCOPED_TRACE(testing::Message() << "mirrored " << mirrored << ", nee " << nee);
      expect_equal_means(placed, estimate(placed_emitter(false, mirrored), options, 8));
    }
  }
}

TEST(TriangleScenes, TexturesColourTheFloor) {
  SceneData scene = floor_scene(1.0f);
  Texture checker;
  checker.kind = TextureKind::checkerboard;
  checker.color0 = Color(0.8f), checker.color1 = Color(0.2f);
  checker.u_row[0] = checker.v_row[1] = 10.0f;
  scene.textures.push_back(checker);
  scene.materials[0].parameters[0].texture = 0;
  scene.sky = {Color(1.0f), Color(1.0f)};
  const Image image = render_scene(scene, image_options(40, 40, 64, 3));
  int dark = 0, bright = 0;
  for (const float v : image.rgb) {
    dark += std::abs(v - 0.2f) < 0.02f;
    bright += std::abs(v - 0.8f) < 0.02f;
  }
  const int all = static_cast<int>(image.rgb.size());
  EXPECT_GT(dark, all / 3);
  EXPECT_GT(bright, all / 3);
}

TEST(TriangleScenes, OneSidedSurfacesAreBlackFromBehind) {
  SceneData scene = floor_scene();
  scene.materials[0].one_sided = true;
  scene.sky = {Color(1.0f), Color(1.0f)};
  EXPECT_GT(mean_of(render_scene(scene, image_options(8, 8, 16, 3))), 0.4);
  scene.camera.look_from = {0, -4, 0.01f};
  EXPECT_EQ(mean_of(render_scene(scene, image_options(8, 8, 16, 3))), 0.0);
}

// A closed room in a bright sky: whatever of the sky is seen has leaked.
TEST(TriangleScenes, NoLightLeaksAtAnyScale) {
  for (const char* name : {"boxes:1e-3", "boxes", "boxes:1e5"}) {
    for (const AccelKind accel : {AccelKind::bvh2, AccelKind::cwbvh}) {
      Options options = image_options(40, 30, 8, 8);
      options.scene = name;
      options.accel = accel;
      SceneData scene = build_scene(options);
      for (MaterialDescription& material : scene.materials)
        material.emission.radiance = Color(0.0f);
      scene.sky = {Color(1.0f), Color(1.0f)};
      EXPECT_EQ(mean_of(render_scene(scene, options)), 0.0) << name;
    }
  }
}

// The structure is a matter of speed alone: hits at one distance go to the lowest triangle.
TEST(TriangleScenes, StructureAndBuilderDoNotChangeABit) {
  for (const char* scene : {"boxes", "instances:20", "statue:3K"}) {
    Options options = image_options(40, 30, 2, 5);
    options.scene = scene;
    options.device.kind = DeviceChoice::Kind::cpu;
    options.accel = AccelKind::bvh2;
    const Rendered expected = render_options(options);
    for (const Settings& settings : {Settings{{"accel", "cwbvh"}}, Settings{{"builder", "sbvh"}},
                                     Settings{{"accel", "cwbvh"}, {"builder", "sbvh"}}}) {
      SCOPED_TRACE(command_of(with(options, settings)));
      expect_same(render_options(with(options, settings)), expected);
    }
  }
}

/// Where real scenes parted: ../shared/scenes.
TEST(TriangleScenes, StructureDoesNotChangeFiles) {
  for (const char* file :
       {"modern-hall/scene.xml", "grey-white-room/scene.xml", "balloon-gltf/scene.gltf"}) {
    Options options = image_options(160, 90, 8, 8);
    options.scene = shared_file(std::string("scenes/") + file);
    if (!std::filesystem::exists(options.scene)) GTEST_SKIP() << "no " << options.scene;
    options.device.kind = DeviceChoice::Kind::cpu;
    const Rendered expected = render_options(with(options, {{"accel", "bvh2"}}));
    for (const Settings& settings :
         {Settings{{"accel", "bvh2"}, {"builder", "sbvh"}}, Settings{{"accel", "cwbvh"}},
          Settings{{"accel", "cwbvh"}, {"builder", "sbvh"}}}) {
      SCOPED_TRACE(command_of(with(options, settings)));
      expect_same(render_options(with(options, settings)), expected);
    }
  }
}

TEST(TriangleScenes, StructureDoesNotChangeMixedScenes) {
  Options options = image_options(40, 30, 2, 5);
  options.accel = AccelKind::brute;
  const Image expected = render_scene(mixed_scene(), options);
  EXPECT_GT(mean_of(expected), 0.05);
  for (const AccelKind accel : {AccelKind::bvh2, AccelKind::cwbvh}) {
    for (const TreeBuilder builder : {TreeBuilder::sah, TreeBuilder::sbvh}) {
      options.accel = accel, options.builder = builder;
      EXPECT_EQ(differing_pixels(render_scene(mixed_scene(), options), expected), 0u);
    }
  }
}

TEST(TriangleScenes, BuildersOfTheDeviceLeaveTheTreeToIt) {
  SceneData mixed = floor_scene();
  mixed.add_sphere({0, 1, 0}, 1, 0);
  Options options;
  options.builder = TreeBuilder::hploc;
  options.device.kind = DeviceChoice::Kind::cuda;
  for (SceneData scene : {mixed, placed_emitter(true, false)}) {
    prepare_scene(scene, options);
    EXPECT_TRUE(scene.tree.is_empty());
    EXPECT_EQ(scene.bvh_nodes.empty(), scene.spheres.empty()) << "spheres are the host's";
  }
  const auto refuse = [&](SceneData scene, const Settings& settings, const std::string& part) {
    expect_error([&] { prepare_scene(scene, with(options, settings)); }, part);
  };
  refuse(mixed, {{"accel", "brute"}}, "--builder hploc: builds binary and wide trees");
  refuse(mixed, {{"mode", "serial"}}, "--builder hploc: needs a CUDA device");
  refuse(mixed, {{"device", "cpu"}}, "--builder hploc: needs a CUDA device");
  mixed.meshes[0].triangles[1].v[2] = 4;
  refuse(mixed, {}, "mesh 0, triangle 1: vertex 4");
  SceneData placed = placed_emitter(true, false);
  placed.instances[0].to_world = scale({1, 0, 1});
  refuse(placed, {}, "instance 0: expected a transform");
}

TEST(TriangleScenes, EmbreeGivesNearlyTheSameImage) {
  Options options = image_options(64, 48, 4, 4);
  options.scene = "boxes";
  options.device.kind = DeviceChoice::Kind::cpu;
  const Rendered ours = render_options(options);
  options.accel = AccelKind::embree;
  if (embree_version().empty()) GTEST_SKIP() << "ptexp was built without Embree";
  const Rendered theirs = render_options(options);
  std::size_t far = 0;
  for (std::size_t i = 0; i < ours.image.rgb.size(); ++i) {
    far += std::abs(ours.image.rgb[i] - theirs.image.rgb[i]) > 1e-3f;
  }
  EXPECT_LT(far, ours.image.rgb.size() / 50);
}

TEST(TriangleScenes, TheTogglesOfThePaperAreRefused) {
  Options options = image_options(8, 8, 1, 3);
  options.scene = "boxes";
  options.device.kind = DeviceChoice::Kind::cpu;
  options.rng = RngKind::xorwow;
  EXPECT_THROW(render_options(options), Error);
  options.rng = RngKind::philox;
  options.branching = Branching::reduced;
  EXPECT_THROW(render_options(options), Error);
}

}  // namespace
}  // namespace pt
