// What each parameter of a directive does: its default, limits and edges, as pbrt-v4's sources have
// them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "common/light/sky/environment.h"
#include "common/scene/data/plastic_material.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/texture/sample_texture.h"
#include "load/expect_near.h"
#include "load/pbrt_scene.h"
#include "render_serial.h"

namespace pt {
namespace {

struct Row {
  std::string text;
  double expected;
};

/// Each text within a world, as a value of its scene.
void expect_values(const std::vector<Row>& rows,
                   const std::function<std::string(const std::string&)>& world,
                   const std::function<float(const SceneData&)>& value, double tolerance = 1e-5) {
  for (const Row& row : rows) {
    SCOPED_TRACE(row.text);
    const SceneData scene = load_pbrt_silently(pbrt_world(world(row.text)));
    EXPECT_NEAR(value(scene), row.expected, tolerance * std::max(1.0, std::abs(row.expected)));
  }
}

constexpr double degree = double{pi} / 180;

// ---- lights

TEST(PbrtValues, Spots) {
  const auto world = [](const std::string& text) {
    return "LightSource \"spot\" " + text + " Shape \"sphere\"";
  };
  const auto light = [](const SceneData& s) { return s.delta_lights.at(0); };
  expect_values({{"", std::cos(30 * degree)},
                 {"\"float coneangle\" 40", std::cos(40 * degree)},
                 {"\"float coneangle\" 180", -1}},
                world, [&](const SceneData& s) { return light(s).cos_outer; });
  expect_values({{"", std::cos(25 * degree)},
                 {"\"float coneangle\" 40", std::cos(35 * degree)},
                 {"\"float conedeltaangle\" 0", std::cos(30 * degree)},
                 {"\"float conedeltaangle\" 30", 1},
                 // The cosine of what is left: of 2 degrees.
                 {"\"float coneangle\" 3", std::cos(2 * degree)}},
                world, [&](const SceneData& s) { return light(s).cos_inner; });
  const double sphere =
      2 * double{pi} *
      (1 - std::cos(25 * degree) + (std::cos(25 * degree) - std::cos(30 * degree)) / 2);
  expect_values({{"", 1},
                 {"\"float scale\" 3", 3},
                 {"\"float scale\" 0", 0},
                 {"\"rgb I\" [2 0 0] \"float scale\" 3", 6},
                 {"\"float power\" 5", 5 / sphere},
                 {"\"float power\" 0", 1},
                 {"\"float power\" -1", 1},
                 {"\"float power\" 5 \"float scale\" 2", 10 / sphere}},
                world, [&](const SceneData& s) { return light(s).intensity.x; });
  expect_values({{"", 1}, {"\"point3 to\" [0 0 -2]", -1}, {"\"point3 from\" [0 0 2]", -1}}, world,
                [&](const SceneData& s) { return light(s).direction.z; });
}

TEST(PbrtValues, PointsAndDistantLights) {
  const auto world = [](const char* type) {
    return [type](const std::string& text) {
      return fmt::format("LightSource \"{}\" {} Shape \"sphere\"", type, text);
    };
  };
  const auto red = [](const SceneData& s) { return s.delta_lights.at(0).intensity.x; };
  expect_values({{"", 1},
                 {"\"float scale\" 3", 3},
                 {"\"float power\" 5", 5 / (4 * double{pi})},
                 {"\"float power\" 5 \"float scale\" 2", 10 / (4 * double{pi})},
                 {"\"float power\" 0", 1}},
                world("point"), red);
  expect_values({{"", 1},
                 {"\"float scale\" 3", 3},
                 {"\"float illuminance\" 5", 5},
                 {"\"float illuminance\" 5 \"rgb L\" [2 0 0]", 10},
                 {"\"float illuminance\" 0", 1}},
                world("distant"), red);
  expect_values({{"", 1}, {"\"point3 from\" [0 0 9]", -1}, {"\"point3 to\" [0 0 -1]", -1}},
                world("distant"), [](const SceneData& s) { return s.delta_lights[0].direction.z; });
}

TEST(PbrtValues, ConstantSkiesAddUp) {
  const auto world = [](const std::string& text) { return text + " Shape \"sphere\""; };
  const std::string sky = "LightSource \"infinite\" ";
  expect_values(
      {{sky, 1},
       {sky + "\"float scale\" .5", 0.5},
       {sky + "\"rgb L\" [3 0 0]", 3},
       {sky + "\"float illuminance\" 3", 3 / double{pi}},
       {sky + "\"float illuminance\" 3 \"float scale\" 2", 6 / double{pi}},
       {sky + sky, 2},
       {sky + "\"rgb L\" [3 0 0] " + sky + "\"rgb L\" [4 0 0]", 7},
       {"ColorSpace \"rec2020\" " + sky, 1}},
      world, [](const SceneData& s) { return s.sky.zenith.x; }, 1e-4);
}

TEST(PbrtValues, OfTwoTheLastHolds) {
  const LoadedScene loaded = load_pbrt_text(
      pbrt_world("LightSource \"infinite\" \"rgb L\" [2 2 2] \"rgb L\" [3 3 3]\n"
                 "Attribute \"shape\" \"float radius\" 4 Attribute \"shape\" \"float radius\" 5\n"
                 "Shape \"sphere\" Shape \"sphere\" \"float radius\" 6 \"float radius\" 7"));
  EXPECT_EQ(loaded.scene.sky.zenith.x, 3.0f);
  EXPECT_EQ(loaded.scene.spheres.at(0).radius(), 5.0f);
  EXPECT_EQ(loaded.scene.spheres.at(1).radius(), 7.0f);
  EXPECT_EQ(loaded.count("given twice: the last holds"), 2);
}

/// A picture of one colour in each half of the sphere, u below and above a half.
void write_halves(const std::string& path, int width, int height, float left, float right) {
  std::string bytes = fmt::format("PF\n{} {}\n-1\n", width, height);
  for (int i = 0; i < width * height; ++i) {
    const Color c(i % width < width / 2 ? left : right);
    bytes.append(reinterpret_cast<const char*>(&c), sizeof c);
  }
  write_text(path, bytes);
}

float sky_at(const EnvironmentData& map, const Vec3& d) {
  Environment view;
  view.width = static_cast<std::uint32_t>(map.width);
  view.height = static_cast<std::uint32_t>(map.height);
  const MapPoint p = environment_point(view, d);
  return map
      .pixels[static_cast<std::size_t>(p.y + 0.5f) * view.width +
              static_cast<std::size_t>(p.x) % view.width]
      .x;
}

TEST(PbrtValues, PicturesOfTheSkyAddUp) {
  const TempFolder folder;
  write_halves(folder.file("small.pfm"), 32, 32, 1, 2);    // equal areas: u < 1/2 is x < 0
  write_halves(folder.file("large.pfm"), 256, 128, 4, 8);  // u < 1/2 is y > 0
  write_text(
      folder.file("scene.pbrt"),
      pbrt_world("LightSource \"infinite\" \"string filename\" \"small.pfm\" \"float scale\" "
                 "10 LightSource \"infinite\" \"string filename\" \"large.pfm\" "
                 "LightSource \"infinite\" \"rgb L\" [.5 .5 .5] Shape \"sphere\""));
  const LoadedScene loaded = load_pbrt_file(folder.file("scene.pbrt"));
  EXPECT_TRUE(loaded.warnings.empty());
  EXPECT_EQ(loaded.scene.sky.zenith.x, 0.5f);
  const EnvironmentData& map = loaded.scene.environment;
  const float s = std::sqrt(0.5f);
  EXPECT_NEAR(sky_at(map, {s, s, 0}), 24, 1e-3f);
  EXPECT_NEAR(sky_at(map, {-s, s, 0}), 14, 1e-3f);
  EXPECT_NEAR(sky_at(map, {s, -s, 0}), 28, 1e-3f);
  EXPECT_NEAR(sky_at(map, {-s, -s, 0}), 18, 1e-3f);
}

TEST(PbrtValues, PowerOfALampWithAPictureCountsItsMean) {
  const TempFolder folder;
  write_halves(folder.file("a.pfm"), 2, 1, 1, 3);
  const auto radiance = [&](const std::string& lamp) {
    write_text(folder.file("scene.pbrt"),
               pbrt_world("AreaLightSource \"diffuse\" \"string filename\" \"a.pfm\" " + lamp +
                          " Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]"));
    const SceneData scene = load_pbrt_file(folder.file("scene.pbrt")).scene;
    const Emission& e = scene.materials.back().emission;
    EXPECT_EQ(scene.textures.at(e.texture).wrap_u, TextureWrap::clamp);
    EXPECT_EQ(scene.textures.at(e.texture).wrap_v, TextureWrap::clamp);
    return double{e.radiance.x};
  };
  EXPECT_NEAR(radiance(""), 1, 1e-5);
  EXPECT_NEAR(radiance("\"float scale\" 3"), 3, 1e-5);
  // L * mean * pi * area = power
  EXPECT_NEAR(radiance("\"float power\" 12"), 12 / (2 * double{pi} * 0.5), 1e-3);
  EXPECT_NEAR(radiance("\"float power\" 12 \"bool twosided\" true"), 6 / (2 * double{pi} * 0.5),
              1e-3);
  EXPECT_NEAR(radiance("\"float power\" -1"), 1, 1e-5);
}

/// Means over a quarter of a lamp of 2 x 2 texels that are looked up bilinearly and not repeated:
/// along each axis 7/8 of one and 1/8 of the other.
TEST(PbrtValues, PicturesOfLampsAreClamped) {
  const TempFolder folder;
  std::string bytes = "PF\n2 2\n-1\n";
  for (const float v : {0.0f, 0.0f, 1.0f, 0.0f}) {  // from its foot; 1 above left
    const Color c(v);
    bytes.append(reinterpret_cast<const char*>(&c), sizeof c);
  }
  write_text(folder.file("t.pfm"), bytes);
  write_text(folder.file("scene.pbrt"),
             "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16 PixelFilter "
             "\"box\" LookAt 0 0 5 0 0 0 0 1 0 Camera \"orthographic\" \"float screenwindow\" [-1 "
             "1 -1 1] WorldBegin AreaLightSource \"diffuse\" \"string filename\" \"t.pfm\" Shape "
             "\"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-1 -1 0 1 -1 0 1 1 "
             "0 -1 1 0] \"point2 uv\" [0 0 1 0 1 1 0 1]");
  SceneData scene = load_pbrt_file(folder.file("scene.pbrt")).scene;
  Options options = image_options(16, 16, 64, 1);
  options.filter = FilterChoice();
  prepare_scene(scene, options);
  const Image image = render(scene, options).image;
  double quarters[2][2] = {};
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) quarters[y / 8][x / 8] += double{image.pixel(x, y)[0]} / 64;
  }
  EXPECT_NEAR(quarters[0][0] + quarters[0][1] + quarters[1][0] + quarters[1][1], 1.0, 0.01);
  const double most = std::max({quarters[0][0], quarters[0][1], quarters[1][0], quarters[1][1]});
  const double least = std::min({quarters[0][0], quarters[0][1], quarters[1][0], quarters[1][1]});
  EXPECT_NEAR(most, 49 / 64.0, 0.01);
  EXPECT_NEAR(least, 1 / 64.0, 0.005);
}

