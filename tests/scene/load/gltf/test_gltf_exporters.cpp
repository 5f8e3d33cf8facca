// The glTF loader: twelve small files in the conventions of twelve exporters
// (tests/data/exporters), four squares of 2 x 2 units each, seen from z = 10 with x to the right
// and y up. Where they are and what they show was worked out by hand from the specification; a
// square with a picture has four texels: red, green, and below them blue and white.
#include <fmt/format.h>

#include <cmath>

#include "load/expect_near.h"
#include "load/gltf_files.h"
#include "load/render_loaded.h"
#include "test_data.h"

namespace pt {
namespace {

constexpr int side = 16;  // pixels of a picture that is 4 units wide

SceneData load(const std::string& file, std::size_t& warnings) {
  LoadOptions options;
  warnings = 0;
  options.warn = [&](const std::string&) { ++warnings; };
  return load_gltf(test_data("exporters/" + file), options);
}

const Color red(1, 0, 0), green(0, 1, 0), blue(0, 0, 1), white(1, 1, 1), black(0, 0, 0);

struct Point {
  float x, y;
  Color color;
  float tolerance = 1e-4f;
};

/// The texels of a square about (x, y), as they are seen.
std::vector<Point> four(float x, float y, const Color& upper_left, const Color& upper_right,
                        const Color& lower_left, const Color& lower_right) {
  return {{x - 0.5f, y + 0.5f, upper_left},
          {x + 0.5f, y + 0.5f, upper_right},
          {x - 0.5f, y - 0.5f, lower_left},
          {x + 0.5f, y - 0.5f, lower_right}};
}

void append(std::vector<Point>& points, const std::vector<Point>& more) {
  points.insert(points.end(), more.begin(), more.end());
}

void expect_points(const std::string& file, std::size_t warnings,
                   const std::vector<Point>& points) {
  SCOPED_TRACE(file);
  std::size_t warned = 0;
  SceneData scene = load(file, warned);
  EXPECT_EQ(warned, warnings);
  EXPECT_TRUE(is_black(scene.sky.zenith));
  EXPECT_EQ(scene.environment.width, 0) << "the studio's light";
  Options options = image_options(side, side, 1024, 8);
  options.filter = FilterChoice();
  prepare_scene(scene, options);
  const Image image = render(scene, options).image;
  for (const Point& p : points) {
    const auto column = static_cast<int>(std::floor((p.x + 2) / 4 * side));
    const auto row = static_cast<int>(std::floor((2 - p.y) / 4 * side));
    Color seen;
    for (int c = 0; c < 3; ++c) {
      seen[c] = image.rgb[static_cast<std::size_t>(3 * (row * side + column) + c)];
    }
    SCOPED_TRACE(fmt::format("({}, {})", p.x, p.y));
    expect_near(seen, p.color, p.tolerance);
  }
}

TEST(GltfExporters, Blender) {
  expect_points("blender.gltf", 1,
                {{-1, 1, {4, 2, 1}},
                 {1, 1, 0.96f * Color(0.8f, 0.4f, 0.2f), 0.04f},
                 {-1, -1, Color(0.75f), 0.05f},
                 {1, -1, {0.5f, 0.25f, 1}}});
  std::size_t warnings;
  const SceneData scene = load("blender.gltf", warnings);
  const DeltaLight& sun = scene.delta_lights.at(0);
  EXPECT_EQ(sun.kind, LightKind::directional);
  expect_near(sun.direction, {0, -1, 0});  // -z of its node, turned by -90 degrees about x
  expect_near(sun.intensity, Color(0.001f));
  EXPECT_EQ(scene.names.delta_lights.at(0), "Sun");
  expect_near(scene.camera.look_from, {0, 0, 10});
  EXPECT_NEAR(scene.camera.fov_degrees, 2 * std::atan(0.2) * 180 / 3.14159265, 1e-3);
  EXPECT_EQ(*scene.defaults.width, *scene.defaults.height);
}

TEST(GltfExporters, ThreeJs) {
  std::vector<Point> points = {{-1, 1, {1, 0.5f, 0}},  // double sided, from behind
                               {1, 1, Color(0.48f), 0.06f},
                               {-1.5f, -1, red},
                               {-0.5f, -1, white}};  // cut out: the panel
  append(points, four(1, -1, green, red, white, blue));
  expect_points("threejs.gltf", 2, points);
  std::size_t warnings;
  const DeltaLight spot = load("threejs.gltf", warnings).delta_lights.at(0);
  EXPECT_EQ(spot.cos_inner, spot.cos_outer);
  EXPECT_NEAR(spot.cos_outer, std::cos(0.5), 1e-6);
}

TEST(GltfExporters, MayaByBabylon) {
  std::vector<Point> points = four(-1, 1, green, red, white, blue);  // TEXCOORD_1: u mirrored
  const float half = 128.0f / 255;
  points.push_back({1, 1, half * Color(0, 1, 1) + Color(1 - half), 0.06f});
  append(points, four(-1, -1, green, white, red, blue));  // turned by 90 degrees
  append(points, four(1, -1, green, red, white, blue));
  expect_points("maya-babylon.glb", 1, points);
}

TEST(GltfExporters, Max3dsByBabylon) {
  expect_points("3dsmax-babylon.gltf", 0,
                {{-1, 1, red}, {1, 1, green}, {-1, -1, blue}, {1, -1, {1, 1, 0}}});
}

TEST(GltfExporters, Sketchfab) {
  const float alpha = 64.0f / 255;
  expect_points("sketchfab.gltf", 2,
                {{-1, 1, {0.2f, 0.4f, 0.8f}},
                 {1, 1, alpha * Color(0, 0.5f, 1) + Color(1 - alpha), 0.06f},
                 {-1, -1, {1, 0, 1}},
                 {1, -1, white}});
}

TEST(GltfExporters, Fbx2Gltf) {
  expect_points("fbx2gltf.glb", 0,
                {{-1, 1, {1, 0, 0.5f}},
                 {1.8f, 1.8f, {0, 1, 0.5f}},
                 {-1, -1, {0, 1, 0.5f}},  // half as large
                 {-1.8f, -1, black},
                 {1, -1, {0.25f, 0.25f, 1}}});
}

TEST(GltfExporters, Assimp) {
  // Without a sampler pictures repeat and are interpolated: red, blue and between.
  expect_points("assimp.gltf", 2,
                {{-1, 1.55f, {1, 0, 0}, 0.4f},
                 {-1, 0.45f, {0, 0, 1}, 0.4f},
                 {1, 1, {1, 1, 0}},
                 {-1, -1, black},  // a scale of -1: its front is behind
                 {1, -1, {1, 0.5f, 0.5f}}});
}

TEST(GltfExporters, Substance) {
  std::vector<Point> points;
  for (const Point& at :
       {Point{-1, 1, white}, Point{1, 1, Color(0.5f)}, Point{-1, -1, white}, Point{1, -1, white}}) {
    append(points, four(at.x, at.y, at.color * red, at.color * green, at.color * blue, at.color));
  }
  expect_points("substance.gltf", 4, points);
}

TEST(GltfExporters, UnityGltf) {
  std::vector<Point> points = four(-1, 1, blue, white, red, green);  // v flipped
  append(points, four(1, 1, blue, blue, blue, blue));                // the lower left quadrant
  append(points, four(-1, -1, blue, red, white, green));             // u' = v, v' = 1 - u
  points.push_back({1, -1, Color(0.96f), 0.04f});  // transmission by the red quadrant
  expect_points("unitygltf.gltf", 1, points);
}

TEST(GltfExporters, Godot) {
  expect_points("godot.gltf", 1,
                {{-1, 1, red},          // below a scale of -1
                 {1, 1, {0, 2, 0}},     // double sided, from behind
                 {-1, -1, black},       // culled, from behind
                 {1, -1, {1, 0, 1}}});  // turned and mirrored: its front
  std::size_t warnings;
  const SceneData scene = load("godot.gltf", warnings);
  ASSERT_EQ(scene.delta_lights.size(), 2u);
  EXPECT_EQ(scene.delta_lights[0].kind, LightKind::point);
  expect_near(scene.delta_lights[0].position, {0, 0, 8});
  expect_near(scene.delta_lights[1].direction, {-1, 0, 0});  // turned by 90 degrees about y
}

TEST(GltfExporters, Cinema4d) {
  // Through 0.2 of glass: t is what the colour leaves, r what each face reflects.
  const auto through = [](double t) {
    const double r = 0.04;
    return static_cast<float>((1 - r) * (1 - r) * t / (1 - r * r * t * t));
  };
  expect_points("cinema4d.gltf", 4,
                {{-1, 1, {1, 0.5f, 0}},
                 {1, 1, Color(0.96f), 0.04f},
                 {-1, -1, {through(1), through(0.5), through(0.25)}, 0.06f},
                 {1, -1, {0.25f, 0.5f, 0.75f}}});
  std::size_t warnings;
  const CameraParameters camera = load("cinema4d.gltf", warnings).camera;
  EXPECT_TRUE(camera.orthographic);
  EXPECT_EQ(camera.orthographic_size, Vec2(2, 2));
}

TEST(GltfExporters, Houdini) {
  // Colours of vertices: red below, blue above.
  std::vector<Point> points = {{-1, 1.5f, {0.22f, 0, 0.78f}, 0.1f},
                               {-1, 0.5f, {0.72f, 0, 0.28f}, 0.1f}};
  append(points, four(1, 1, red, green, blue, white));
  append(points, four(-1, -1, white, blue, green, red));  // turned by 180 degrees
  points.push_back({1, -1, {0.5f, 1, 0.5f}});
  expect_points("houdini.gltf", 1, points);
}

}  // namespace
}  // namespace pt
