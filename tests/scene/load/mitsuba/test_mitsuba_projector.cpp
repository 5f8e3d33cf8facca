// Mitsuba's projector: what it sends to points, against numbers of Mitsuba 3.9.1's own.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/light/light_tree.h"
#include "common/scene/prepare/list_lights.h"
#include "common/transport/sample_light.h"
#include "load/expect_near.h"
#include "load/mitsuba_scene.h"

namespace pt {
namespace {

const std::string picture = "P6\n4 2\n255\n" +
                            std::string("\xff\0\0\0\xff\0\0\0\xff\xff\xff\xff", 12) +
                            std::string("\x40\0\0\0\x40\0\0\0\x40\x80\x80\x80", 12);

SceneData projector_scene(const std::string& axis, int scale_x, const char* texture) {
  const TempFolder folder;
  write_text(folder.file("picture.ppm"), picture);
  write_text(folder.file("scene.xml"),
             fmt::format("<scene version='3.0.0'><emitter type='projector'>{}"
                         "<float name='fov' value='50'/><string name='fov_axis' value='{}'/>"
                         "<float name='scale' value='2'/><transform name='to_world'>"
                         "<scale x='{}'/><lookat origin='1,2,3' target='2,0,2.5' up='0,1,0.3'/>"
                         "</transform></emitter></scene>",
                         texture, axis, scale_x));
  const LoadedScene loaded = load_with_warnings(folder.file("scene.xml"));
  EXPECT_EQ(loaded.warnings.size(), 1u);  // no sensor
  return loaded.scene;
}

const char* const bitmap =
    "<texture type='bitmap' name='irradiance'><string name='filename' value='picture.ppm'/>"
    "<boolean name='raw' value='true'/></texture>";

const Vec3 points[5] = {
    {2.1f, 0.1f, 2.4f}, {2.2f, 0.3f, 2.9f}, {1.7f, 0, 2.3f}, {3, -1, 2.5f}, {1, 0.2f, 3.6f}};

// sample_direction() of the emitter, 2026-11.
struct Expected {
  const char* axis;
  int scale_x;
  Color at[5];
};
const Expected mitsubas[] = {
    {"x",
     1,
     {{0, 0.716615f, 0.235988f},
      {0.112073f, 0.112073f, 1.21875f},
      {0, 0.350652f, 0.0793707f},
      {0, 0.124191f, 0.330974f},
      {0, 0, 0}}},
    {"x",
     -1,
     {{0, 0.235988f, 0.716615f},
      {0.10197f, 1.10667f, 0},
      {0, 0.0793707f, 0.350652f},
      {0, 0.330974f, 0.124191f},
      {0, 0, 0}}},
    {"y",
     1,
     {{0, 0.537799f, 0.32112f},
      {0, 0.301645f, 1.14985f},
      {0, 0.344167f, 0.179111f},
      {0, 0.160604f, 0.255012f},
      {2.67137f, 2.42043f, 2.42043f}}},
    {"diagonal",
     -1,
     {{0, 0.212443f, 0.762276f},
      {0.168252f, 0.928979f, 0},
      {0, 0.0736527f, 0.426223f},
      {0, 0.323751f, 0.105648f},
      {0, 0, 0}}},
};

IncidentLight sent_to(const SceneData& scene, const Light& light, const Vec3& point) {
  Scene view{};
  view.textures = scene.textures.data(), view.texels = scene.texels.data();
  return sample_listed_light(view, light, point, 0.5f, 0.5f);
}

TEST(MitsubaProjector, SendsWhatMitsubasSends) {
  Bounds bounds;
  bounds.grow(Vec3(-1.0f)), bounds.grow(Vec3(1.0f));
  for (const Expected& e : mitsubas) {
    const SceneData scene = projector_scene(e.axis, e.scale_x, bitmap);
    const LightListData lights = list_lights(scene, bounds, LightSelection::power);
    ASSERT_EQ(lights.lights.size(), 1u);
    const Light& light = lights.lights[0];
    EXPECT_GT(light.weight, 0.0f);
    const std::optional<LightBounds> cone = bounds_of(light);
    ASSERT_TRUE(cone);
    for (int i = 0; i < 5; ++i) {
      SCOPED_TRACE(fmt::format("{} {} point {}", e.axis, e.scale_x, i));
      const IncidentLight sent = sent_to(scene, light, points[i]);
      expect_near(sent.radiance, e.at[i], 2e-5f);
      EXPECT_TRUE(sent.is_delta);
      if (is_black(sent.radiance)) continue;
      EXPECT_LE(std::acos(-dot(cone->axis, sent.wi)), cone->cone + cone->emission);
    }
  }
}

// pi * scale * irradiance over the square of the distance along the axis, without a picture.
TEST(MitsubaProjector, OneColourIsASquareOfLight) {
  Bounds bounds;
  bounds.grow(Vec3(-1.0f)), bounds.grow(Vec3(1.0f));
  const SceneData scene = projector_scene("x", 1, "<rgb name='irradiance' value='0.5, 1, 2'/>");
  const LightListData lights = list_lights(scene, bounds, LightSelection::power);
  const Vec3 on_axis = Vec3(1, 2, 3) + 3.0f * glm::normalize(Vec3(1, -2, -0.5f));
  expect_near(sent_to(scene, lights.lights.at(0), on_axis).radiance,
              2.0f * pi / 9.0f * Color(0.5f, 1, 2));
}

}  // namespace
}  // namespace pt