/// pbrt's SpotLight::SampleLi, integrated over a wall: the cone is one of the light's own space,
/// intensity falls with the distance in the world.
TEST(PbrtValues, SpotsLiveInTheirOwnSpace) {
  const auto irradiance = [](const std::string& transform, const Affine& to_world) {
    SCOPED_TRACE(transform);
    SceneData scene = load_pbrt_silently(
        "Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" 32 PixelFilter \"box\"\n"
        "LookAt 0 0 5 0 0 0 0 1 0 Camera \"orthographic\" \"float screenwindow\" [-2 2 -2 2]\n"
        "WorldBegin AttributeBegin " +
        transform +
        "LightSource \"spot\" \"point3 from\" [1 0 3] \"point3 to\" [0 .5 0] \"float scale\" 20 "
        "\"float coneangle\" 35 \"float conedeltaangle\" 10 AttributeEnd Material \"diffuse\" "
        "\"rgb "
        "reflectance\" [1 1 1] Shape \"trianglemesh\" \"point3 P\" [-4 -4 0 4 -4 0 4 4 0 -4 4 0] "
        "\"integer indices\" [0 1 2 0 2 3]");
    Options options = image_options(32, 32, 64, 2);
    options.filter = FilterChoice();
    prepare_scene(scene, options);
    const Image image = render(scene, options).image;
    const Vec3 from(1, 0, 3), axis = glm::normalize(Vec3(0, 0.5f, 0) - from);
    const Vec3 place = to_world.point(from);
    const Affine to_light = inverse(to_world);
    double expected = 0, found = 0;
    constexpr int steps = 256;
    for (int j = 0; j < steps; ++j) {
      for (int i = 0; i < steps; ++i) {
        const Vec3 p(-2 + 4 * (static_cast<float>(i) + 0.5f) / steps,
                     -2 + 4 * (static_cast<float>(j) + 0.5f) / steps, 0);
        const Vec3 d = p - place;
        const double cosine = dot(glm::normalize(to_light.vector(d)), axis);
        const double low = std::cos(35 * degree), high = std::cos(25 * degree);
        const double t = std::clamp((cosine - low) / (high - low), 0.0, 1.0);
        const double length = glm::length(d);
        expected += 20 * t * t * (3 - 2 * t) / (length * length) * std::abs(double{d.z}) / length /
                    double{pi} / (steps * steps);
      }
    }
    for (const float v : image.rgb) found += double{v} / static_cast<double>(image.rgb.size());
    EXPECT_NEAR(found, expected, 0.004 * expected);
  };
  irradiance("Rotate 20 0 1 0 ", rotate({0, 1, 0}, 20));
  irradiance("Rotate 20 0 1 0 Scale 1.3 .7 1.1 ",
             rotate({0, 1, 0}, 20) * scale({1.3f, 0.7f, 1.1f}));
  irradiance("Scale 2 1 1 Rotate 30 1 0 0 ", scale({2, 1, 1}) * rotate({1, 0, 0}, 30));
  irradiance("Scale -1.5 1 1 ", scale({-1.5f, 1, 1}));
  irradiance("Scale 2 2 2 ", scale(Vec3(2.0f)));
}

