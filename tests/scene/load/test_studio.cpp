// What is seen of files without lights or cameras.
#include <cmath>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/default_lighting.h"
#include "common/scene/load/load_scene.h"
#include "common/scene/prepare/prepare_scene.h"
#include "load/gltf_files.h"
#include "render_serial.h"

namespace pt {
namespace {

/// A ball of this albedo without light, framed, seen from `side`.
SceneData ball(float albedo, const Vec3& side) {
  SceneData scene;
  scene.add_sphere({0, 0, 0}, 1, scene.add_material(make_diffuse(Color(albedo))));
  scene.camera = frame_scene(scene);
  scene.camera.look_from = side;
  add_default_lighting(scene);
  return scene;
}

/// Mean radiance of the ball and of what surrounds it, of the 5 cm nearest to its edge.
struct Contrast {
  double inside = 0, outside = 0, darkest = 1e9, brightest = 0;

  explicit Contrast(SceneData scene) {
    const Options options = image_options(64, 64, 64, 6);
    prepare_scene(scene, options);
    const Image image = render(scene, options).image;
    const Camera camera = make_camera(scene.camera, 64, 64);
    int in = 0, out = 0;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const Ray ray = camera_ray(camera, x + 0.5f, y + 0.5f, 0, 0);
        const float along = -glm::dot(ray.origin, ray.direction);
        const float off = glm::length(ray.origin + along * ray.direction);
        const float* p = image.pixel(x, y);
        EXPECT_TRUE(p[0] == p[1] && p[1] == p[2]) << "grey";
        if (off < 0.95f) inside += p[0], ++in;
        if (off > 1.05f) {
          outside += p[0], ++out;
          darkest = std::min(darkest, double{p[0]}), brightest = std::max(brightest, double{p[0]});
        }
      }
    }
    inside /= in, outside /= out;
  }
};

TEST(Studio, WhiteAndBlackStandOutFromEverySide) {
  for (const Vec3& side : {Vec3(2, 1.4f, 3), Vec3(-5, 0, 0.1f), Vec3(0, -3, -4), Vec3(1, 4, 1)}) {
    const Contrast white(ball(0.8f, side)), black(ball(0.04f, side));
    EXPECT_GT(white.inside, 2.0 * white.outside);
    EXPECT_LT(black.inside, 0.5 * black.outside);
    EXPECT_GT(white.darkest, 0.08);
    EXPECT_LT(white.brightest, 0.25) << "no lamp in sight";
  }
}

// Towards the horizon a grey, above it the same and the key light, and straight below half of it.
TEST(Studio, TheGroundIsDarker) {
  SceneData scene = ball(0.5f, {0, 0, 3});  // seen along -z: the map's axes are the world's
  const EnvironmentData& map = scene.environment;
  const auto at = [&](double row, double column) {
    const auto y = std::min(static_cast<int>(row * map.height), map.height - 1);
    const auto x = std::min(static_cast<int>(column * map.width), map.width - 1);
    return map.pixels.at(static_cast<std::size_t>(y * map.width + x)).y;
  };
  // The key light is left of, above and beside the camera: to the right and behind are without it.
  const double right = 0.75;
  const float grey = at(0.5, right);
  EXPECT_NEAR(at(1, right) / grey, 0.5f, 0.01f);
  EXPECT_NEAR(at(0.75, right) / grey, 1 - 0.5 * std::sqrt(0.5), 0.01);  // 45 degrees down
  EXPECT_GE(at(0, right), grey);
  EXPECT_GT(at(0.25, 0.1), 4 * grey);
}

TEST(Studio, LightsFilesThatBringNoLight) {
  const TempFolder folder;
  write_text(folder.file("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write_text(folder.file("a.gltf"), triangle_file().gltf());
  write_text(folder.file("a.xml"), "<scene version=\"3.0.0\"><shape type=\"cube\"/></scene>");
  for (const char* name : {"a.obj", "a.gltf", "a.xml"}) {
    std::string said;
    LoadOptions options;
    options.warn = [&](const std::string& message) { said += message + '\n'; };
    const SceneData scene = load_scene_file(folder.file(name), options);
    EXPECT_TRUE(is_black(scene.sky.zenith) && is_black(scene.sky.nadir)) << name;
    EXPECT_GT(scene.environment.width, 0) << name;
    EXPECT_TRUE(scene.defaults.measure_exposure) << name;
    EXPECT_NE(said.find("default lighting"), std::string::npos) << said;
    EXPECT_NE(said.find("frames the scene is used"), std::string::npos) << said;
  }
}

TEST(Studio, SurvivesACameraWithoutDirection) {
  SceneData scene;
  scene.camera.look_at = scene.camera.look_from;
  add_default_lighting(scene);
  EXPECT_EQ(scene.environment.to_world.determinant(), 1.0f);
}

}  // namespace
}  // namespace pt
