// What camera rays find, on a scene made by hand: of every layer the value is known at the place
// that the layer `position` names, which lies on the object that the layers name.
#include "film_cases.h"
#include "render_serial.h"
#include "scene/nested_scenes.h"

namespace pt {
namespace {

constexpr int width = 96, height = 24;
constexpr float eye_z = 14.0f;
const Vec3 leaf_normal(0.6f, 0, 0.8f);
const Vec3 dome_corners[3] = {{-2.5f, -2, 0}, {0.5f, -2, 0}, {-1, 2, 0}};
const Vec3 dome_normals[3] = {{-0.6f, 0, 0.8f}, {0.6f, 0, 0.8f}, {0, 0.6f, 0.8f}};
const Vec2 dome_uvs[3] = {{0, 0.25f}, {2, 0.25f}, {0, 1}};
const Color glass_tint(0.9f, 0.8f, 0.7f), sheet_glow(2, 1, 0.5f), behind(0.25f);

Mesh triangle_mesh(const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t material) {
  Mesh mesh;
  mesh.positions = {a, b, c};
  mesh.triangles = {{{0, 1, 2}}};
  mesh.material = material;
  return mesh;
}

/// From left to right: a dull sphere, one of glass, a sheet of which a half is there, a triangle
/// with normals and texture coordinates, a square, a triangle placed twice.
SceneData row_of_things() {
  SceneData scene;
  scene.name = "row of things";
  const std::uint32_t dull = add_diffuse(scene, {0.7f, 0.1f, 0.3f});
  const std::uint32_t glass = scene.add_material(make_dielectric(glass_tint, 1.5f));
  MaterialDescription veil = make_diffuse(Color(0.0f), sheet_glow);
  veil.opacity = constant_opacity(0.5f);
  const std::uint32_t sheet = scene.add_material(veil);
  scene.add_sphere({-8.5f, 0, 0}, 0.9f, dull);
  scene.add_sphere({-6.25f, 0, 0}, 0.9f, glass);
  scene.meshes = {
      {{{-5, -2, 1}, {-3, -2, 1}, {-3, 2, 1}, {-5, 2, 1}},
       {{{0, 1, 2}}, {{0, 2, 3}}},
       {},
       {},
       sheet},
      triangle_mesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, add_diffuse(scene, {0.1f, 0.8f, 0.2f})),
      triangle_mesh(dome_corners[0], dome_corners[1], dome_corners[2],
                    add_diffuse(scene, {0.2f, 0.4f, 0.6f})),
      {{{1, -1, 0}, {3, -1, 0}, {3, 1, 0}, {1, 1, 0}}, {{{0, 1, 2}}, {{0, 2, 3}}}, {}, {}, dull}};
  scene.meshes[1].group = 1;
  scene.meshes[1].normals.assign(3, leaf_normal);
  scene.meshes[2].normals.assign(dome_normals, dome_normals + 3);
  scene.meshes[2].uvs.assign(dome_uvs, dome_uvs + 3);
  scene.instances = {{1, translate({3.5f, -1, 0}) * scale({2, 2, 1})},
                     {1, translate({8, -1, 0}) * rotate({0, 0, 1}, 90)}};
  scene.sky = {behind, behind};
  scene.camera = {{0, 0, eye_z}, {0, 0, 0}, {0, 1, 0}, 20.0f, 0.0f, eye_z};
  return scene;
}

/// The layers of one pixel.
struct Found {
  Color radiance, albedo;
  Vec3 shading_normal, normal, position;
  float depth;
  Vec2 uv;
  std::uint32_t primitive, instance, material;
};

Found found_at(const Image& image, std::size_t i) {
  const auto vec = [&](const std::vector<float>& v) {
    return Vec3(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
  };
  const auto& layers = image.layers;
  return {vec(image.rgb),
          vec(layers[0].values),
          vec(layers[1].values),
          vec(layers[2].values),
          vec(layers[4].values),
          layers[3].values[i],
          {layers[5].values[2 * i], layers[5].values[2 * i + 1]},
          layers[6].numbers[i],
          layers[7].numbers[i],
          layers[8].numbers[i]};
}

void expect_close(const Vec3& found, const Vec3& expected, const char* what, float within = 2e-5f) {
  EXPECT_LT(glm::length(found - expected), within)
      << what << ": " << found.x << ' ' << found.y << ' ' << found.z << " instead of " << expected.x
      << ' ' << expected.y << ' ' << expected.z;
}

struct Expected {
  std::uint32_t primitive, instance, material;
  Color albedo;
  Vec3 normal, shading_normal;
  Vec2 uv;
};

void expect_found(const Found& found, const Expected& expected) {
  EXPECT_EQ(found.primitive, expected.primitive);
  EXPECT_EQ(found.instance, expected.instance);
  EXPECT_EQ(found.material, expected.material);
  expect_close(found.albedo, expected.albedo, "albedo");
  expect_close(found.normal, expected.normal, "normal");
  expect_close(found.shading_normal, expected.shading_normal, "shading normal");
  EXPECT_NEAR(found.uv.x, expected.uv.x, 2e-5);
  EXPECT_NEAR(found.uv.y, expected.uv.y, 2e-5);
}

/// Barycentric weights of the point p of a triangle in the plane of x and y.
Vec3 weights_at(const Vec3& p, const Vec3 (&v)[3]) {
  const auto area = [](const Vec3& a, const Vec3& b) { return a.x * b.y - a.y * b.x; };
  const float whole = area(v[1] - v[0], v[2] - v[0]);
  const float b1 = area(p - v[0], v[2] - v[0]) / whole, b2 = area(v[1] - v[0], p - v[0]) / whole;
  return {1 - b1 - b2, b1, b2};
}

void expect_inside(const Vec3& weights) {
  for (int i = 0; i < 3; ++i) EXPECT_GE(weights[i], -1e-4f);
}

/// What there is at the found place, which is checked to lie on the object there.
Expected expected_at(const Found& found) {
  const Vec3& p = found.position;
  const Vec3 front(0, 0, 1);
  if (p.x < -5.2f) {
    const bool is_glass = p.x > -7.4f;
    const Vec3 out = p - Vec3(is_glass ? -6.25f : -8.5f, 0, 0);
    EXPECT_NEAR(glm::length(out), 0.9f, 1e-5);
    EXPECT_GT(glm::dot(out, Vec3(0, 0, eye_z) - p), 0.0f);
    const Vec3 normal = glm::normalize(out);
    const auto number = static_cast<std::uint32_t>(is_glass);
    return {number, 0, number, is_glass ? glass_tint : Color(0.7f, 0.1f, 0.3f), normal, normal, {}};
  }
  if (p.x < -2.9f) {  // corners at the lower left and the upper right belong to both triangles
    EXPECT_NEAR(p.z, 1.0f, 1e-5);
    const Vec2 at(0.5f * (p.x + 5), 0.25f * (p.y + 2));
    const bool first = at.x > at.y;
    const Vec2 uv = first ? Vec2(at.x - at.y, at.y) : Vec2(at.x, at.y - at.x);
    return {first ? 2u : 3u, 2, 2, Color(0.0f), front, front, uv};
  }
  EXPECT_NEAR(p.z, 0.0f, 1e-5);
  if (p.x < 0.7f) {
    const Vec3 b = weights_at(p, dome_corners);
    expect_inside(b);
    const Vec3 n = b.x * dome_normals[0] + b.y * dome_normals[1] + b.z * dome_normals[2];
    const Vec2 uv = b.x * dome_uvs[0] + b.y * dome_uvs[1] + b.z * dome_uvs[2];
    return {5, 2, 4, {0.2f, 0.4f, 0.6f}, front, glm::normalize(n), {uv.x, 1 - uv.y}};
  }
  if (p.x < 3.2f) {
    const Vec2 at(0.5f * (p.x - 1), 0.5f * (p.y + 1));
    const bool first = at.x > at.y;
    const Vec2 uv = first ? Vec2(at.x - at.y, at.y) : Vec2(at.x, at.y - at.x);
    return {first ? 6u : 7u, 2, 0, {0.7f, 0.1f, 0.3f}, front, front, uv};
  }
  const bool turned = p.x > 6.0f;
  const Vec3 stretched[3] = {{3.5f, -1, 0}, {5.5f, -1, 0}, {3.5f, 1, 0}};
  const Vec3 rotated[3] = {{8, -1, 0}, {8, 0, 0}, {7, -1, 0}};
  const Vec3 b = weights_at(p, turned ? rotated : stretched);
  expect_inside(b);
  const Vec3 n = turned ? Vec3(0, 0.6f, 0.8f) : glm::normalize(Vec3(0.3f, 0, 0.8f));
  return {4, turned ? 1u : 0u, 3, {0.1f, 0.8f, 0.2f}, front, n, {b.y, b.z}};
}

/// The pixel of 20 degrees of view shows the place.
void expect_seen(const Found& found, int x, int y) {
  const Vec3& p = found.position;
  const float scale = 0.5f * height / (std::tan(pi / 18) * (eye_z - p.z));
  EXPECT_NEAR(0.5f * width + scale * p.x, static_cast<float>(x) + 0.5f, 0.501f);
  EXPECT_NEAR(0.5f * height - scale * p.y, static_cast<float>(y) + 0.5f, 0.501f);
  EXPECT_NEAR(found.depth, glm::length(p - Vec3(0, 0, eye_z)), 2e-5);
}

Image picture_of(SceneData scene, const std::string& accel) {
  const Options options = with(image_options(width, height, 1, 1),
                               {{"filter", "box"},
                                {"accel", accel},
                                {"output", "a.exr"},
                                {"aov",
                                 "albedo,shading_normal,normal,depth,position,uv,primitive,"
                                 "instance,material"}});
  prepare_scene(scene, options);
  return render(scene, options).image;
}

TEST(FirstHit, EveryLayerOfSceneMadeByHand) {
  for (const std::string& accel : structures(AccelKind::brute)) {
    const Image image = picture_of(row_of_things(), accel);
    std::map<std::uint32_t, int> seen;
    int holes = 0;
    for (std::size_t i = 0; i < width * height; ++i) {
      const Found found = found_at(image, i);
      const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
      SCOPED_TRACE(testing::Message() << accel << ", pixel " << x << ' ' << y << " shows "
                                      << found.position.x << ' ' << found.position.y);
      // A path of one ray: what that ray has met is in the image, and so is what it has passed.
      const bool through = found.primitive == no_primitive;
      if (found.material == 2 || through) {
        expect_close(found.radiance, through ? behind : sheet_glow, "radiance");
      }
      if (through) {
        EXPECT_EQ(found.depth, 0.0f);
        EXPECT_EQ(found.material, no_primitive);
        EXPECT_EQ(found.instance, no_primitive);
        holes += x > 25 && x < 32 && y > 4 && y < 19;
        continue;
      }
      ++seen[found.material * 16 + found.instance];
      expect_seen(found, x, y);
      expect_found(found, expected_at(found));
      if (HasFailure()) return;
    }
    EXPECT_EQ(seen.size(), 7u);  // two spheres, the sheet, the dome, the square, the leaf twice
    for (const auto& [key, count] : seen) EXPECT_GT(count, 10) << key;
    EXPECT_GT(holes, 20);
  }
}

// All that falls on white glass leaves it, whatever the side from which it is seen.
TEST(FirstHit, AlbedoOfGlassFromWithin) {
  for (const float roughness : {0.0f, 0.2f}) {
    SceneData scene;
    MaterialDescription glass = make_dielectric(glass_tint, 1.5f);
    if (roughness > 0) {
      glass =
          make_material<RoughDielectric>(glass_tint, glass_tint, 1.5f, roughness, roughness, 0.0f);
    }
    scene.add_sphere({0, 0, eye_z}, 20, scene.add_material(glass));
    scene.meshes.push_back(triangle_mesh({90, 0, 0}, {91, 0, 0}, {90, 1, 0}, 0));
    scene.sky = {behind, behind};
    scene.camera = row_of_things().camera;
    const Image image = picture_of(scene, "bvh2");
    double sum = 0;
    for (std::size_t i = 0; i < width * height; ++i) {
      const Color albedo = found_at(image, i).albedo;
      if (roughness == 0) expect_close(albedo, glass_tint, "albedo");
      if (HasFailure()) return;
      sum += albedo.x / glass_tint.x / (width * height);
    }
    EXPECT_NEAR(sum, 0.97, 0.05) << roughness;  // facets shadow some of it
  }
}

}  // namespace
}  // namespace pt
