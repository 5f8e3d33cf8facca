// Masks: against analytic means, against geometry cut to the same shape, and in all structures and
// modes.
#include <gtest/gtest.h>

#include "common/error/error.h"
#include "mode_cases.h"
#include "render_serial.h"
#include "scene/mixed_scene.h"
#include "scene/nested_scenes.h"
#include "statistics.h"

namespace pt {
namespace {

/// A material that only emits, everywhere alike; its opacity is `a`.
std::uint32_t add_glow(SceneData& scene, const Color& radiance, const Opacity& a) {
  MaterialDescription m = make_diffuse(Color(0.0f), radiance);
  m.opacity = a;
  return scene.add_material(m);
}

MeanEstimate channel(const Image& image, std::size_t c) {
  MeanEstimate estimate;
  for (std::size_t i = c; i < image.rgb.size(); i += 3) estimate.add(image.rgb[i]);
  return estimate;
}

Image picture_of(SceneData scene, int spp, int depth, const Settings& settings = {}) {
  const Options options = with(image_options(24, 24, spp, depth), settings);
  prepare_scene(scene, options);
  return render(scene, options).image;
}

TEST(Masks, AConstantOpacityMixesFrontAndBack) {
  for (const float a : {0.2f, 0.5f, 0.9f}) {
    SceneData scene;
    scene.meshes.push_back(wall_mesh(add_glow(scene, {4, 2, 0}, constant_opacity(a)), 1.0f));
    scene.meshes.push_back(wall_mesh(add_glow(scene, {0, 2, 8}, {})));
    look_at_wall(scene);
    const Image image = picture_of(scene, 64, 1);
    const Color expected = a * Color(4, 2, 0) + (1 - a) * Color(0, 2, 8);
    for (std::size_t c = 0; c < 3; ++c) {
      const MeanEstimate e = channel(image, c);
      EXPECT_NEAR(e.mean(), expected[static_cast<int>(c)], 5 * e.sigma() + 1e-6);
    }
  }
}

// Two sheets over a floor that a directional light falls on: the camera is below them, so that it
// sees the floor alone, and its shadow is the product of what they let through.
TEST(Masks, ShadowsAreTheProductOfWhatIsLetThrough) {
  SceneData scene;
  scene.meshes.push_back(wall_mesh(add_diffuse(scene, Color(0.5f))));
  for (const float a : {0.5f, 0.25f}) {
    MaterialDescription sheet = make_diffuse(Color(0.0f));
    sheet.opacity = constant_opacity(a);
    scene.meshes.push_back(wall_mesh(scene.add_material(sheet), 6.0f + a, 30.0f));
  }
  DeltaLight sun;
  sun.kind = LightKind::directional, sun.direction = {0, 0, -1}, sun.intensity = Color(pi);
  scene.delta_lights.push_back(sun);
  look_at_wall(scene);
  const MeanEstimate e = channel(picture_of(scene, 64, 2), 0);
  EXPECT_NEAR(e.mean(), 0.5 * 0.5 * 0.75, 5 * e.sigma());
  EXPECT_LT(e.sigma(), 2e-3);
}

/// A board of 8 x 8 squares at z = 1, of which every second is there: as a picture, or as geometry.
SceneData board(bool is_cut, float cutoff) {
  SceneData scene;
  std::vector<Color> squares;
  for (int i = 0; i < 64; ++i) squares.emplace_back((i + i / 8) % 2 == 0 ? 0.8f : 0.1f);
  MaterialDescription dark = make_diffuse({0.4f, 0.1f, 0.1f});
  if (!is_cut) {
    dark.opacity =
        textured_opacity(1.0f, add_picture(scene, 8, 8, squares, nearest_look()), cutoff);
  }
  Mesh mesh = wall_mesh(scene.add_material(dark), 1.0f, 4.0f);
  if (is_cut) {
    mesh.positions.clear(), mesh.triangles.clear(), mesh.uvs.clear();
    for (int i = 0; i < 64; ++i) {
      if ((i + i / 8) % 2 != 0) continue;
      const auto x = static_cast<float>(i % 8) - 4, y = static_cast<float>(i / 8) - 4;
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const Vec2& p : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) {
        mesh.positions.emplace_back(x + p.x, y + p.y, 1.0f);
      }
      mesh.triangles.push_back({{first, first + 1, first + 2}});
      mesh.triangles.push_back({{first, first + 2, first + 3}});
    }
  }
  scene.meshes.push_back(mesh);
  scene.meshes.push_back(wall_mesh(add_diffuse(scene, {0.2f, 0.6f, 0.9f}), 0.0f, 5.0f));
  DeltaLight sun;
  sun.kind = LightKind::directional, sun.direction = glm::normalize(Vec3(0.3f, 0.2f, -1));
  sun.intensity = Color(pi);
  scene.delta_lights.push_back(sun);
  scene.camera = {{0.3f, -6, 7}, {0, 0, 0}, {0, 0, 1}, 60.0f, 0.0f, 9.0f};
  return scene;
}

// What is met is the same; the light that a square reflects is rounded otherwise where its
// triangles are others.
TEST(Masks, ACutoffIsGeometryCutToItsShape) {
  for (const float cutoff : {0.5f, 0.8f}) {
    const Image masked = picture_of(board(false, cutoff), 8, 2);
    const Image cut = picture_of(board(true, cutoff), 8, 2);
    for (std::size_t i = 0; i < cut.rgb.size(); ++i) {
      ASSERT_NEAR(masked.rgb[i], cut.rgb[i], 2e-6f) << "value " << i;
    }
  }
  const Image nothing = picture_of(board(false, 0.9f), 8, 2),
              all = picture_of(board(false, 0.1f), 8, 2);
  EXPECT_GT(differing_pixels(nothing, all), 100u);
}

// A lamp that is masked is not asked, since what it sends depends on where; so chance finds it.
TEST(Masks, AMaskedLampShinesAsMuchAsIsThere) {
  SceneData scene;
  scene.meshes.push_back(wall_mesh(add_diffuse(scene, Color(0.5f))));
  Mesh lamp = wall_mesh(add_glow(scene, Color(3.0f), constant_opacity(0.4f)), 3.0f, 40.0f);
  for (TriangleIndices& t : lamp.triangles) std::swap(t.v[0], t.v[1]);  // downwards
  scene.meshes.push_back(lamp);
  scene.meshes.push_back(wall_mesh(add_glow(scene, {0, 0, 1}, {}), 20.0f, 1.0f));
  scene.camera = {{0, 0, 2}, {0, 0.01f, 0}, {0, 1, 0}, 20.0f, 0.0f, 2.0f};
  for (const char* nee : {"on", "off"}) {
    const MeanEstimate e = channel(picture_of(scene, 256, 2, {{"nee", nee}}), 0);
    EXPECT_NEAR(e.mean(), 0.5 * 0.4 * 3.0, 5 * e.sigma() + 0.004) << "--nee " << nee;
  }
}

/// Everything at once: instances and quads with masks, blends, maps and two sides.
SceneData rich_scene() {
  SceneData scene = mixed_scene();
  const std::uint32_t spots = add_picture(scene, 4, 4, [] {
    std::vector<Color> colors;
    for (int i = 0; i < 16; ++i) colors.emplace_back(static_cast<float>(i * 7 % 16) / 15);
    return colors;
  }());
  const std::uint32_t bumpy = scene.add_material(make_mapped(
      MaterialNode::bump_map, {{3, 0, 0}, spots}, add_diffuse(scene, {0.8f, 0.5f, 0.3f})));
  const std::uint32_t leaf =
      scene.add_material(make_two_sided(bumpy, add_diffuse(scene, Color(0.3f))));
  MaterialDescription veil = make_blend({Color(0.8f), spots}, leaf, add_diffuse(scene, {0, 0, 1}));
  veil.opacity = textured_opacity(1.0f, spots);
  MaterialDescription lace = scene.materials[leaf];
  lace.opacity = textured_opacity(1.0f, spots, 0.4f);
  const std::uint32_t veil_number = scene.add_material(veil),
                      lace_number = scene.add_material(lace);
  for (std::size_t i = 0; i < 4; ++i) {
    scene.meshes[i].material = i % 2 == 0 ? veil_number : lace_number;
  }
  scene.add_quad({-30, 5, -30}, {0, 0, 60}, {60, 0, 0}, veil_number);
  return scene;
}

Rendered render_rich(const std::string& mode, const Settings& settings) {
  Options options = with(image_options(40, 30, 3, 6), {{"device", "cpu"}, {"mode", mode}});
  apply(options, settings);
  SceneData scene = rich_scene();
  prepare_scene(scene, options);
  EXPECT_TRUE(scene.traits.has_masks);
  return take_image(*make_renderer(options, scene, choose_device(options.device)));
}

TEST(Masks, AllStructuresAndModesAgreeBitForBit) {
  const Rendered expected = render_rich("serial", {{"accel", "brute"}});
  expect_plausible(expected, image_options(40, 30, 3, 6));
  for (const std::string& accel : structures(AccelKind::brute)) {
    for (const std::string& mode : names_of(Mode::serial)) {
      SCOPED_TRACE(std::string(mode) + " " + accel);
      expect_same(render_rich(mode, {{"accel", accel}}), expected);
    }
  }
  for (const std::string& compaction : names_of(Compaction::atomic)) {
    SCOPED_TRACE(compaction);
    expect_same(
        render_rich("wavefront",
                    {{"compaction", compaction}, {"pool-size", "333"}, {"finish-paths", "0"}}),
        expected);
  }
  EXPECT_GT(differing_pixels(render_rich("serial", {{"seed", "7"}}).image, expected.image), 1000u);
}

TEST(Masks, AreNotForEmbreeNorSpheres) {
  const auto problem = [](SceneData scene, const Settings& settings) -> std::string {
    try {
      prepare_scene(scene, with({}, settings));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(
      problem(rich_scene(), {{"accel", "embree"}}).find("expected --accel brute or bvh2 or cwbvh"),
      std::string::npos);
  SceneData scene = mixed_scene();
  scene.materials[0].opacity = constant_opacity(0.5f);
  EXPECT_NE(problem(scene, {}).find("a sphere of material 0, which is masked"), std::string::npos);
}

}  // namespace
}  // namespace pt