/// All of the light is within the picture: at twice the tangent of the cone's angle.
TEST(PbrtValues, AStretchedConeIsWhole) {
  const SceneData scene = load_pbrt_silently(pbrt_world(
      "Scale 2 1 1 LightSource \"spot\" \"float coneangle\" 35 \"float conedeltaangle\" 10 Shape "
      "\"sphere\""));
  const double angle = std::acos(double{scene.delta_lights.at(0).cos_outer});
  const double edge = std::atan(2 * std::tan(35 * degree));
  EXPECT_GT(angle, edge + 5e-4);  // with a margin, since edges between those tried are farther
  EXPECT_LT(angle, edge + 2e-3);
  // The picture has the falloff.
  EXPECT_EQ(scene.delta_lights.at(0).cos_inner, scene.delta_lights.at(0).cos_outer);
}

// ---- textures

/// What a texture named t is at a place.
Color texture_value(const std::string& textures, const std::string& bytes, const char* file,
                    const Vec2& at = {0.5f, 0.5f}) {
  const TempFolder folder;
  write_text(folder.file(file), bytes);
  write_text(folder.file("scene.pbrt"),
             pbrt_world(lit + textures +
                        "\nMaterial \"diffuse\" \"texture reflectance\" \"t\" Shape "
                        "\"sphere\""));
  const SceneData scene = load_pbrt_file(folder.file("scene.pbrt")).scene;
  const Parameter& p = scene.materials.back().parameters[0];
  if (p.texture == no_texture) return p.value;
  return p.value * sample_texture(scene.textures.data(), p.texture, scene.texels.data(), at);
}

