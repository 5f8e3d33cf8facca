// The picture of Mitsuba's spot: what it sends to points, against numbers of Mitsuba 3.9.1's own.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/scene/prepare/list_lights.h"
#include "common/transport/sample_light.h"
#include "load/expect_near.h"
#include "load/mitsuba_scene.h"

namespace pt {
namespace {

const std::string picture = "P6\n4 2\n255\n" +
                            std::string("\xff\0\0\0\xff\0\0\0\xff\xff\xff\xff", 12) +
                            std::string("\x40\0\0\0\x40\0\0\0\x40\x80\x80\x80", 12);

SceneData spot_scene(int scale_x, const std::string& texture) {
  const TempFolder folder;
  write_text(folder.file("picture.ppm"), picture);
  write_text(folder.file("scene.xml"),
             fmt::format("<scene version='3.0.0'><emitter type='spot'>{}"
                         "<float name='cutoff_angle' value='40'/>"
                         "<float name='beam_width' value='35'/>"
                         "<rgb name='intensity' value='2, 3, 4'/><transform name='to_world'>"
                         "<scale x='{}'/><lookat origin='1,2,3' target='2,0,2.5' up='0,1,0.3'/>"
                         "</transform></emitter></scene>",
                         texture, scale_x));
  const LoadedScene loaded = load_with_warnings(folder.file("scene.xml"));
  EXPECT_EQ(loaded.warnings.size(), 1u);  // no sensor
  return loaded.scene;
}

const char* const bitmap =
    "<texture type='bitmap' name='texture'><string name='filename' value='picture.ppm'/>"
    "<boolean name='raw' value='true'/></texture>";

const Vec3 points[] = {{2.1f, 0.1f, 2.4f}, {2.2f, 0.3f, 2.9f}, {1.7f, 0, 2.3f},   {3, -1, 2.5f},
                       {1, 0.2f, 3.6f},    {1.9f, 0.4f, 2.2f}, {1.3f, 0.3f, 2.9f}};

// sample_direction() of the emitter, 2026-11; mirrored: scaled by -1 along its x.
const Color plain[7] = {{0, 0.121474f, 0.288178f},
                        {0, 0.261115f, 0.0739802f},
                        {0, 0.146912f, 0.40737f},
                        {0, 0.0711344f, 0.0566086f},
                        {0, 0, 0},
                        {0, 0.0119117f, 0.605218f},
                        {0.0158545f, 0.836075f, 0}};
const Color mirrored[7] = {{0, 0.216134f, 0.161965f},
                           {0, 0.0554851f, 0.348153f},
                           {0, 0.305528f, 0.195882f},
                           {0, 0.0424564f, 0.0948459f},
                           {0, 0, 0},
                           {0, 0.453914f, 0.0158822f},
                           {0.016741f, 0.0251115f, 1.14825f}};

Color sent_to(const SceneData& scene, const Vec3& point) {
  Bounds bounds;
  bounds.grow(Vec3(-1.0f)), bounds.grow(Vec3(1.0f));
  const LightListData lights = list_lights(scene, bounds, LightSelection::power);
  Scene view{};
  view.textures = scene.textures.data(), view.texels = scene.texels.data();
  return sample_listed_light(view, lights.lights.at(0), point, 0.5f, 0.5f).radiance;
}

void expect_sent(const SceneData& scene, const Color (&expected)[7]) {
  for (int i = 0; i < 7; ++i) {
    SCOPED_TRACE(fmt::format("point {}", i));
    expect_near(sent_to(scene, points[i]), expected[i], 3e-5f);
  }
}

TEST(MitsubaSpot, SendsItsPictureAsMitsubasDoes) {
  expect_sent(spot_scene(1, bitmap), plain);
  expect_sent(spot_scene(-1, bitmap), mirrored);
}

TEST(MitsubaSpot, WithoutAPictureIsOneColour) {
  expect_near(sent_to(spot_scene(1, ""), points[0]), {0.386100f, 0.579151f, 0.772201f}, 3e-5f);
  const std::string half = "<rgb name='texture' value='0.5, 0.5, 0.5'/>";
  expect_near(sent_to(spot_scene(1, half), points[0]), {0.193050f, 0.289575f, 0.386100f}, 3e-5f);
}

}  // namespace
}  // namespace pt
