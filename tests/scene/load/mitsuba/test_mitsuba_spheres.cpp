// Spheres that are seen to be turned: textured ones, and those whose normals point inward. Numbers
// called golden come from ray_intersect() of Mitsuba 3.9.1 (scalar_rgb).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/scene/prepare/prepare_scene.h"
#include "common/transport/first_hit.h"
#include "load/expect_near.h"
#include "load/mitsuba_modes.h"

namespace pt {
namespace {

const std::string flip = "<boolean name='flip_normals' value='true'/>";
const std::string textured =
    "<bsdf type='diffuse'><texture name='reflectance' type='checkerboard'/></bsdf>";
const std::string sky = "<emitter type='constant'><rgb name='radiance' value='0.25'/></emitter>";

/// A bump map, which asks for tangents; made of a checkerboard, it has no slopes.
const std::string bumpy =
    "<bsdf type='bumpmap'><texture type='checkerboard'/><bsdf type='diffuse'/></bsdf>";

std::string sphere(const std::string& steps, const std::string& inside) {
  return "<shape type='sphere'><transform name='to_world'>" + steps + "</transform>" + inside +
         "</shape>";
}

struct Seen {
  Vec2 uv;
  Vec3 dp_du, dp_dv, normal;
};

/// From above, as Mitsuba has it: its v goes down.
Seen seen_at(const std::string& xml, float x, float y) {
  SceneData scene = load_xml(xml + sky).scene;
  EXPECT_EQ(scene.spheres.size(), 1u);
  EXPECT_TRUE(scene.meshes.empty());
  prepare_scene(scene, Options());
  EXPECT_EQ(scene.traits.lighting, Lighting::full);
  const Scene view = host_view(scene, 4, 4);
  const Ray ray{{x, y, 5}, {0, 0, -1}};
  Hit hit;
  keep_nearer(hit, primitive_distance(view.primitives, 0, ray), 0);
  using Full = Traits<Accel::bvh2, Geometry::mixed, Lighting::full>;
  const Surface surface = surface_at<Full>(view, ray, hit);
  EXPECT_EQ(surface.point.normal, surface.shading_normal);
  // As the AOV has it, where the material is textured.
  const Vec2 uv = first_hit<Full>(view, ray, hit, Vec4(0.5f)).uv;
  return {uv, surface.dp_du, -surface.dp_dv, surface.shading_normal};
}

void expect_seen(const Seen& seen, const Seen& golden) {
  expect_near({seen.uv, 0.0f}, {golden.uv, 0.0f}, 2e-6f);
  expect_near(seen.dp_du, golden.dp_du, 3e-5f);
  expect_near(seen.dp_dv, golden.dp_dv, 3e-5f);
  expect_near(seen.normal, golden.normal, 1e-6f);
}

TEST(MitsubaSphere, CoordinatesAndDerivativesAreMitsubas) {
  expect_seen(seen_at(sphere("", bumpy), 0.5f, 0.1f), {{0.0314165f, 0.170318f},
                                                       {-0.628319f, 3.14159f, 0},
                                                       {2.65002f, 0.530004f, -1.6019f},
                                                       {0.5f, 0.1f, 0.860233f}});
  expect_seen(seen_at(sphere("", bumpy), -0.3f, -0.6f), {{0.676208f, 0.234058f},
                                                         {3.76991f, -1.88496f, 0},
                                                         {-1.04195f, -2.0839f, -2.10744f},
                                                         {-0.3f, -0.6f, 0.74162f}});
  const std::string turn = "<rotate x='1' angle='30'/>";
  expect_seen(seen_at(sphere(turn, bumpy + flip), 0.5f, 0.1f), {{0.127617f, 0.255412f},
                                                                {-3.24664f, 2.7207f, 1.5708f},
                                                                {1.51827f, 2.48827f, -1.17173f},
                                                                {-0.5f, -0.1f, -0.860233f}});
  const std::string mirror = "<scale x='-1'/>" + turn;
  expect_seen(seen_at(sphere(mirror, bumpy), 0.5f, 0.1f), {{0.372383f, 0.255412f},
                                                           {3.24664f, -2.7207f, -1.5708f},
                                                           {1.51827f, 2.48827f, -1.17173f},
                                                           {-0.5f, -0.1f, -0.860233f}});
  expect_seen(seen_at(sphere(mirror, bumpy + flip), -0.3f, -0.6f),
              {{0.926716f, 0.108695f},
               {-0.934972f, 1.63242f, 0.942478f},
               {-2.6519f, -0.613135f, -1.5688f},
               {-0.3f, -0.6f, 0.74162f}});
}

// Golden. It is the sphere mirrored in its centre, inside out.
TEST(MitsubaSphere, ANegativeRadiusTurnsAllAround) {
  const std::string negative = "<float name='radius' value='-1'/>";
  expect_seen(seen_at(sphere("", bumpy + negative), 0.5f, 0.1f), {{0.531417f, 0.829682f},
                                                                  {-0.628319f, 3.14159f, 0},
                                                                  {-2.65002f, -0.530004f, 1.6019f},
                                                                  {-0.5f, -0.1f, -0.860233f}});
  expect_seen(seen_at(sphere("<rotate x='1' angle='30'/>", bumpy + negative + flip), 0.5f, 0.1f),
              {{0.627617f, 0.744588f},
               {-3.24664f, 2.7207f, 1.5708f},
               {-1.51827f, -2.48827f, 1.17173f},
               {0.5f, 0.1f, 0.860233f}});
  expect_seen(seen_at(sphere("<scale x='-1'/>", bumpy + negative), 0.5f, 0.1f),
              {{0.968583f, 0.829682f},
               {0.628319f, -3.14159f, 0},
               {-2.65002f, -0.530004f, 1.6019f},
               {0.5f, 0.1f, 0.860233f}});
  // As triangles.
  for (const bool flipped : {false, true}) {
    const SceneData masked = load_xml(sphere("", "<bsdf type='mask'><bsdf type='diffuse'/></bsdf>" +
                                                     negative + (flipped ? flip : "")))
                                 .scene;
    const Mesh& mesh = masked.meshes.at(0);
    EXPECT_EQ(glm::dot(mesh.normals.at(700), mesh.positions.at(700)) > 0, flipped);
  }
}

// Else a scene for the paper's kernels, which know no frames.
TEST(MitsubaSphere, BubblesAreInsideOut) {
  const Seen bubble = seen_at(sphere("", "<bsdf type='dielectric'/>" + flip), 0.5f, 0.1f);
  expect_near(bubble.normal, {-0.5f, -0.1f, -0.860233f}, 1e-6f);
}

TEST(MitsubaSphere, DerivativesGrowWithTheRadius) {
  const Seen one = seen_at(sphere("", bumpy), 0.3f, 0.4f);
  const Seen three = seen_at(
      sphere("<scale value='2'/>", bumpy + "<float name='radius' value='1.5'/>"), 0.9f, 1.2f);
  expect_seen({three.uv, three.dp_du / 3.0f, three.dp_dv / 3.0f, three.normal}, one);
}

/// Spheres and meshes, and whether triangles are reported.
void expect_kind(const std::string& xml, std::size_t spheres, bool frames) {
  const LoadedScene loaded = load_xml("<sensor type='perspective'/>" + xml + sky);
  EXPECT_EQ(loaded.scene.spheres.size(), spheres) << xml;
  EXPECT_EQ(loaded.scene.meshes.size(), 1 - spheres) << xml;
  EXPECT_EQ(loaded.scene.sphere_frames.size(), frames ? spheres : 0) << xml;
  EXPECT_EQ(loaded.count("triangles are used"), spheres == 1 ? 0 : 1) << xml;
}

TEST(MitsubaSphere, OnlyThoseThatNeedItAreTriangles) {
  const std::string glow = "<emitter type='area'/>";
  const std::string picture =
      "<emitter type='area'><texture name='radiance' type='checkerboard'/></emitter>";
  expect_kind(sphere("", ""), 1, false);
  expect_kind(sphere("<rotate y='1' angle='50'/>", ""), 1, false);
  expect_kind(sphere("", flip), 1, true);
  expect_kind(sphere("<scale x='-1'/>", ""), 1, true);
  expect_kind(sphere("<scale x='-1'/>", flip), 1, false);
  expect_kind(sphere("", textured), 1, true);
  expect_kind(sphere("", textured + glow), 1, true);
  expect_kind(sphere("", glow + flip), 0, false);
  expect_kind(sphere("", picture), 0, false);
  expect_kind(sphere("<scale x='1.1'/>", textured), 0, false);
  expect_kind(sphere("", "<bsdf type='mask'>" + textured + "</bsdf>"), 0, false);
  expect_kind(sphere("",
                     "<bsdf type='diffuse'><texture name='reflectance' type='mesh_attribute'>"
                     "<string name='name' value='vertex_color'/></texture></bsdf>"),
              0, false);
}

TEST(MitsubaSphere, FramesStayWithTheirSpheres) {
  // Many spheres: half of them before the first that needs a frame, and every third of the others.
  std::string xml;
  for (int i = 0; i < 40; ++i) {
    const std::string place = fmt::format("<translate x='{}' y='{}'/>", (i * 17) % 40, i % 3);
    xml += sphere(place, i >= 20 && i % 3 == 0 ? flip : "");
  }
  SceneData scene = load_xml(xml + sky).scene;
  ASSERT_EQ(scene.sphere_frames.size(), 40u);
  prepare_scene(scene, Options());
  for (std::size_t k = 0; k < 40; ++k) {
    const std::uint32_t i = scene.primitive_numbers[k];
    EXPECT_EQ(scene.sphere_frames[k].side, i >= 20 && i % 3 == 0 ? -1.0f : 1.0f) << i;
  }
  bool moved = false;
  for (std::uint32_t k = 0; k < 40; ++k) moved = moved || scene.primitive_numbers[k] != k;
  EXPECT_TRUE(moved) << "the tree left all spheres where they were";
}

TEST(MitsubaSphere, ModesAreEqual) {
  const std::string bsdf = "<bsdf type='twosided'>" + textured + textured + "</bsdf>";
  std::string xml = "<sensor type='perspective'><float name='fov' value='50'/></sensor>" + sky;
  for (int i = 0; i < 9; ++i) {
    const std::string place = fmt::format(
        "<scale value='0.7'/><rotate x='1' y='{}' angle='{}'/><translate x='{}' y='{}' z='5'/>", i,
        40 * i, i % 3 - 1, i / 3 - 1);
    xml += sphere(place, (i % 2 == 0 ? bsdf : i == 3 ? bumpy : "") + (i % 4 == 0 ? flip : ""));
  }
  xml +=
      "<shape type='sphere'><float name='radius' value='0.4'/><point name='center' x='2' y='2' "
      "z='2'/><emitter type='area'><rgb name='radiance' value='9 8 7'/></emitter></shape>";
  expect_modes_are_equal(xml);
}

}  // namespace
}  // namespace pt