TEST(PbrtValues, EncodingsOfPicturesAreThoseOfPng) {
  const std::string grey = "P6 1 1 255\n\x80\x80\x80";  // 128; the content is no matter
  const double v = 128 / 255.0, srgb = std::pow((v + 0.055) / 1.055, 2.4);
  const auto value = [&](const char* file, const std::string& encoding) {
    const std::string given = encoding.empty() ? "" : "\"string encoding\" \"" + encoding + "\"";
    return texture_value(fmt::format("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" "
                                     "\"{}\" {}",
                                     file, given),
                         grey, file)
        .x;
  };
  EXPECT_NEAR(value("a.png", ""), srgb, 1e-4);
  EXPECT_NEAR(value("a.png", "sRGB"), srgb, 1e-4);
  EXPECT_NEAR(value("a.png", "linear"), v, 1e-4);
  EXPECT_NEAR(value("a.PNG", "linear"), v, 1e-4);
  EXPECT_NEAR(value("a.png", "gamma 2.2"), std::pow(v, 2.2), 1e-4);
  EXPECT_NEAR(value("a.png", "gamma .5"), std::pow(v, 0.5), 1e-4);
  EXPECT_NEAR(value("a.png", "gamma 1"), v, 1e-4);
  // Another's is not asked.
  EXPECT_NEAR(value("a.jpg", "linear"), srgb, 1e-4);
  EXPECT_NEAR(value("a.tga", "gamma 2.2"), srgb, 1e-4);
  // What is none loses the texture.
  for (const char* wrong : {"gamma 0", "gamma -1", "gamma 100", "gamma x", "gamma", "srgb"}) {
    EXPECT_NEAR(value("a.png", wrong), 0.5, 1e-6) << wrong;
  }
}

