// Materials made of materials, against analytic radiances.
#include <gtest/gtest.h>

#include <set>

#include "common/error/error.h"
#include "common/scene/prepare/prepare_steps.h"
#include "common/transport/resolve_material.h"
#include "material/bsdf_cases.h"
#include "render_serial.h"
#include "scene/nested_scenes.h"
#include "statistics.h"

namespace pt {
namespace {

const Color red(0.8f, 0.3f, 0.1f), blue(0.1f, 0.2f, 0.9f), green(0.2f, 0.7f, 0.4f);

/// A wall under a white sky, where a sample is the albedo of the material that it found.
Render render_wall(SceneData scene, std::uint32_t material, float z = 5.0f, int spp = 256) {
  scene.meshes.push_back(wall_mesh(material));
  scene.sky = {Color(1.0f), Color(1.0f)};
  look_at_wall(scene, z);
  prepare_scene(scene);
  return render(scene, image_options(16, 16, spp, 2));
}

Color mean_of(const Image& image) {
  glm::dvec3 sum(0.0);
  const std::size_t pixels = image.rgb.size() / 3;
  for (std::size_t i = 0; i < 3 * pixels; ++i) sum[static_cast<int>(i % 3)] += image.rgb[i];
  return Color(sum / static_cast<double>(pixels));
}

void expect_color(const Color& found, const Color& expected, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], tolerance) << "channel " << c;
}

TEST(NestedMaterials, EachSideHasItsOwn) {
  SceneData scene;
  const std::uint32_t front = add_diffuse(scene, red, true), back = add_diffuse(scene, blue, true);
  const std::uint32_t both = scene.add_material(make_two_sided(front, back));
  expect_color(mean_of(render_wall(scene, both).image), red, 1e-5f);
  expect_color(mean_of(render_wall(scene, both, -5.0f).image), blue, 1e-5f);
  expect_color(mean_of(render_wall(scene, front, -5.0f).image), Color(0.0f), 0.0f);
}

// 16 * 16 * 256 samples of two values: five standard deviations of their mean are 0.01 of their
// difference.
TEST(NestedMaterials, ABlendIsTheMean) {
  SceneData scene;
  const std::uint32_t a = add_diffuse(scene, red), b = add_diffuse(scene, blue);
  const auto blend = [&](float w) { return scene.add_material(make_blend({Color(w)}, a, b)); };
  for (const float weight : {0.0f, 0.3f, 0.75f, 1.0f}) {
    SCOPED_TRACE(weight);
    const float tolerance = weight == 0.0f || weight == 1.0f ? 1e-5f : 0.01f;
    expect_color(mean_of(render_wall(scene, blend(weight)).image),
                 (1.0f - weight) * red + weight * blue, tolerance);
  }
  const std::uint32_t c = add_diffuse(scene, green), inner = blend(0.4f);
  const std::uint32_t all = scene.add_material(make_blend({Color(0.5f)}, inner, c));
  expect_color(mean_of(render_wall(scene, all).image), 0.3f * red + 0.2f * blue + 0.5f * green,
               0.01f);
}

TEST(NestedMaterials, ABlendMayBeATexture) {
  SceneData scene;
  const std::uint32_t a = add_diffuse(scene, red), b = add_diffuse(scene, blue);
  const std::uint32_t stripes =
      add_picture(scene, 2, 1, {Color(0.0f), Color(1.0f)}, nearest_look());
  const std::uint32_t all = scene.add_material(make_blend({Color(1.0f), stripes}, a, b));
  scene.meshes.push_back(wall_mesh(all));
  scene.sky = {Color(1.0f), Color(1.0f)};
  scene.camera = {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40.0f, 0.0f, 5.0f};
  prepare_scene(scene);
  const Image image = render(scene, image_options(16, 16, 4, 2)).image;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const float* p = image.pixel(x, y);
      expect_color({p[0], p[1], p[2]}, x < 8 ? red : blue, 1e-5f);
    }
  }
}

// With u uniform: how often each child is chosen, and the moments of what is left of u.
TEST(NestedMaterials, TheRestOfTheRandomNumberIsUniformAgain) {
  SceneData data;
  const std::uint32_t a = add_diffuse(data, red), b = add_diffuse(data, blue);
  const std::uint32_t inner = data.add_material(make_blend({Color(0.25f)}, a, b));
  const std::uint32_t outer = data.add_material(make_blend({Color(0.6f)}, inner, b));
  data.meshes.push_back(wall_mesh(outer));
  prepare_scene(data);
  const Scene scene = host_view(data, 8, 8);
  MeanEstimate share, rest[2], square[2];
  for (int i = 0; i < 100'000; ++i) {
    Surface surface{};
    surface.shading_normal = {0, 0, 1};
    surface.material_index = outer;
    surface.material = scene.material(outer);
    float u = (static_cast<float>(i) + 0.5f) / 100'000.0f;
    resolve_material(scene, {0, 0, 1}, u, surface);
    ASSERT_TRUE(surface.material_index == a || surface.material_index == b);
    ASSERT_TRUE(u >= 0.0f && u < 1.0f);
    const int k = surface.material_index == a ? 0 : 1;
    share.add(k), rest[k].add(u), square[k].add(u * u);
  }
  EXPECT_NEAR(share.mean(), 0.6 + 0.4 * 0.25, 1e-4);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(rest[k].mean(), 0.5, 1e-3);
    EXPECT_NEAR(square[k].mean(), 1.0 / 3, 1e-3);
  }
}

