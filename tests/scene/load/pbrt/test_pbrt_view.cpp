// pbrt's cameras, films and integrators. pbrt's space is left-handed: mirrored images are what
// these tests are about.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "load/expect_near.h"
#include "load/pbrt_scene.h"

namespace pt {
namespace {

std::string with_camera(const std::string& transform, const std::string& camera, int width = 40,
                        int height = 20) {
  return fmt::format(
      "Film \"rgb\" \"integer xresolution\" {} \"integer yresolution\" {}\n{}\nCamera {}\n"
      "WorldBegin LightSource \"infinite\" Shape \"sphere\"",
      width, height, transform, camera);
}

Ray ray_at(const SceneData& scene, float x, float y, int width = 40, int height = 20) {
  return camera_ray(make_camera(scene.camera, width, height), x, y, 0.5f, 0.5f);
}

TEST(PbrtCamera, LooksAlongZWithXToTheRight) {
  const SceneData scene = load_pbrt_silently(with_camera("", "\"perspective\" \"float fov\" 60"));
  // The angle is of the shorter side. Right of and above the middle:
  const Ray ray = ray_at(scene, 30, 5);
  const float t = std::tan(30.0f * pi / 180.0f);
  expect_near(ray.origin, Vec3(0.0f));
  expect_near(ray.direction, glm::normalize(Vec3(2 * t * 0.5f, t * 0.5f, 1.0f)));
}

TEST(PbrtCamera, ShorterSideMayBeTheWidth) {
  const SceneData scene =
      load_pbrt_silently(with_camera("", "\"perspective\" \"float fov\" 60", 20, 40));
  const float t = std::tan(30.0f * pi / 180.0f);
  expect_near(ray_at(scene, 20, 0, 20, 40).direction, glm::normalize(Vec3(t, 2 * t, 1.0f)));
}

TEST(PbrtCamera, LookAtKeepsTheLeftHandedSpace) {
  const SceneData scene = load_pbrt_silently(
      with_camera("LookAt 1 2 3  1 2 -7  0 1 0", "\"perspective\" \"float fov\" 90"));
  // It looks along -z, so that cross(up, forward), which is -x, is to the right.
  const Ray ray = ray_at(scene, 30, 5);
  expect_near(ray.origin, {1, 2, 3});
  expect_near(ray.direction, glm::normalize(Vec3(-1.0f, 0.5f, -1.0f)));
}

TEST(PbrtCamera, AMirrorBeforeItMirrorsTheImage) {
  const SceneData scene = load_pbrt_silently(
      with_camera("Scale -1 1 1 LookAt 1 2 3  1 2 -7  0 1 0", "\"perspective\" \"float fov\" 90"));
  expect_near(ray_at(scene, 30, 5).direction, glm::normalize(Vec3(1.0f, 0.5f, -1.0f)));
}

TEST(PbrtCamera, TheViewIsTheWrittenOne) {
  const auto camera = [](const std::string& transform) {
    return load_pbrt_silently(with_camera(transform, "\"perspective\"")).camera;
  };
  const std::string look = "LookAt 1.1 2.3 3.7  2 0.1 2.5  0 1 0.3";
  for (const std::string before : {"", "Scale -1 1 1 ", "Scale 2 2 2 "}) {
    const CameraParameters written = camera(before + look);
    EXPECT_EQ(written.look_from, Vec3(1.1f, 2.3f, 3.7f)) << before;
    EXPECT_EQ(written.look_at, Vec3(2, 0.1f, 2.5f)) << before;
    EXPECT_EQ(written.up, Vec3(0, 1, 0.3f)) << before;
  }
  // Other views: moved, turned, or without its transformation.
  expect_near(camera(look + " Translate 5 0 0").look_from, {1.1f - 5, 2.3f, 3.7f});
  const CameraParameters turned = camera("Rotate 180 0 1 0 " + look);
  expect_near(glm::normalize(turned.look_at - turned.look_from),
              -glm::normalize(Vec3(0.9f, -2.2f, -1.2f)));
  expect_near(camera(look + " Identity").look_from, Vec3(0.0f));
}

TEST(PbrtCamera, TransformIsReadColumnByColumn) {
  // To the camera's space: x -> y -> z -> x, then moved by (1, 2, 3).
  const SceneData scene = load_pbrt_silently(
      with_camera("Transform [0 1 0 0  0 0 1 0  1 0 0 0  1 2 3 1]", "\"perspective\""));
  expect_near(scene.camera.look_from, {-2, -3, -1});
  expect_near(ray_at(scene, 20, 10).direction, {0, 1, 0});
}

TEST(PbrtCamera, ScreenWindowMovesAndCuts) {
  const SceneData scene = load_pbrt_silently(
      with_camera("", "\"perspective\" \"float fov\" 90 \"float screenwindow\" [ -1 3 0 2 ]"));
  expect_near(ray_at(scene, 0, 0).direction, glm::normalize(Vec3(-1, 2, 1)));
  expect_near(ray_at(scene, 40, 20).direction, glm::normalize(Vec3(3, 0, 1)));
}

TEST(PbrtCamera, OrthographicShowsTheWindowAsItIsScaled) {
  const SceneData scene =
      load_pbrt_silently(with_camera("Scale .5 .5 1 Translate -1 -2 -3", "\"orthographic\""));
  const Ray ray = ray_at(scene, 40, 0);
  expect_near(ray.direction, {0, 0, 1});
  expect_near(ray.origin, {1 + 4, 2 + 2, 3});
}

TEST(PbrtCamera, LensAndFocus) {
  const SceneData scene = load_pbrt_silently(
      with_camera("", "\"perspective\" \"float lensradius\" .25 \"float focaldistance\" 7"));
  EXPECT_FLOAT_EQ(scene.camera.aperture, 0.5f);
  EXPECT_FLOAT_EQ(scene.camera.focus_distance, 7.0f);
}

TEST(PbrtCamera, CoordinateSystemsAreRemembered) {
  const std::string text =
      "LookAt 1 2 3  1 2 4  0 1 0\nCamera \"perspective\"\nWorldBegin LightSource \"infinite\"\n"
      "Translate 5 5 5 CoordinateSystem \"here\" Identity CoordSysTransform \"camera\"\n"
      "Shape \"sphere\" CoordSysTransform \"here\" Shape \"sphere\"";
  const SceneData scene = load_pbrt_silently(text);
  ASSERT_EQ(scene.spheres.size(), 2u);
  expect_near(scene.spheres[0].center, {1, 2, 3});
  expect_near(scene.spheres[1].center, {5, 5, 5});
}

TEST(PbrtView, DefaultsArePbrts) {
  const LoadedScene loaded = load_pbrt_text("WorldBegin LightSource \"infinite\" Shape \"sphere\"");
  const SceneDefaults& defaults = loaded.scene.defaults;
  EXPECT_EQ(defaults.width, 1280);
  EXPECT_EQ(defaults.height, 720);
  EXPECT_EQ(defaults.spp, 16);
  EXPECT_EQ(defaults.max_depth, 6);  // five bounces
  EXPECT_EQ(defaults.filter->kind, FilterKind::gaussian);
  EXPECT_FLOAT_EQ(defaults.filter->a, 0.5f);
  EXPECT_EQ(loaded.count("no Camera"), 1);
}

TEST(PbrtView, CropIsInPartsOrPixelsOfTheFilm) {
  const auto crop = [](const std::string& film) {
    return *load_pbrt_silently(
                "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 20 " + film +
                " Camera \"perspective\" WorldBegin LightSource \"infinite\" Shape "
                "\"sphere\"")
                .defaults.crop;
  };
  EXPECT_EQ(crop("\"float cropwindow\" [ .25 .5 .1 1 ]"), (CropWindow{10, 2, 20, 20}));
  EXPECT_EQ(crop("\"integer pixelbounds\" [ 3 7 2 99 ]"), (CropWindow{3, 2, 7, 20}));
}

TEST(PbrtView, SamplersFiltersAndDepth) {
  const auto defaults = [](const std::string& directive) {
    return load_pbrt_silently(directive +
                              " Camera \"perspective\" WorldBegin LightSource \"infinite\" Shape "
                              "\"sphere\"")
        .defaults;
  };
  EXPECT_EQ(defaults("Sampler \"stratified\" \"integer xsamples\" 3 \"integer ysamples\" 5").spp,
            15);
  EXPECT_EQ(defaults("Sampler \"halton\" \"integer pixelsamples\" 7").spp, 7);
  EXPECT_EQ(defaults("Integrator \"path\" \"integer maxdepth\" 0").max_depth, 1);
  const FilterChoice mitchell =
      *defaults("PixelFilter \"mitchell\" \"float B\" .5 \"float C\" .25").filter;
  EXPECT_EQ(mitchell, (FilterChoice{FilterKind::mitchell, 0.5f, 0.25f}));
  EXPECT_EQ(
      *defaults("PixelFilter \"triangle\" \"float xradius\" 1.5 \"float yradius\" 1.5").filter,
      (FilterChoice{FilterKind::tent, 1.5f, 0.0f}));
}

}  // namespace
}  // namespace pt