TEST(PbrtValues, PartsOfTextures) {
  const std::string grey =
      "PF\n1 1\n-1\n" + std::string("\0\0\0\x3f\0\0\0\x3f\0\0\0\x3f", 12);  // .5
  const std::string picture =
      "Texture \"p\" \"spectrum\" \"imagemap\" \"string filename\" \"a.pfm\" ";
  const std::string number = "Texture \"f\" \"float\" \"imagemap\" \"string filename\" \"a.pfm\" ";
  const auto expect = [&](const std::string& textures, double value) {
    EXPECT_NEAR(texture_value(textures, grey, "a.pfm").x, value, 1e-5) << textures;
  };
  const std::string t = "Texture \"t\" \"spectrum\" ";
  expect(t + "\"imagemap\" \"string filename\" \"a.pfm\"", 0.5);
  expect(t + "\"imagemap\" \"string filename\" \"a.pfm\" \"float scale\" .25", 0.125);
  expect(t + "\"imagemap\" \"string filename\" \"a.pfm\" \"bool invert\" true", 0.5);
  expect(t + "\"imagemap\" \"string filename\" \"a.pfm\" \"float scale\" 3 \"bool invert\" true",
         0);
  expect(t + "\"constant\"", 1);
  expect(t + "\"constant\" \"rgb value\" [.3 .3 .3]", 0.3);
  expect(t + "\"scale\"", 1);
  expect(t + "\"scale\" \"rgb tex\" [.5 .5 .5] \"float scale\" .5", 0.25);
  expect(picture + t + "\"scale\" \"texture tex\" \"p\"", 0.5);
  expect(picture + "\"float scale\" .5 " + t + "\"scale\" \"texture tex\" \"p\" \"float scale\" .5",
         0.125);
  expect(number + t + "\"scale\" \"rgb tex\" [.5 .5 .5] \"texture scale\" \"f\"", 0.25);
  expect(number + "\"float scale\" .5 " + t +
             "\"scale\" \"rgb tex\" [.5 .5 .5] \"texture scale\" "
             "\"f\"",
         0.125);
  expect(picture + number + t + "\"scale\" \"texture tex\" \"p\" \"texture scale\" \"f\"", 0.25);
  expect(t + "\"mix\"", 0.5);
  expect(t + "\"mix\" \"float amount\" 0", 0);
  expect(t + "\"mix\" \"float amount\" 1", 1);
  expect(t + "\"mix\" \"float amount\" .25", 0.25);
  expect(t + "\"mix\" \"rgb tex1\" [.2 .2 .2] \"float amount\" .25", 0.4);
  expect(t + "\"mix\" \"rgb tex2\" [.2 .2 .2] \"float amount\" .25", 0.05);
  expect(t + "\"directionmix\"", 0.5);
  expect(t + "\"checkerboard\"", 1);
  expect(t + "\"checkerboard\" \"float udelta\" 1", 0);
  expect(t + "\"checkerboard\" \"float vscale\" 3", 0);
}

