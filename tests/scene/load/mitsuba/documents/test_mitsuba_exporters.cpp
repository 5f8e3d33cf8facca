// Files in the conventions of exporters: names, matrices, units, nesting, paths. Made by hand for
// this test, but for the one of Mitsuba 3.9.1's own writer; the numbers follow from them by hand.
#include <gtest/gtest.h>

#include "load/expect_near.h"
#include "load/mitsuba_scene.h"
#include "test_data.h"

namespace pt {
namespace {

LoadedScene exported(const std::string& name) {
  return load_with_warnings(test_data("mitsuba_exporters/" + name + ".xml"));
}

const MaterialDescription& material_called(const SceneData& scene, const std::string& name) {
  for (const auto& [material, own] : scene.names.materials) {
    if (own == name) return scene.materials.at(material);
  }
  ADD_FAILURE() << "no material " << name;
  return scene.materials.at(0);
}

/// Where the camera is, where it looks and what is up in its picture, unit lengths.
void expect_view(const SceneData& scene, const Vec3& from, const Vec3& forward, const Vec3& up) {
  const CameraParameters& camera = scene.camera;
  expect_near(camera.look_from, from, 1e-4f);
  const Vec3 along = glm::normalize(camera.look_at - camera.look_from);
  expect_near(along, glm::normalize(forward), 1e-4f);
  const Vec3 right = glm::normalize(glm::cross(along, camera.up));
  const Vec3 wanted = glm::normalize(glm::cross(glm::normalize(forward), up));
  expect_near(right, wanted, 1e-4f);
}

void expect_image(const SceneData& scene, int width, int height, int spp) {
  EXPECT_EQ(scene.defaults.width, width);
  EXPECT_EQ(scene.defaults.height, height);
  EXPECT_EQ(scene.defaults.spp, spp);
}

void expect_silent(const LoadedScene& loaded) {
  EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
}

TEST(MitsubaExporters, Mitsuba3Writer) {
  const LoadedScene loaded = exported("mitsuba3_writer");
  const SceneData& scene = loaded.scene;
  expect_silent(loaded);
  expect_image(scene, 64, 48, 64);
  expect_view(scene, {0, 1, 6}, {0, -1, -6}, {0, 1, 0});
  EXPECT_EQ(scene.defaults.max_depth, 5);
  EXPECT_EQ(scene.camera.fov_degrees, 40.0f);
  EXPECT_EQ(scene.spheres.size(), 2u);
  EXPECT_EQ(scene.textures.at(0).color1, Color(0.7f));
  expect_near(scene.delta_lights.at(0).position, {3, 3, 3});
  EXPECT_EQ(scene.delta_lights.at(0).intensity, Color(5.0f));
  expect_near(scene.sky.zenith, Color(0.4f));
  bool lamp = false, blend = false;
  for (const MaterialDescription& m : scene.materials) {
    lamp = lamp || m.emission.radiance == Color(13.5f, 12, 9);
    blend = blend || (m.node == MaterialNode::blend && m.scalar(0) == 0.3f &&
                      scene.materials[m.children[0]].color(0) == Color(0.2f, 0.7f, 0.3f) &&
                      scene.materials[m.children[1]].color(0) == Color(0.2f));
  }
  EXPECT_TRUE(lamp && blend);
}

// Blender's default scene. Its camera looks at the cube's height a little beside it.
TEST(MitsubaExporters, BlenderAddOn) {
  const LoadedScene loaded = exported("blender_mitsuba3");
  const SceneData& scene = loaded.scene;
  expect_silent(loaded);
  expect_image(scene, 96, 54, 64);
  const double tilt = 63.5593 * std::acos(-1.0) / 180, turn = 46.69194 * std::acos(-1.0) / 180;
  // By hand: -z of a camera that was tilted about x and turned about z.
  const Vec3 forward(-std::sin(tilt) * std::sin(turn), std::sin(tilt) * std::cos(turn),
                     -std::cos(tilt));
  expect_view(scene, {7.358891f, -6.925791f, 4.958309f}, forward, {0, 0, 1});
  EXPECT_FALSE(scene.camera.mirrored);
  EXPECT_EQ(scene.meshes.size(), 2u);
  const MaterialDescription& red = material_called(scene, "mat-Material.001");
  EXPECT_EQ(red.kind, kind_of<Principled>);
  EXPECT_EQ(red.color(0), Color(0.8f, 0.1f, 0.1f));
  EXPECT_FALSE(red.one_sided);
  EXPECT_FALSE(material_called(scene, "default-bsdf").one_sided);
  EXPECT_EQ(scene.names.delta_lights.at(0), "emit-Light");
  EXPECT_EQ(scene.delta_lights.at(0).position.z, 5.903862f);
}

TEST(MitsubaExporters, BlenderMtsblend) {
  const LoadedScene loaded = exported("blender_mtsblend05");
  const SceneData& scene = loaded.scene;
  expect_silent(loaded);
  expect_image(scene, 96, 54, 16);
  expect_view(scene, {0, -9, 2.5f}, {0, 9, -2.5f}, {0, 0, 1});
  EXPECT_TRUE(scene.camera.mirrored);  // its scale of x by -1
  EXPECT_EQ(scene.defaults.max_depth, 16);
  EXPECT_EQ(scene.defaults.rr_depth, 10);
  EXPECT_EQ(scene.camera.near_clip, 0.1f);
  const MaterialDescription& floor = material_called(scene, "Material.Floor-material");
  ASSERT_NE(floor.parameters[0].texture, no_texture);
  EXPECT_EQ(scene.textures.at(floor.parameters[0].texture).u_row[0], 2.0f);
  const MaterialDescription& cube = material_called(scene, "Material.Cube-material");
  EXPECT_EQ(cube[&RoughPlastic::alpha].value.x, 0.2f);
  expect_near(scene.delta_lights.at(0).direction, glm::normalize(Vec3(1, 1, -2)));
  EXPECT_EQ(scene.delta_lights.at(0).intensity, Color(2.0f, 1.9f, 1.8f));
}

TEST(MitsubaExporters, Maya) {
  const LoadedScene loaded = exported("maya_mtsmaya05");
  const SceneData& scene = loaded.scene;
  expect_silent(loaded);
  expect_view(scene, {0, 2, 7}, {0, -2, -7}, {0, 1, 0});
  // #80 of 255 by IEC 61966-2-1.
  expect_near(material_called(scene, "lambert1").color(0), Color(0.2158605f), 1e-5f);
  EXPECT_EQ(scene.delta_lights.at(0).cos_inner, scene.delta_lights.at(0).cos_outer);
  expect_near(scene.delta_lights.at(0).direction, glm::normalize(Vec3(-3, -6, -3)), 1e-5f);
  EXPECT_EQ(scene.sky.zenith, Color(0.2f));
  EXPECT_NEAR(scene.meshes.at(0).positions.at(0).y, -1.0f, 1e-5f);
}

TEST(MitsubaExporters, Max) {
  const LoadedScene loaded = exported("3dsmax_06");
  const SceneData& scene = loaded.scene;
  EXPECT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(loaded.count("whose case differs"), 1);  // textures\WOOD.PNG
  EXPECT_EQ(loaded.count("Cube.obj is used"), 1);    // D:\projects\meshes\Cube.obj
  EXPECT_EQ(loaded.count("missing.png"), 1);
  EXPECT_EQ(loaded.warnings.size(), 3u);
  expect_view(scene, {0, -8, 2}, {0, 0.970143f, -0.242536f}, {0, 0, 1});
  const MaterialDescription& floor = material_called(scene, "Material #25");
  EXPECT_EQ(floor.kind, kind_of<Phong>);
  EXPECT_EQ(scene.textures.at(floor.parameters[0].texture).wrap_v, TextureWrap::mirror);
  EXPECT_EQ(material_called(scene, "01 - Default").kind, kind_of<Conductor>);  // without its map
  EXPECT_EQ(scene.delta_lights.at(0).intensity, Color(40.0f));
}

TEST(MitsubaExporters, Rhino) {
  const LoadedScene loaded = exported("rhino_05");
  const SceneData& scene = loaded.scene;
  EXPECT_EQ(loaded.count("<spectrum> of wavelengths"), 1);
  EXPECT_EQ(loaded.warnings.size(), 1u);
  expect_view(scene, {6, -7, 4}, {-6, 7, -4}, {0, 0, 1});
  EXPECT_EQ(scene.camera.fov_axis, FovAxis::diagonal);
  EXPECT_EQ(scene.defaults.max_depth, 2);
  EXPECT_EQ(material_called(scene, "layer_default").color(0), Color(0.6f));
  const MaterialDescription& red = scene.materials.at(scene.meshes.at(0).material);
  EXPECT_GT(red.color(0).x, 0.5f);
  EXPECT_LT(red.color(0).z, 0.1f);
  EXPECT_FALSE(red.one_sided);
  // Its sky's zenith is +z.
  expect_near(scene.environment.to_world.vector({0, 1, 0}), {0, 0, 1}, 1e-5f);
}

TEST(MitsubaExporters, SketchUp) {
  const LoadedScene loaded = exported("sketchup_05");
  const SceneData& scene = loaded.scene;
  expect_silent(loaded);
  expect_view(scene, {0, -8, 3}, {0, 8, -3}, {0, 0, 1});
  EXPECT_EQ(scene.camera.fov_axis, FovAxis::vertical);
  EXPECT_EQ(scene.sky.zenith, Color(0.4f));
  const MaterialDescription& lamp = scene.materials.at(scene.quad_material.at(0));
  EXPECT_GT(lamp.emission.radiance.x, lamp.emission.radiance.z);  // 5000 K
  EXPECT_GT(lamp.emission.radiance.z, 0.0f);
  EXPECT_NE(lamp.emission.radiance.y, 1.0f);
  expect_near(scene.quads.at(0).normal, {0, 0, -1}, 1e-5f);
}

TEST(MitsubaExporters, Tungsten) {
  const LoadedScene loaded = exported("tungsten_05");
  const SceneData& scene = loaded.scene;
  expect_silent(loaded);
  expect_image(scene, 64, 64, 64);
  expect_view(scene, {0, 1, 6.8f}, {0, 0, -1}, {0, 1, 0});
  EXPECT_EQ(scene.defaults.max_depth, 65);
  EXPECT_EQ(scene.quads.size(), 3u + 6u);
  expect_near(scene.quads.at(0).normal, {0, 1, 0}, 1e-5f);  // the floor
  EXPECT_EQ(material_called(scene, "Metal").color(0), Color(0.8f));
  const MaterialDescription& lamp = scene.materials.at(scene.quad_material.back());
  EXPECT_EQ(lamp.emission.radiance, Color(17, 12, 4));
  EXPECT_NEAR(scene.quads.back().normal.y, -1.0f, 1e-5f);
}

TEST(MitsubaExporters, PbrtConverter) {
  const LoadedScene loaded = exported("pbrt_converter_06");
  const SceneData& scene = loaded.scene;
  EXPECT_EQ(loaded.count("sky_missing.exr"), 1);
  EXPECT_EQ(loaded.warnings.size(), 1u);
  expect_image(scene, 96, 54, 32);
  ASSERT_EQ(scene.media.size(), 1u);
  expect_near(scene.media[0].extinction, Color(0.4f));
  expect_near(scene.media[0].albedo, Color(0.75f));
  EXPECT_EQ(scene.media[0].phase_parameter, 0.5f);
  const MaterialDescription& mix = material_called(scene, "named_Mix");
  EXPECT_EQ(mix.scalar(0), 0.25f);
  EXPECT_EQ(scene.materials[mix.children[1]].color(0), Color(0.1f, 0.1f, 0.6f));
  EXPECT_EQ(scene.environment.pixels.at(0), Color(0.5f));
}

// The red is golden: test_mitsuba_spectra.cpp.
TEST(MitsubaExporters, CornellBoxOf06) {
  const LoadedScene loaded = exported("cornell_06");
  const SceneData& scene = loaded.scene;
  EXPECT_EQ(loaded.warnings.size(), 1u);
  expect_view(scene, {278, 273, -800}, {0, 0, 1}, {0, 1, 0});
  EXPECT_EQ(scene.camera.fov_axis, FovAxis::smaller);
  EXPECT_EQ(scene.camera.far_clip, 2800.0f);
  expect_near(material_called(scene, "red").color(0), {0.555274f, 0.0745531f, 0.037161f}, 1e-5f);
  expect_near(scene.materials.at(scene.quad_material.back()).emission.radiance,
              {20.7108f, 10.8546f, 2.77115f}, 1e-3f);
  expect_near(scene.quads.at(2).normal, {-1, 0, 0}, 1e-5f);
}

TEST(MitsubaExporters, Mitsuba2Gallery) {
  const LoadedScene loaded = exported("mitsuba2_gallery");
  const SceneData& scene = loaded.scene;
  EXPECT_EQ(loaded.count("normal_missing.png"), 1);
  expect_view(scene, {0, 3, 5}, {0, -3, -5}, {0, 1, 0});
  EXPECT_EQ(scene.defaults.max_depth, 5);
  EXPECT_FLOAT_EQ(scene.camera.aperture, 0.1f);
  EXPECT_EQ(scene.sky.zenith, Color(1.0f));
  // A constant spectrum in an emitter of Mitsuba 2 and 3 is equal energy.
  expect_near(scene.delta_lights.at(0).intensity, 30.0f * Color(1.20479f, 0.948293f, 0.908916f),
              1e-3f);
  EXPECT_EQ(scene.textures.at(0).filter, TextureFilter::nearest);
}

TEST(MitsubaExporters, DictToXml) {
  const LoadedScene loaded = exported("mitsuba3_dict_to_xml");
  const SceneData& scene = loaded.scene;
  EXPECT_EQ(loaded.warnings.size(), 0u);
  expect_image(scene, 96, 54, 16);
  EXPECT_TRUE(scene.camera.orthographic);
  EXPECT_NEAR(scene.camera.orthographic_size.x, 3.0f, 1e-5f);
  EXPECT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.meshes.size(), 2u);
  ASSERT_EQ(scene.sphere_frames.size(), 1u);
  EXPECT_EQ(scene.sphere_frames[0].side, -1.0f);
  EXPECT_EQ(scene.spheres[0].radius_squared, 0.25f);
}

}  // namespace
}  // namespace pt
