// Defaults, factors and flags of surfaces and textures, each of which a loader could get wrong
// without any picture of the suite being far off.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

#include "common/light/sky/sunsky.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/texture/sample_texture.h"
#include "common/transport/mask.h"
#include "load/expect_near.h"
#include "load/mitsuba_scene.h"
#include "render_serial.h"

namespace pt {
namespace {

std::string bsdf(const std::string& type, const std::string& inside = "") {
  return fmt::format("<bsdf type='{}'>{}</bsdf>", type, inside);
}

/// A picture of 2 x 1 texels, raw: 0.2 and 0.8 of 255.
std::string picture_of(const std::string& name, const std::string& inside = "") {
  return fmt::format(
      "<texture type='bitmap' name='{}'><string name='filename' value='a.ppm'/>"
      "<boolean name='raw' value='true'/>{}</texture>",
      name, inside);
}

LoadedScene load(const std::string& inside, const std::string& version = "3.0.0") {
  const TempFolder folder;
  write_text(folder.file("a.ppm"), "P6\n2 1\n255\n" + std::string("\x33\x33\x33\xcc\xcc\xcc", 6));
  write_text(
      folder.file("scene.xml"),
      fmt::format("<scene version='{}'><sensor type='perspective'/>{}</scene>", version, inside));
  return load_with_warnings(folder.file("scene.xml"));
}

std::string square(const std::string& material) {
  return "<shape type='rectangle'>" + material + "</shape><emitter type='constant'/>";
}

/// A scene with a shape of this material, which loads without warnings.
SceneData scene_of(const std::string& material, const std::string& version = "3.0.0") {
  const LoadedScene loaded = load(square(material), version);
  EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
  return loaded.scene;
}

const MaterialDescription& top_of(const SceneData& scene) {
  return scene.materials.at(scene.meshes.empty() ? scene.quad_material.at(0)
                                                 : scene.meshes.at(0).material);
}

Texture texture_of(const std::string& texture, const std::string& version = "3.0.0") {
  return scene_of(bsdf("diffuse", texture), version).textures.at(0);
}

float opacity_at_texel(const SceneData& scene, float u) {
  Scene view;
  view.textures = scene.textures.data(), view.texels = scene.texels.data();
  return opacity_at(view, top_of(scene).opacity, {u, 0.5f});
}

TEST(MitsubaTexture, ScalesAndOffsetsOfOldFilesHaveTwoAxes) {
  const Texture t =
      texture_of(picture_of("reflectance", number("uscale", 2) + number("vscale", 3) +
                                               number("uoffset", 0.1) + number("voffset", 0.2)),
                 "0.6.0");
  // In the file's coordinates, whose v goes down: (2 u + 0.1, 3 v + 0.2).
  const Vec2 mapped = map_coordinates(t, {0.3f, 1.0f - 0.4f});
  EXPECT_NEAR(mapped.x, 2 * 0.3 + 0.1, 1e-6);
  EXPECT_NEAR(1 - mapped.y, 3 * 0.4 + 0.2, 1e-6);
}

TEST(MitsubaTexture, AxesWrapByThemselves) {
  const auto wraps = [](const char* u, const char* v) {
    const auto mode = [](const char* axis, const char* value) {
      return fmt::format("<string name='wrapMode{}' value='{}'/>", axis, value);
    };
    const Texture t = texture_of(picture_of("reflectance", mode("U", u) + mode("V", v)), "0.6.0");
    return std::pair(t.wrap_u, t.wrap_v);
  };
  EXPECT_EQ(wraps("clamp", "mirror"), std::pair(TextureWrap::clamp, TextureWrap::mirror));
  EXPECT_EQ(wraps("repeat", "clamp"), std::pair(TextureWrap::repeat, TextureWrap::clamp));
}

TEST(MitsubaTexture, NearestIsNearest) {
  const std::string nearest = "<string name='filter_type' value='nearest'/>";
  EXPECT_EQ(texture_of(picture_of("reflectance", nearest)).filter, TextureFilter::nearest);
  EXPECT_EQ(texture_of(picture_of("reflectance")).filter, TextureFilter::bilinear);
}

TEST(MitsubaTexture, CheckerboardsHaveMitsubasColors) {
  const Texture t = texture_of("<texture type='checkerboard' name='reflectance'/>");
  EXPECT_EQ(t.color0, Color(0.4f));
  EXPECT_EQ(t.color1, Color(0.2f));
}

TEST(MitsubaTexture, CheckerboardsMayHoldTextures) {
  const std::string inner =
      "<texture type='checkerboard' name='color1'><transform name='to_uv'><scale x='4'/>"
      "</transform><rgb name='color0' value='0.1 0.2 0.3'/>" +
      picture_of("color1") + "</texture>";
  const SceneData scene =
      scene_of(bsdf("diffuse", "<texture type='checkerboard' name='reflectance'>" +
                                   picture_of("color0",
                                              "<transform name='to_uv'><scale x='0.5'/></transform>"
                                              "<string name='filter_type' value='nearest'/>") +
                                   inner + "</texture>"));
  const auto at = [&](float u, float v) {  // Mitsuba's v
    return sample_texture(scene.textures.data(), top_of(scene).parameters[0].texture,
                          scene.texels.data(), {u, 1 - v});
  };
  expect_near(at(0.1f, 0.1f), Color(0.2f));  // the outer one's first square: the picture, u / 2
  expect_near(at(0.6f, 0.6f), Color(0.2f));
  expect_near(at(0.55f, 0.1f), {0.1f, 0.2f, 0.3f});     // 4 u = 2.2, the inner one's first
  EXPECT_NEAR(at(0.75f - 1e-4f, 0.1f).x, 0.8f, 1e-3f);  // 4 u just below 3: the picture at 0.75
}

// Whose colours are the other way round: eval_1() of Mitsuba 3.9.1.
TEST(MitsubaTexture, CheckerboardsOfNumbersMayHoldTextures) {
  const std::string nearest = "<string name='filter_type' value='nearest'/>";
  const SceneData scene = scene_of(bsdf(
      "roughconductor", "<texture type='checkerboard' name='alpha'>" +
                            picture_of("color0", nearest) + number("color1", 0.6) + "</texture>"));
  const auto at = [&](float u, float v) {
    return sample_texture(scene.textures.data(), top_of(scene).parameters[3].texture,
                          scene.texels.data(), {u, 1 - v});
  };
  expect_near(at(0.1f, 0.1f), Color(0.6f));
  expect_near(at(0.9f, 0.9f), Color(0.6f));
  expect_near(at(0.6f, 0.1f), Color(0.8f));
  expect_near(at(0.1f, 0.6f), Color(0.2f));
}

TEST(MitsubaTexture, ColorsOfMeshesInACheckerboardAreReported) {
  const LoadedScene loaded = load(
      square(bsdf("diffuse",
                  "<texture type='checkerboard' name='reflectance'><texture type='mesh_attribute' "
                  "name='color0'><string name='name' value='vertex_color'/></texture></texture>")));
  EXPECT_EQ(loaded.count("a mesh_attribute in a checkerboard is not supported"), 1);
}

TEST(MitsubaTexture, BitmapsHaveNoScale) {
  // Mitsuba 3.9.1: 'Found 1 unreferenced property in texture plugin of type "bitmap"'.
  const LoadedScene loaded =
      load(square(bsdf("diffuse", picture_of("reflectance", number("scale", 2)))));
  EXPECT_EQ(loaded.count("scale"), 1);
  EXPECT_EQ(loaded.scene.textures.at(0).color0, Color(1.0f));
}

TEST(MitsubaSurface, MasksAreHalfThereByDefault) {
  EXPECT_EQ(top_of(scene_of(bsdf("mask", bsdf("diffuse")))).opacity.offset, 0.5f);
}

TEST(MitsubaSurface, TwoSidedKeepsTheMaskInside) {
  const std::string mask = bsdf("mask", number("opacity", 0.3) + bsdf("diffuse"));
  const std::string blend =
      bsdf("blendbsdf", number("weight", 0.5) + mask + mask);  // a node, and no bsdf
  for (const std::string& inside : {mask, mask + mask, blend}) {
    const SceneData scene = scene_of(bsdf("twosided", inside));
    EXPECT_FLOAT_EQ(top_of(scene).opacity.offset, 0.3f) << inside;
    EXPECT_TRUE(top_of(scene).node != MaterialNode::none || !top_of(scene).one_sided);
  }
}

TEST(MitsubaSurface, HalfOfATexturedMaskIsHalf) {
  const std::string hole =
      bsdf("blendbsdf", picture_of("weight") + bsdf("diffuse") + bsdf("null"));  // 1 - w is there
  const SceneData whole = scene_of(hole);
  EXPECT_NEAR(opacity_at_texel(whole, 0.25f), 0.8f, 1e-5f);
  EXPECT_NEAR(opacity_at_texel(whole, 0.75f), 0.2f, 1e-5f);
  const SceneData half = scene_of(bsdf("mask", number("opacity", 0.5) + hole));
  EXPECT_NEAR(opacity_at_texel(half, 0.25f), 0.4f, 1e-5f);
  EXPECT_NEAR(opacity_at_texel(half, 0.75f), 0.1f, 1e-5f);
}

TEST(MitsubaSurface, BumpMapsHaveTheScaleOfTheirTexture) {
  const SceneData scene = scene_of(
      bsdf("bumpmap", number("scale", 3) + "<texture type='scale' name='map'>" +
                          number("scale", 0.25) + picture_of("") + "</texture>" + bsdf("diffuse")),
      "0.6.0");
  EXPECT_EQ(top_of(scene).node, MaterialNode::bump_map);
  EXPECT_FLOAT_EQ(top_of(scene).parameters[0].value.x, 0.75f);
}

TEST(MitsubaSurface, MapsHaveTwoFlagsOfTheirOwn) {
  struct Flags {
    bool flips, shadows;
  };
  const auto flags = [](const char* map, const std::string& inside) {
    const SceneData scene = scene_of(
        bsdf(map, inside + picture_of(map == std::string("bumpmap") ? "map" : "normalmap") +
                      bsdf("diffuse")));
    const Color value = top_of(scene).parameters[0].value;  // 1 is off: see turned_normal
    return Flags{value.z == 0.0f, value.y == 0.0f};
  };
  const std::string no_flip = "<boolean name='flip_invalid_normals' value='false'/>";
  const std::string no_shadow = "<boolean name='use_shadowing_function' value='false'/>";
  for (const char* map : {"bumpmap", "normalmap"}) {
    EXPECT_TRUE(flags(map, "").flips && flags(map, "").shadows);
    EXPECT_TRUE(!flags(map, no_flip).flips && flags(map, no_flip).shadows);
    EXPECT_TRUE(flags(map, no_shadow).flips && !flags(map, no_shadow).shadows);
  }
}

TEST(MitsubaSurface, PhongsExponentIs30ByDefault) {  // documentation of Mitsuba 0.6, 8.2.11
  EXPECT_EQ(top_of(scene_of(bsdf("phong"), "0.6.0")).scalar(2), 30.0f);
}

TEST(MitsubaSurface, MetalsStandInWhatIsOutside) {
  const SceneData scene = scene_of(
      bsdf("conductor", "<rgb name='eta' value='0.3 0.6 0.9'/><rgb name='k' value='3 6 9'/>" +
                            number("ext_eta", 1.5)));
  expect_near(top_of(scene).color(1), {0.2f, 0.4f, 0.6f});
  expect_near(top_of(scene).color(2), {2, 4, 6});
  const MaterialDescription gold =
      top_of(scene_of(bsdf("conductor", "<string name='material' value='Au'/>")));
  const MaterialDescription in_glass = top_of(
      scene_of(bsdf("conductor", "<string name='material' value='Au'/>" + number("ext_eta", 1.5))));
  for (const int i : {1, 2}) expect_near(1.5f * in_glass.color(i), gold.color(i));
}

TEST(MitsubaSurface, WardsAxesHaveTexturesOfTheirOwn) {
  const SceneData scene = scene_of(
      bsdf("ward", picture_of("alphaU") + picture_of("alphaV", number("uscale", 3))), "0.6.0");
  const MaterialDescription& ward = top_of(scene);
  EXPECT_EQ(scene.textures.at(ward.parameters[2].texture).u_row[0], 1.0f);
  EXPECT_EQ(scene.textures.at(ward.parameters[3].texture).u_row[0], 3.0f);
}

TEST(MitsubaEmitter, LampsMayBeReferredTo) {
  const std::string lamp =
      "<emitter type='area' id='x'><rgb name='radiance' value='1 2 3'/></emitter>";
  const std::string shape = "<shape type='rectangle'><ref id='x'/></shape>";
  for (const std::string& xml : {lamp + shape, shape + lamp}) {
    const LoadedScene loaded = load(xml);
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
    EXPECT_EQ(top_of(loaded.scene).emission.radiance, Color(1, 2, 3));
  }
  EXPECT_EQ(load(lamp + "<shape type='rectangle'/>").count("in no shape"), 1);
}

// Two half-transparent instances of a black card, one behind the other, before a sky of 1.
TEST(MitsubaInstances, MasksLetThroughIndependently) {
  const auto card = [](double z) {
    return fmt::format(
        "<shape type='instance'><ref id='g'/><transform name='to_world'><scale value='9'/>"
        "<translate z='{}'/></transform></shape>",
        z);
  };
  SceneData scene =
      load_xml(
          "<sensor type='perspective'/><emitter type='constant'/><shape type='shapegroup' id='g'>"
          "<shape type='rectangle'>" +
          bsdf("mask", bsdf("twosided", bsdf("diffuse", "<rgb name='reflectance' value='0'/>"))) +
          "</shape></shape>" + card(2) + card(3))
          .scene;
  Options options = image_options(16, 16, 16, 2);
  prepare_scene(scene, options);
  const Image image = render(scene, options).image;
  double sum = 0;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) sum += image.pixel(x, y)[0];
  }
  // 4096 rays of which a quarter passes: a standard deviation of 0.0068.
  EXPECT_NEAR(sum / 256, 0.25, 0.03);
}