// ---- materials

TEST(PbrtValues, MixesOfMaterialsAreEven) {
  const std::string two =
      "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\n"
      "MakeNamedMaterial \"b\" \"string type\" \"dielectric\"\n";
  expect_values(
      {{"", 0.5}, {"\"float amount\" .25", 0.25}, {"\"float amount\" .75", 0.75}},
      [&](const std::string& text) {
        return lit + two + "Material \"mix\" \"string materials\" [\"a\" \"b\"] " + text +
               " Shape \"sphere\"";
      },
      [](const SceneData& s) { return s.materials.back().parameters[0].value.x; });
}

MaterialDescription default_material(const std::string& material) {
  return load_pbrt_text(pbrt_world(lit + "Material " + material + " Shape \"sphere\""))
      .scene.materials.back();
}

TEST(PbrtValues, MetalsUnderACoatHaveTheirIndexOverTheCoats) {
  const auto metal = [](const std::string& parameters) {
    const SceneData scene = load_pbrt_text(pbrt_world(lit + "Material \"coatedconductor\" " +
                                                      parameters + " Shape \"sphere\""))
                                .scene;
    const MaterialDescription& blend = scene.materials.back();
    EXPECT_EQ(blend.node, MaterialNode::blend);
    return scene.materials[blend.children[0]];
  };
  const MaterialDescription given =
      metal("\"rgb conductor.eta\" [.3 .6 .9] \"rgb conductor.k\" [3 6 9]");
  expect_near(given[&Conductor::eta].value, {0.2f, 0.4f, 0.6f});
  expect_near(given[&Conductor::k].value, {2, 4, 6});
  const MaterialDescription other = metal(
      "\"rgb conductor.eta\" [.3 .6 .9] \"rgb conductor.k\" [3 6 9] \"float interface.eta\" 2");
  expect_near(other[&Conductor::eta].value, {0.15f, 0.3f, 0.45f});
  expect_near(other[&Conductor::k].value, {1.5f, 3, 4.5f});
  // pbrt's eta of 1 and k = 2 sqrt(r / (1 - r)), over the coat's 1.5.
  const MaterialDescription reflecting = metal("\"rgb reflectance\" [.5 .2 .8]");
  expect_near(reflecting[&Conductor::eta].value, Color(1 / 1.5f));
  expect_near(reflecting[&Conductor::k].value, {2 / 1.5f, 1 / 1.5f, 4 / 1.5f}, 1e-4f);
  // Roughness is the root of what is given; each surface has its own.
  const MaterialDescription rough = metal("\"float conductor.roughness\" .04");
  EXPECT_NEAR(rough[&Conductor::alpha_x].value.x, 0.2f, 1e-5f);
}

