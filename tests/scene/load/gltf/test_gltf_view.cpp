// The glTF loader: lights and cameras.
#include "common/light/spot_light.h"
#include "load/expect_near.h"
#include "load/gltf_files.h"

namespace pt {
namespace {

/// The triangle and a node with a light, turned by -90 degrees about x: -z becomes -y.
GltfMaker with_light(const Json& light) {
  GltfMaker maker = triangle_file();
  const float h = std::sqrt(0.5f);
  maker.root["nodes"].push_back({{"translation", {1, 5, 2}},
                                 {"rotation", {-h, 0, 0, h}},
                                 {"scale", {2, 2, 2}},
                                 {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  maker.root["scenes"][0]["nodes"] = {0, 1};
  maker.root["extensions"] = {{"KHR_lights_punctual", {{"lights", {light}}}}};
  return maker;
}

TEST(GltfLights, Point) {
  const Loaded loaded(with_light({{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 20}}));
  ASSERT_EQ(loaded.scene.delta_lights.size(), 1u);
  const DeltaLight& light = loaded.scene.delta_lights[0];
  EXPECT_EQ(light.kind, LightKind::point);
  expect_near(light.position, {1, 5, 2});
  expect_near(light.intensity, {20, 10, 0});
  EXPECT_TRUE(is_black(loaded.scene.sky.zenith));
  EXPECT_EQ(loaded.scene.environment.width, 0);
  EXPECT_EQ(loaded.count("no light"), 0u);
  EXPECT_TRUE(loaded.scene.defaults.measure_exposure) << "candela";
}

TEST(GltfLights, Spot) {
  const Loaded loaded(with_light({{"type", "spot"},
                                  {"intensity", 3},
                                  {"range", 10},
                                  {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 1.0}}}}));
  const DeltaLight& light = loaded.scene.delta_lights.at(0);
  EXPECT_EQ(light.kind, LightKind::spot);
  expect_near(light.position, {1, 5, 2});
  expect_near(light.direction, {0, -1, 0});
  expect_near(light.intensity, {3, 3, 3});
  EXPECT_NEAR(light.cos_inner, std::cos(0.5), 1e-6);
  EXPECT_NEAR(light.cos_outer, std::cos(1.0), 1e-6);
  EXPECT_EQ(loaded.count("ranges of lights"), 1u);
  // The square of what the specification's lightAngleScale and -Offset make of the cosine.
  const double scale = 1 / (std::cos(0.5) - std::cos(1.0)), cosine = std::cos(0.8);
  EXPECT_NEAR(spot_share(light, static_cast<float>(cosine)),
              std::pow(scale * (cosine - std::cos(1.0)), 2), 1e-5);
}

TEST(GltfLights, Directional) {
  const Loaded loaded(with_light({{"type", "directional"}}));
  const DeltaLight& light = loaded.scene.delta_lights.at(0);
  EXPECT_EQ(light.kind, LightKind::directional);
  expect_near(light.direction, {0, -1, 0});
  expect_near(light.intensity, {1, 1, 1});
}

TEST(GltfLights, AreChecked) {
  expect_error([] { Loaded(with_light({{"type", "area"}})); }, "lights[0].type: 'area'");
  expect_error([] { Loaded(with_light({{"type", "point"}, {"intensity", -1}})); }, "lights[0]");
  expect_error(
      [] {
        Loaded(with_light(
            {{"type", "spot"}, {"spot", {{"innerConeAngle", 1.0}, {"outerConeAngle", 0.5}}}}));
      },
      "lights[0].spot");
}

GltfMaker with_camera(const Json& camera) {
  GltfMaker maker = triangle_file();
  const float h = std::sqrt(0.5f);
  maker.root["nodes"].push_back(
      {{"camera", 0}, {"translation", {10, 0, 0}}, {"rotation", {0, h, 0, h}}});
  maker.root["nodes"].push_back({{"camera", 0}});
  maker.root["scenes"][0]["nodes"] = {0, 1, 2};
  maker.root["cameras"] = {camera};
  return maker;
}

TEST(GltfCameras, Perspective) {
  const Loaded loaded(
      with_camera({{"type", "perspective"},
                   {"perspective", {{"yfov", 0.5}, {"aspectRatio", 1.5}, {"znear", 0.1}}}}));
  const CameraParameters& camera = loaded.scene.camera;
  expect_near(camera.look_from, {10, 0, 0});
  expect_near(normalize(camera.look_at - camera.look_from), {-1, 0, 0});
  expect_near(camera.up, {0, 1, 0});
  EXPECT_NEAR(camera.fov_degrees, 28.64789f, 1e-4f);
  EXPECT_NEAR(camera.focus_distance, 9.5f, 1e-5f);  // the triangle's middle is x = 0.5
  ASSERT_TRUE(loaded.scene.defaults.width && loaded.scene.defaults.height);
  EXPECT_EQ(*loaded.scene.defaults.width * 2, *loaded.scene.defaults.height * 3);
  EXPECT_EQ(loaded.count("no camera"), 0u);
}

TEST(GltfCameras, OrthographicIsReplacedByOneThatSeesAsMuch) {
  const Loaded loaded(
      with_camera({{"type", "orthographic"},
                   {"orthographic", {{"xmag", 4}, {"ymag", 2}, {"znear", 0.1}, {"zfar", 100}}}}));
  const CameraParameters& camera = loaded.scene.camera;
  EXPECT_EQ(loaded.count("orthographic"), 1u);
  expect_near(camera.look_at, {0.5f, 0, 0}, 1e-4f);
  const float distance = glm::length(camera.look_at - camera.look_from);
  EXPECT_NEAR(distance * std::tan(0.5f * camera.fov_degrees * pi / 180.0f), 2.0f, 1e-4f);
  expect_near(normalize(camera.look_at - camera.look_from), {-1, 0, 0});
  EXPECT_EQ(*loaded.scene.defaults.width, 2 * *loaded.scene.defaults.height);
}

TEST(GltfCameras, WithoutOneTheSceneIsFramed) {
  const Loaded loaded(triangle_file());
  EXPECT_EQ(loaded.count("no camera"), 1u);
  EXPECT_EQ(loaded.count("no light"), 1u);
  EXPECT_GT(loaded.scene.environment.width, 0);
  constexpr int size = 100;
  const Camera camera = make_camera(loaded.scene.camera, size, size);
  const Vec3 forward = normalize(loaded.scene.camera.look_at - loaded.scene.camera.look_from);
  for (const Vec3& p : loaded.scene.meshes.at(0).positions) {
    // Where the ray to the vertex passes the film.
    const Vec3 d = p - camera.origin;
    const Vec3 on_plane = d * (loaded.scene.camera.focus_distance / glm::dot(d, forward));
    const Vec3 from_corner = on_plane - camera.corner;
    for (const Vec3& step : {camera.step_x, camera.step_y}) {
      const float pixel = glm::dot(from_corner, step) / glm::dot(step, step);
      EXPECT_GT(pixel, 0.0f);
      EXPECT_LT(pixel, static_cast<float>(size));
    }
  }
  expect_error(
      [] {
        Loaded(
            with_camera({{"type", "perspective"}, {"perspective", {{"yfov", 4}, {"znear", 1}}}}));
      },
      "cameras[0].perspective.yfov");
}

}  // namespace
}  // namespace pt
