// The glTF loader: lights and cameras.
#include "common/light/point_lights.h"
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

/// What a lamp of wrong numbers gives: its place and the message, and whether it is left out.
struct BadLight {
  Json light;
  const char* message;
  bool is_lost;
};

TEST(GltfLights, ABadValueLosesItselfOrTheLamp) {
  const auto spot = [](double inner, double outer) {
    return Json{{"type", "spot"}, {"spot", {{"innerConeAngle", inner}, {"outerConeAngle", outer}}}};
  };
  const BadLight cases[] = {
      {{{"type", "area"}}, "lights[0].type: 'area': expected point, spot or directional", true},
      {{{"intensity", 5}}, "lights[0].type: '': expected", true},
      {{{"type", "point"}, {"intensity", -1}}, "lights[0]: expected a finite color", true},
      {{{"type", "point"}, {"intensity", 1e300}}, "lights[0]: expected a finite color", true},
      {{{"type", "point"}, {"color", {1, -1, 1}}}, "lights[0]: expected a finite color", true},
      {{{"type", "point"}, {"color", {1, 1}}}, "lights[0].color: expected three", false},
      {{{"type", "point"}, {"intensity", "x"}}, "lights[0].intensity: expected a number", false},
      {spot(1.0, 0.5), "lights[0].spot: innerConeAngle 1: expected 0 <=", false},
      {spot(-0.1, 0.5), "lights[0].spot: innerConeAngle -0.1: expected", false},
      {spot(0, 1.6), "lights[0].spot: outerConeAngle 1.6: expected 0 < ", false},
      {spot(0, 0), "lights[0].spot: outerConeAngle 0: expected 0 < ", false},
      {spot(0, -1), "lights[0].spot: outerConeAngle -1: expected 0 < ", false}};
  for (const auto& [light, message, is_lost] : cases) {
    const Loaded loaded(with_light(light));
    EXPECT_EQ(loaded.count(message), 1u) << light << testing::PrintToString(loaded.messages);
    EXPECT_EQ(loaded.scene.delta_lights.size(), is_lost ? 0u : 1u) << light;
    expect_error([&light = light] { Loaded strict(with_light(light), true); }, "--strict");
  }
  GltfMaker missing = with_light({{"type", "point"}});
  missing.root["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 3;
  EXPECT_EQ(Loaded(missing).count("nodes[1]: extensions.KHR_lights_punctual.lights[3]"), 1u);
  GltfMaker flat = with_light({{"type", "directional"}});
  flat.root["nodes"][1]["scale"] = {0, 0, 0};
  EXPECT_EQ(Loaded(flat).count("singular: the lamp is left out"), 1u);
}

// What three.js and Blender write for a lamp without a soft rim, and the defaults of the extension.
TEST(GltfLights, ConesOfAllKinds) {
  struct Cone {
    Json spot;
    double inner, outer;
    bool is_silent;
  };
  const double right = std::acos(0.0);
  const Cone cones[] = {
      {{{"innerConeAngle", 0.5}, {"outerConeAngle", 0.5}}, 0.5, 0.5, true},
      {{{"innerConeAngle", 0.0}, {"outerConeAngle", 0.3}}, 0.0, 0.3, true},
      {{{"innerConeAngle", right}, {"outerConeAngle", right}}, right, right, true},
      {Json::object(), 0, right / 2, true},
      {{{"innerConeAngle", 0.7}, {"outerConeAngle", 0.2}}, 0.2, 0.2, false},
      {{{"innerConeAngle", -1}, {"outerConeAngle", 0.2}}, 0, 0.2, false},
      {{{"innerConeAngle", 1.58}, {"outerConeAngle", 1.6}}, right, right, false},
      {{{"innerConeAngle", 0}, {"outerConeAngle", 0}}, 0, right / 2, false}};
  for (const Cone& cone : cones) {
    const Loaded loaded(with_light({{"type", "spot"}, {"spot", cone.spot}}));
    const DeltaLight& light = loaded.scene.delta_lights.at(0);
    EXPECT_NEAR(light.cos_inner, std::cos(cone.inner), 1e-6) << cone.spot;
    EXPECT_NEAR(light.cos_outer, std::cos(cone.outer), 1e-6) << cone.spot;
    EXPECT_EQ(loaded.count("ConeAngle") == 0, cone.is_silent) << cone.spot;
    const float rim = light.cos_outer;
    EXPECT_EQ(spot_share(light, rim + 1e-3f) > 0.0f, true);
    EXPECT_EQ(spot_share(light, rim - 1e-3f), 0.0f);
    EXPECT_EQ(spot_share(light, rim + 1e-3f) == 1.0f, cone.inner == cone.outer);
  }
  EXPECT_EQ(Loaded(with_light({{"type", "spot"}})).scene.delta_lights.size(), 1u);
}

GltfMaker with_camera(const Json& camera) {
  GltfMaker maker = triangle_file();
  const float h = std::sqrt(0.5f);
  maker.root["nodes"].push_back(
      {{"camera", 0}, {"translation", {10, 0, 0}}, {"rotation", {0, h, 0, h}}});
  maker.root["nodes"].push_back({{"camera", 0}});
  maker.root["scenes"][0]["nodes"] = {0, 1, 2};
  maker.root["cameras"] = Json::array({camera});
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

// A scene behind the camera has no distance that could be focused on.
TEST(GltfCameras, FocusOnWhatIsInFront) {
  const float h = std::sqrt(0.5f);
  const std::tuple<Json, Vec3, float> cases[] = {{{0, h, 0, h}, {-1, 0, 0}, 9.5f},
                                                 {{0, -h, 0, h}, {1, 0, 0}, 1.0f},
                                                 {{0, 0, 0, 1}, {0, 0, -1}, 1.0f}};
  for (const auto& [rotation, direction, distance] : cases) {
    GltfMaker maker = with_camera({{"type", "perspective"}, {"perspective", {{"yfov", 0.5}}}});
    maker.root["nodes"][1]["rotation"] = rotation;
    const CameraParameters camera = Loaded(maker).scene.camera;
    EXPECT_NEAR(camera.focus_distance, distance, 1e-5f) << rotation;
    expect_near(camera.look_at - camera.look_from, distance * direction);
  }
}

TEST(GltfCameras, OrthographicHasItsSizeAndPlanes) {
  const Loaded loaded(
      with_camera({{"type", "orthographic"},
                   {"orthographic", {{"xmag", 4}, {"ymag", -2}, {"znear", 0.25}, {"zfar", 100}}}}));
  const CameraParameters& camera = loaded.scene.camera;
  EXPECT_EQ(loaded.count("orthographic"), 0u);
  EXPECT_TRUE(camera.orthographic);
  expect_near(camera.look_from, {10, 0, 0});
  expect_near(normalize(camera.look_at - camera.look_from), {-1, 0, 0});
  EXPECT_EQ(camera.near_clip, 0.25f);
  EXPECT_EQ(camera.far_clip, 100.0f);
  ASSERT_EQ(*loaded.scene.defaults.width, 2 * *loaded.scene.defaults.height);
  // The corners of an image of any size of this shape.
  const Camera made = make_camera(camera, 40, 20);
  const Ray corner = camera_ray(made, 0, 0, 0.5f, 0.5f), other = camera_ray(made, 40, 20, 0, 0);
  expect_near(corner.origin, {9.75f, 2, 4}, 1e-4f);  // looks along -x: its right is -z
  expect_near(other.origin, {9.75f, -2, -4}, 1e-4f);
  expect_near(corner.direction, {-1, 0, 0});
}

TEST(GltfCameras, ABadValueLosesItself) {
  const auto ortho = [](double xmag, double ymag, double near, double far) {
    return Json{{"type", "orthographic"},
                {"orthographic", {{"xmag", xmag}, {"ymag", ymag}, {"znear", near}, {"zfar", far}}}};
  };
  const auto size = [](const Loaded& loaded) { return loaded.scene.camera.orthographic_size.x; };
  const Loaded no_x(with_camera(ortho(0, 3, 0, 10)));
  EXPECT_EQ(size(no_x), 3.0f);
  EXPECT_EQ(no_x.count("cameras[0].orthographic.xmag: expected a number that is not 0"), 1u);
  const Loaded no_y(with_camera(ortho(3, 0, 0, 10)));
  EXPECT_EQ(size(no_y), 3.0f);
  EXPECT_EQ(no_y.count("cameras[0].orthographic.ymag"), 1u);
  EXPECT_EQ(*no_y.scene.defaults.width, *no_y.scene.defaults.height);
  for (const Json& planes : {ortho(1, 1, 5, 5), ortho(1, 1, -1, 5), ortho(1, 1, 9, 5)}) {
    const Loaded loaded(with_camera(planes));
    EXPECT_EQ(loaded.count("expected 0 <= znear < zfar: nothing is cut off"), 1u);
    EXPECT_EQ(loaded.scene.camera.near_clip, 0.0f);
    EXPECT_EQ(loaded.scene.camera.far_clip, infinite_distance);
  }
  for (const double fov : {0.0, -1.0, 4.0}) {
    const Loaded loaded(
        with_camera({{"type", "perspective"}, {"perspective", {{"yfov", fov}, {"znear", 1}}}}));
    EXPECT_EQ(loaded.count("cameras[0].perspective.yfov"), 1u) << fov;
    EXPECT_EQ(loaded.scene.camera.fov_degrees, 40.0f);
    expect_near(loaded.scene.camera.look_from, {10, 0, 0});
  }
  EXPECT_EQ(Loaded(with_camera({{"type", "perspective"}})).count("perspective.yfov"), 1u);
  EXPECT_EQ(Loaded(with_camera({{"type", "orthographic"}})).count("orthographic.xmag"), 1u);
  GltfMaker missing = with_camera(ortho(1, 1, 0, 1));
  missing.root["nodes"][1]["camera"] = 3;
  const Loaded second(missing);  // the next camera is used
  EXPECT_EQ(second.count("nodes[1].camera: cameras[3] does not exist"), 1u);
  expect_near(second.scene.camera.look_from, {0, 0, 0});
  GltfMaker flat = with_camera(ortho(1, 1, 0, 1));
  flat.root["nodes"][1]["scale"] = {0, 0, 0};
  EXPECT_EQ(Loaded(flat).count("singular: the camera is left out"), 1u);
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
}

}  // namespace
}  // namespace pt