TEST(PbrtValues, DefaultsOfMaterials) {
  EXPECT_EQ(default_material("\"diffuse\"").parameters[0].value, Color(0.5f));
  EXPECT_EQ(default_material("\"dielectric\"").parameters[1].value.x, 1.5f);
  EXPECT_NEAR(
      default_material("\"dielectric\" \"spectrum eta\" \"glass-BK7\"").parameters[1].value.x,
      1.5168f, 1e-6f);
  EXPECT_EQ(default_material("\"thindielectric\"")[&ThinDielectric::eta].value.x, 1.5f);
  EXPECT_EQ(default_material("\"conductor\"").kind, kind_of<Conductor>);
  // A boundary of facets below alpha 1e-3 is smooth: of roughness below 1e-6.
  EXPECT_EQ(default_material("\"dielectric\" \"float roughness\" .9e-6").kind, kind_of<Dielectric>);
  EXPECT_EQ(default_material("\"dielectric\" \"float roughness\" 1.1e-6").kind,
            kind_of<RoughDielectric>);
  EXPECT_EQ(
      default_material("\"dielectric\" \"float roughness\" .9e-3 \"bool remaproughness\" false")
          .kind,
      kind_of<Dielectric>);
  const MaterialDescription own =
      default_material("\"dielectric\" \"float roughness\" .04 \"float uroughness\" .09");
  EXPECT_NEAR(own[&RoughDielectric::alpha_x].value.x, 0.3f, 1e-5f);
  EXPECT_NEAR(own[&RoughDielectric::alpha_y].value.x, 0.2f, 1e-5f);
  EXPECT_NEAR(default_material("\"coateddiffuse\"").parameters[0].value.x, 0.5f * std::exp(-0.03f),
              1e-5f);
  EXPECT_NEAR(default_material("\"coateddiffuse\" \"float thickness\" 0").parameters[0].value.x,
              0.5f, 1e-6f);
  EXPECT_EQ(default_material("\"diffusetransmission\"").parameters[0].value.x, 0.5f);  // shares
}

// ---- shapes

double whole_area(const SceneData& scene) {
  double sum = 0;
  for (const Mesh& mesh : scene.meshes) {
    for (const TriangleIndices& t : mesh.triangles) {
      const Vec3& p = mesh.positions[t.v[0]];
      sum +=
          0.5 *
          double{glm::length(glm::cross(mesh.positions[t.v[1]] - p, mesh.positions[t.v[2]] - p))};
    }
  }
  for (const Sphere& s : scene.spheres)
    sum += 4 * double{pi} * double{s.radius()} * double{s.radius()};
  return sum;
}

TEST(PbrtValues, AreasOfShapes) {
  constexpr double circle = double{pi};
  expect_values(
      {{"\"sphere\"", 4 * circle},
       {"\"sphere\" \"float radius\" 2", 16 * circle},
       {"\"sphere\" \"float zmin\" 0", 2 * circle},
       {"\"sphere\" \"float zmax\" .5", 3 * circle},
       {"\"sphere\" \"float zmin\" .5 \"float zmax\" -.5", 2 * circle},
       {"\"sphere\" \"float zmin\" -9 \"float zmax\" 9", 4 * circle},
       {"\"sphere\" \"float phimax\" 90", circle},
       {"\"sphere\" \"float phimax\" 720", 4 * circle},
       {"\"disk\"", circle},
       {"\"disk\" \"float radius\" 3 \"float height\" 2", 9 * circle},
       {"\"disk\" \"float innerradius\" .5", 0.75 * circle},
       {"\"disk\" \"float radius\" 3 \"float innerradius\" 2", 5 * circle},
       {"\"disk\" \"float phimax\" 180", 0.5 * circle},
       {"\"cylinder\"", 4 * circle},
       {"\"cylinder\" \"float radius\" 2 \"float zmin\" .5", 2 * circle},
       {"\"cylinder\" \"float zmin\" 0", 2 * circle},
       {"\"cylinder\" \"float zmax\" 2", 6 * circle},
       {"\"cylinder\" \"float phimax\" 45", 0.5 * circle},
       {"\"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 3 0 2 3 0]", 6},
       {"\"trianglemesh\" \"point3 P\" [0 0 0 2 0 0 0 3 0]", 3},
       {"\"trianglemesh\" \"point3 P\" [0 0 0 2 0 0 0 3 0 2 3 0] \"integer indices\" [0 1 2 1 3 2]",
        6}},
      [](const std::string& text) {
        return lit + "Shape " + text + " Shape \"sphere\" \"float radius\" 1e-9";
      },
      [](const SceneData& s) { return static_cast<float>(whole_area(s)); }, 5e-4);
}

// ---- media