TEST(NestedMaterials, APartIsAnEarlierMaterial) {
  SceneData scene;
  const std::uint32_t self = scene.add_material(make_two_sided(0, 0));
  scene.meshes.push_back(wall_mesh(self));
  look_at_wall(scene);
  try {
    prepare_scene(scene);
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("material 0 is made of material 0"),
              std::string::npos);
  }
}

/// The wall's radiance under a directional light of irradiance pi that goes along -`to_light`.
/// `mirrored`: v falls where it grew.
Color lit_wall(SceneData scene, std::uint32_t material, const Vec3& to_light,
               bool mirrored = false) {
  Mesh wall = wall_mesh(material);
  for (Vec2& uv : wall.uvs) uv.y = mirrored ? 1.0f - uv.y : uv.y;
  scene.meshes.push_back(wall);
  DeltaLight sun;
  sun.kind = LightKind::directional;
  sun.direction = -glm::normalize(to_light);
  sun.intensity = Color(pi);
  scene.delta_lights.push_back(sun);
  look_at_wall(scene);
  prepare_scene(scene);
  return mean_of(render(scene, image_options(8, 8, 4, 2)).image);
}

// A normal map of one colour turns a whole wall; then the radiance is the albedo times a cosine.
TEST(Maps, ANormalMapTurnsTheNormal) {
  const Vec3 to_light = glm::normalize(Vec3(0.4f, -0.3f, 0.8f));
  for (const Vec3& slope : {Vec3(0, 0, 1), Vec3(0.5f, 0.2f, 0.9f), Vec3(-0.6f, -0.5f, 1)}) {
    SceneData scene;
    const Vec3 normal = glm::normalize(slope);
    const std::uint32_t picture = add_picture(scene, 1, 1, {0.5f * normal + 0.5f});
    const std::uint32_t wall = add_diffuse(scene, red);
    const std::uint32_t plain =
        scene.add_material(make_mapped(MaterialNode::normal_map, {{1, 1, 0}, picture}, wall));
    const float cosine = glm::dot(normal, to_light);
    expect_color(lit_wall(scene, plain, to_light), cosine * red, 1e-5f);
    // Conty Estevez et al. 2019: G of GGX with alpha^2 = tan^2 / 8 of the angle between the
    // normals.
    const std::uint32_t shadowed =
        scene.add_material(make_mapped(MaterialNode::normal_map, {{1, 0, 0}, picture}, wall));
    const float alpha2 = (1 / (normal.z * normal.z) - 1) / 8;
    const float tangent2 = 1 / (to_light.z * to_light.z) - 1;
    const float shadow = 2 / (1 + std::sqrt(1 + alpha2 * tangent2));
    expect_color(lit_wall(scene, shadowed, to_light), shadow * cosine * red, 1e-5f);
  }
}

// glTF's normal maps have a scale of x and y, and their green goes where v grows.
TEST(Maps, GltfNormalMapsAreScaledAndHanded) {
  const Vec3 to_light = glm::normalize(Vec3(0.4f, -0.3f, 0.8f));
  for (const bool mirrored : {false, true}) {
    SceneData scene;
    const Vec3 slope(0.3f, 0.4f, 0.86f);
    const std::uint32_t picture = add_picture(scene, 1, 1, {0.5f * slope + 0.5f});
    const std::uint32_t map = scene.add_material(make_mapped(
        MaterialNode::gltf_normal_map, {{0.5f, 1, 0}, picture}, add_diffuse(scene, red)));
    const Vec3 normal = glm::normalize(Vec3(0.15f, mirrored ? -0.2f : 0.2f, slope.z));
    expect_color(lit_wall(scene, map, to_light, mirrored), glm::dot(normal, to_light) * red, 1e-5f);
  }
}