// One checkerboard, whose colours are the other way round as numbers.
TEST(MitsubaTexture, OneCheckerboardIsAColourAndANumber) {
  const SceneData scene =
      load(
          "<texture type='checkerboard' id='t'><rgb name='color0' value='0.1'/><rgb "
          "name='color1' value='0.6'/></texture>" +
          square(bsdf("roughconductor",
                      "<ref name='specular_reflectance' id='t'/><ref "
                      "name='alpha' id='t'/>")))
          .scene;
  const auto at = [&](int parameter) {
    return sample_texture(scene.textures.data(), top_of(scene).parameters[parameter].texture,
                          scene.texels.data(), {0.1f, 0.9f});
  };
  expect_near(at(index_of(&Conductor::tint)), Color(0.1f));
  expect_near(at(index_of(&Conductor::alpha_x)), Color(0.6f));
  expect_near(at(index_of(&Conductor::alpha_y)), Color(0.6f));
}

// Mitsuba's names of a brushed metal's coordinates: without them it has no directions.
TEST(MitsubaSurface, BrushedMetalHasCoordinatesOnEveryShape) {
  const std::string brushed =
      bsdf("roughconductor", number("alpha_u", 0.1) + number("alpha_v", 0.3));
  for (const char* type : {"rectangle", "disk", "cube", "cylinder"}) {
    SCOPED_TRACE(type);
    const SceneData scene =
        load(fmt::format("<shape type='{}'>{}</shape><emitter type='constant'/>", type, brushed))
            .scene;
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].uvs.size(), scene.meshes[0].positions.size());
  }
}