TEST(PbrtValues, TheFilmExposesAllThatGlows) {
  const auto emission = [](const std::string& medium) {
    const std::string world = "MakeNamedMedium \"m\" " + medium +
                              " MediumInterface \"m\" \"\" Material \"interface\" Shape "
                              "\"sphere\"";
    const SceneData plain = load_pbrt_silently(pbrt_world(world));
    const SceneData exposed = load_pbrt_silently(
        "Film \"rgb\" \"float iso\" 300 Camera \"perspective\" \"float shutterclose\" "
        "2\nWorldBegin\n" +
        world);
    EXPECT_GT(plain.media.at(0).emission.x, 0.0f);
    EXPECT_NEAR(exposed.media.at(0).emission.x / plain.media.at(0).emission.x, 6.0f, 1e-4f)
        << medium;
    return plain.media[0].emission.x;
  };
  EXPECT_NEAR(emission("\"string type\" \"homogeneous\" \"rgb Le\" [2 2 2] \"float Lescale\" 3"), 6,
              1e-5);
  EXPECT_NEAR(emission("\"string type\" \"homogeneous\" \"rgb Le\" [2 2 2]"), 2, 1e-5);
  emission("\"string type\" \"uniformgrid\" \"float density\" 1 \"rgb Le\" [2 2 2]");
  emission("\"string type\" \"uniformgrid\" \"float density\" 1 \"float temperature\" 3000");
  emission("\"string type\" \"rgbgrid\" \"rgb sigma_a\" [1 1 1] \"rgb Le\" [2 2 2]");
}

TEST(PbrtValues, Media) {
  const auto world = [](const std::string& text) {
    return lit + "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" " + text +
           " MediumInterface \"m\" \"\" Material \"interface\" Shape \"sphere\"";
  };
  expect_values({{"", 2},
                 {"\"float scale\" 3", 6},
                 {"\"float scale\" 0", 0},
                 {"\"rgb sigma_a\" [.5 .5 .5]", 1.5},
                 {"\"rgb sigma_s\" [4 4 4] \"float scale\" .5", 2.5},
                 {"\"string preset\" \"Skin1\"", 0.032 + 0.74}},
                world, [](const SceneData& s) { return s.media.at(0).extinction.x; });
  expect_values({{"", 0}, {"\"float g\" .5", 0.5}, {"\"float g\" -.999", -0.999}}, world,
                [](const SceneData& s) { return s.media.at(0).phase_parameter; });
}

// ---- film and camera

TEST(PbrtValues, FiltersSamplersAndFilms) {
  const auto defaults = [](const std::string& text) {
    return load_pbrt_silently(text +
                              " Camera \"perspective\" WorldBegin LightSource \"infinite\" "
                              "Shape \"sphere\"");
  };
  const auto filter = [&](const std::string& text) {
    return *defaults("PixelFilter " + text).defaults.filter;
  };
  EXPECT_EQ(filter("\"box\""), (FilterChoice{FilterKind::box, 0.5f, 0.0f}));
  EXPECT_EQ(filter("\"triangle\"").a, 2.0f);
  EXPECT_EQ(filter("\"gaussian\"").a, 0.5f);
  EXPECT_EQ(filter("\"gaussian\" \"float sigma\" .25").a, 0.25f);
  EXPECT_EQ(filter("\"mitchell\"").a, 1.0f / 3.0f);
  EXPECT_EQ(filter("\"sinc\"").a, 3.0f);
  EXPECT_EQ(defaults("Sampler \"independent\" \"integer pixelsamples\" 1").defaults.spp, 1);
  EXPECT_EQ(defaults("Sampler \"stratified\"").defaults.spp, 16);
  EXPECT_EQ(defaults("Sampler \"stratified\" \"integer xsamples\" 2").defaults.spp, 8);
  EXPECT_EQ(defaults("Integrator \"path\"").defaults.max_depth, 6);
  EXPECT_EQ(defaults("Integrator \"volpath\" \"integer maxdepth\" 100").defaults.max_depth, 101);
  EXPECT_EQ(defaults("Film \"rgb\" \"integer xresolution\" 1").defaults.width, 1);
  EXPECT_EQ(defaults("Film \"rgb\" \"float iso\" 50").sky.zenith.x, 0.5f);
  EXPECT_EQ(defaults("Film \"rgb\" \"float cropwindow\" [0 1 0 1]").defaults.crop, std::nullopt);
}

}  // namespace
}  // namespace pt