// Heights that grow evenly make a slope: the wall is 20 wide, so a height of h at u = 1 has the
// slope h / 20.
TEST(Maps, ABumpMapIsItsSlope) {
  SceneData scene;
  std::vector<Color> ramp;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      ramp.emplace_back(0.5f * static_cast<float>(x) / 8 + 0.25f * static_cast<float>(y) / 8);
    }
  }
  const std::uint32_t picture = add_picture(scene, 8, 8, ramp);
  const std::uint32_t map = scene.add_material(
      make_mapped(MaterialNode::bump_map, {{24, 1, 0}, picture}, add_diffuse(scene, red)));
  const Vec3 normal = glm::normalize(Vec3(-24 * 0.5f / 20, -24 * 0.25f / 20, 1));
  const Vec3 to_light = glm::normalize(Vec3(-0.4f, 0.3f, 0.8f));
  expect_color(lit_wall(scene, map, to_light), glm::dot(normal, to_light) * red, 1e-5f);
  // Heights stay heights where the picture is mirrored.
  expect_color(lit_wall(scene, map, to_light, true),
               glm::dot(Vec3(normal.x, -normal.y, normal.z), to_light) * red, 1e-5f);
}

// Seen from aside a map's normal may look away: it is turned about the surface's, or, where the map
// says so, the surface is black there.
TEST(Maps, NormalsThatLookAwayAreTurnedOrBlack) {
  const Vec3 to_light = glm::normalize(Vec3(0.3f, 0.2f, 0.9f));
  for (const bool stays : {false, true}) {
    SceneData scene;
    const std::uint32_t picture = add_picture(scene, 1, 1, {{0.1f, 0.5f, 0.8f}});  // -0.8, 0, 0.6
    scene.meshes.push_back(wall_mesh(scene.add_material(
        make_mapped(MaterialNode::normal_map, {{1, 1, stays ? 1.0f : 0.0f}, picture},
                    add_diffuse(scene, red)))));
    DeltaLight sun;
    sun.kind = LightKind::directional, sun.direction = -to_light, sun.intensity = Color(pi);
    scene.delta_lights.push_back(sun);
    scene.camera = {{9, 0, 4.4f}, {0, 0, 0}, {0, 1, 0}, 2.0f, 0.0f, 10.0f};
    prepare_scene(scene);
    const float cosine = stays ? 0.0f : glm::dot(Vec3(0.8f, 0, 0.6f), to_light);
    expect_color(mean_of(render(scene, image_options(8, 8, 4, 2)).image), cosine * red, 1e-5f);
  }
}

// From behind a map's y goes where it goes from the front: the normal there is that of the front,
// mirrored at the surface.
TEST(Maps, OfTwoSidesAreMirroredAtTheSurface) {
  const Vec3 normal = glm::normalize(Vec3(0.3f, 0.5f, 0.9f));
  const Vec3 to_light = glm::normalize(Vec3(0.4f, 0.2f, -0.8f));
  SceneData scene;
  const std::uint32_t picture = add_picture(scene, 1, 1, {0.5f * normal + 0.5f});
  const std::uint32_t map = scene.add_material(
      make_mapped(MaterialNode::normal_map, {{1, 1, 0}, picture}, add_diffuse(scene, red)));
  scene.meshes.push_back(wall_mesh(scene.add_material(make_two_sided(map, map))));
  DeltaLight sun;
  sun.kind = LightKind::directional, sun.direction = -to_light, sun.intensity = Color(pi);
  scene.delta_lights.push_back(sun);
  look_at_wall(scene, -5.0f);
  prepare_scene(scene);
  const float cosine = glm::dot(Vec3(normal.x, normal.y, -normal.z), to_light);
  expect_color(mean_of(render(scene, image_options(8, 8, 4, 2)).image), cosine * red, 1e-5f);
}

// A mirror turned so far that it sends light into the wall: nothing comes from there.
TEST(Maps, NoLightLeaksThroughTheSurface) {
  SceneData scene;
  const Vec3 normal = glm::normalize(Vec3(0.9f, 0, 0.4f));
  const std::uint32_t picture = add_picture(scene, 1, 1, {0.5f * normal + 0.5f});
  const std::uint32_t mirror = scene.add_material(make_metal(Color(1.0f), 0.0f));
  const std::uint32_t map =
      scene.add_material(make_mapped(MaterialNode::normal_map, {{1, 1, 0}, picture}, mirror));
  expect_color(mean_of(render_wall(scene, map).image), Color(0.0f), 0.0f);
}

// What needs no tangent need not be a mesh with coordinates.
TEST(Tangents, AreForAnisotropicMaterialsAlone) {
  const std::set<std::string> anisotropic{"ward, 0.1 0.4",
                                          "GGX copper 0.05, 0.6",
                                          "Beckmann copper 0.5, 0.1",
                                          "GGX glass 0.5, 0.2",
                                          "Beckmann glass of two tints 0.4, 0.7",
                                          "principled metal",
                                          "principled half glass",
                                          "thin principled, half of all"};
  std::set<std::string> found;
  for (const BsdfCase& c : all_bsdf_cases()) {
    if (uses_tangent(c.material)) found.insert(c.name);
  }
  EXPECT_EQ(found, anisotropic);
}

}  // namespace
}  // namespace pt