// A d65 multiplies its colour by its scale, but not what lies within it (Mitsuba 3.9's RGB).
TEST(MitsubaTexture, ADaylightsScaleIsOfItsOwnColour) {
  const auto intensity = [](const std::string& inside) {
    return load("<emitter type='point'>" + inside + "</emitter>")
        .scene.delta_lights.at(0)
        .intensity;
  };
  const std::string three = number("scale", 3), color = "<rgb name='color' value='1 2 4'/>";
  const auto d65 = [](const std::string& inside, const char* name) {
    return fmt::format("<spectrum type='d65' name='{}'>{}</spectrum>", name, inside);
  };
  EXPECT_EQ(intensity(d65("", "intensity")), Color(1.0f));
  EXPECT_EQ(intensity(d65(three, "intensity")), Color(3.0f));
  EXPECT_EQ(intensity(d65(three + color, "intensity")), Color(3, 6, 12));
  const std::string own = number("scale", 2) + color;
  EXPECT_EQ(intensity(d65(three + d65(own, "x"), "intensity")), Color(2, 4, 8));
}

TEST(MitsubaEmitter, NamesAreThoseOfTheirOwnLights) {
  const SceneData scene =
      load(
          "<emitter type='point'/><emitter type='constant' id='sky'/><emitter type='spot' "
          "id='b'/><emitter type='point'/><emitter type='directional' id='d'/><shape "
          "type='rectangle' id='s'><emitter type='area'/></shape><shape type='sphere'><emitter "
          "type='area' id='e'/></shape>")
          .scene;
  const std::map<std::uint32_t, std::string> lights(scene.names.delta_lights.begin(),
                                                    scene.names.delta_lights.end());
  EXPECT_EQ(lights, (std::map<std::uint32_t, std::string>{{1, "b"}, {3, "d"}}));
  const std::map<std::uint32_t, std::string> emitters(scene.names.emitters.begin(),
                                                      scene.names.emitters.end());
  EXPECT_EQ(emitters, (std::map<std::uint32_t, std::string>{{0, "s"}, {1, "e"}}));
}

Sun sun_of(const std::string& inside) {
  return load("<emitter type='sun'>" + inside + "</emitter>").scene.sun;
}

/// 0.x has +y up.
Color zenith_of(const std::string& inside, const std::string& version = "3.0.0") {
  const EnvironmentData data =
      load("<emitter type='sky'>" + inside + "</emitter>", version).scene.environment;
  return data.pixels.at(0);  // the first row is all zenith
}

TEST(MitsubaEmitter, TheSunStandsWhereItsTimeSays) {
  const std::vector<std::pair<std::string, std::function<void(SunTime&)>>> rows = {
      {"", [](SunTime&) {}},
      {number("latitude", 20), [](SunTime& t) { t.latitude = 20; }},
      {number("longitude", 120), [](SunTime& t) { t.longitude = 120; }},
      {number("timezone", 8), [](SunTime& t) { t.timezone = 8; }},
      {number("hour", 11), [](SunTime& t) { t.hour = 11; }},
      {number("minute", 40), [](SunTime& t) { t.minute = 40; }},
      {number("second", 3000), [](SunTime& t) { t.second = 3000; }},
      {"<integer name='year' value='2013'/>", [](SunTime& t) { t.year = 2013; }},
      {"<integer name='month' value='4'/>", [](SunTime& t) { t.month = 4; }},
      {"<integer name='day' value='28'/>", [](SunTime& t) { t.day = 28; }}};
  for (const auto& [inside, change] : rows) {
    SunTime time;
    change(time);
    SCOPED_TRACE(inside);
    expect_near(sun_of(inside).direction, sun_direction(time), 1e-6f);
  }
  expect_near(sun_direction({}), {0.2f, 0.7f, 0.65f}, 0.15f);  // in the afternoon: west of Tokyo
}

TEST(MitsubaEmitter, SunAndSkyHaveTheirOwnSizesScalesAndAir) {
  const double degree = double{pi} / 180;
  const Sun sun = sun_of("");
  const double elevation = std::asin(double{sun_direction({}).z});
  const auto irradiance = [](const Sun& s) { return s.radiance * (2.0f * pi * s.one_minus_cos); };
  const auto expect_ratio = [](const Color& found, const Color& expected) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c] / expected[c], 1, 1e-4);
  };
  EXPECT_NEAR(sun.one_minus_cos / (1 - std::cos(0.5 * 0.5358 * degree)), 1, 1e-5);
  expect_ratio(irradiance(sun), sun_irradiance(3, elevation));
  const Sun wide = sun_of(number("sun_radius_scale", 4));
  EXPECT_NEAR(wide.one_minus_cos / (1 - std::cos(2 * 0.5358 * degree)), 1, 1e-5);
  expect_ratio(irradiance(wide), irradiance(sun));
  expect_ratio(irradiance(sun_of(number("scale", 2) + number("sun_scale", 3))),
               6.0f * irradiance(sun));
  expect_ratio(irradiance(sun_of(number("sky_scale", 3))), irradiance(sun));
  expect_ratio(irradiance(sun_of(number("turbidity", 1))), sun_irradiance(1, elevation));
  expect_ratio(irradiance(sun_of(number("turbidity", 10))), sun_irradiance(10, elevation));

  const auto model = [&](double turbidity, float albedo) {
    return SkyModel(turbidity, Color(albedo), elevation).radiance(1, 0.5 * double{pi} - elevation);
  };
  expect_ratio(zenith_of(""), model(3, 0.3f));
  expect_ratio(zenith_of("", "0.6.0"), model(3, 0.15f));
  expect_ratio(zenith_of(number("turbidity", 5)), model(5, 0.3f));
  expect_ratio(zenith_of("<rgb name='albedo' value='0.8'/>"), model(3, 0.8f));
  expect_ratio(zenith_of(number("scale", 2) + number("sky_scale", 3)), 6.0f * model(3, 0.3f));
  expect_ratio(zenith_of(number("sun_scale", 3)), model(3, 0.3f));
}

}  // namespace
}  // namespace pt
