// Colours, surfaces, textures and lights. Numbers called golden come from Mitsuba 3.9.1
// (scalar_rgb).
#include <gtest/gtest.h>

#include "common/image/codecs/image_io.h"
#include "common/texture/sample_texture.h"
#include "load/expect_near.h"
#include "load/mitsuba_scene.h"
#include "shared_file.h"

namespace pt {
namespace {

/// The material of a rectangle with this inside.
MaterialDescription material_with(const std::string& inside, const std::string& version = "3.0.0") {
  const SceneData scene =
      load_xml("<shape type=\"rectangle\">" + inside + "</shape>", version).scene;
  return scene.materials.at(scene.quad_material.at(0));
}

Color reflectance(const std::string& element, const std::string& version = "3.0.0") {
  return material_with("<bsdf type=\"diffuse\">" + element + "</bsdf>", version).color(0);
}

TEST(MitsubaColor, rgbInAllForms) {
  const auto rgb = [](const std::string& value) {
    return reflectance("<rgb name=\"reflectance\" value=\"" + value + "\"/>");
  };
  EXPECT_EQ(rgb("0.1, 0.2, 0.3"), Color(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(rgb("0.1 0.2 0.3"), Color(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(rgb("0.5"), Color(0.5f));
  expect_near(rgb("#ff8000"), {1.0f, 0.2158605f, 0.0f});  // IEC 61966-2-1
  expect_near(reflectance("<srgb name=\"reflectance\" value=\"0.5\"/>", "0.6.0"),
              Color(0.2140411f));
  for (const char* bad : {"", "a", "1 2", "#12345", "#gggggg", "-0.5"}) {
    expect_error([&] { rgb(bad); }, "scene.xml:2: ");
  }
  const LoadedScene bright = load_xml(
      "<shape type=\"rectangle\"><bsdf type=\"diffuse\">"
      "<rgb name=\"reflectance\" value=\"2 0.5 1\"/></bsdf></shape>");
  EXPECT_EQ(bright.scene.materials[0].color(0), Color(1.0f, 0.5f, 1.0f));
  EXPECT_EQ(bright.count("above 1"), 1);
}

TEST(MitsubaSurface, nearestMaterials) {
  EXPECT_TRUE(material_with("").one_sided);
  EXPECT_EQ(material_with("").color(0), Color(0.5f));
  EXPECT_EQ(material_with("<emitter type=\"area\"/>").color(0), Color(0.0f));  // golden
  const MaterialDescription both = material_with(
      "<bsdf type=\"twosided\"><bsdf type=\"roughplastic\">"
      "<rgb name=\"diffuse_reflectance\" value=\"0.3\"/></bsdf></bsdf>");
  EXPECT_FALSE(both.one_sided);
  EXPECT_EQ(both.kind, kind_of<RoughPlastic>);
  EXPECT_EQ(both.color(0), Color(0.3f));
  const MaterialDescription glass = material_with("<bsdf type=\"dielectric\"/>");
  EXPECT_EQ(glass.kind, kind_of<Dielectric>);
  EXPECT_NEAR(glass.scalar(1), 1.5046f / 1.000277f, 1e-5f);
  const MaterialDescription named = material_with(
      "<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"diamond\"/>"
      "<string name=\"ext_ior\" value=\"vacuum\"/></bsdf>");
  EXPECT_EQ(named.scalar(1), 2.419f);
  const MaterialDescription pane = material_with("<bsdf type=\"thindielectric\"/>");
  EXPECT_EQ(pane.kind, kind_of<ThinDielectric>);
  EXPECT_NEAR(pane.scalar(2), 1.5046f / 1.000277f, 1e-5f);
}

TEST(MitsubaSurface, conductorsByNameAndByIndex) {
  const MaterialDescription mirror = material_with("<bsdf type=\"conductor\"/>");
  EXPECT_EQ(mirror.kind, kind_of<Conductor>);
  EXPECT_TRUE(mirror.one_sided);
  EXPECT_EQ(mirror.color(1), Color(0.0f));  // k and no eta: all is reflected
  EXPECT_EQ(mirror.color(2), Color(1.0f));
  // Golden: what Mitsuba's conductor with material Cu has. 0.x takes copper where none is named.
  const Color copper_eta(0.201005f, 0.92375f, 1.10222f);
  expect_near(material_with("<bsdf type=\"conductor\"/>", "0.6.0").color(1), copper_eta, 1e-5f);
  // The numbers of aluminium as modern-hall gives them.
  const MaterialDescription metal = material_with(
      "<bsdf type=\"roughconductor\"><float name=\"alpha\" value=\"0.2\"/>"
      "<string name=\"distribution\" value=\"ggx\"/>"
      "<rgb name=\"eta\" value=\"1.65746, 0.880369, 0.521229\"/>"
      "<rgb name=\"k\" value=\"9.22387, 6.26952, 4.837\"/></bsdf>");
  expect_near(metal.color(1), {1.65746f, 0.880369f, 0.521229f});
  expect_near(metal.color(2), {9.22387f, 6.26952f, 4.837f});
  EXPECT_EQ(metal.scalar(3), 0.2f);
  EXPECT_EQ(metal.scalar(4), 0.2f);
  EXPECT_EQ(metal.scalar(5), 0.0f);
  expect_error(
      [] {
        material_with(
            "<bsdf type=\"roughconductor\">"
            "<string name=\"distribution\" value=\"phong\"/></bsdf>");
      },
      "distribution 'phong'; expected beckmann or ggx");
}

TEST(MitsubaSurface, roughnessMayDifferAndBeTextured) {
  const LoadedScene loaded = load_xml(
      "<sensor type=\"perspective\"/><emitter type=\"constant\"/><shape type=\"rectangle\">"
      "<bsdf type=\"roughdielectric\"><float name=\"alpha_u\" value=\"0\"/>"
      "<texture name=\"alpha_v\" type=\"checkerboard\"><rgb name=\"color0\" value=\"1 0 0\"/>"
      "</texture></bsdf></shape>");
  EXPECT_TRUE(loaded.warnings.empty());
  const MaterialDescription glass = loaded.scene.materials.at(0);
  EXPECT_EQ(glass.kind, kind_of<RoughDielectric>);
  EXPECT_EQ(glass.scalar(3), 1e-4f);  // as Mitsuba has it: no mirror
  EXPECT_EQ(glass.scalar(4), 1.0f);
  EXPECT_EQ(glass.scalar(5), 1.0f);  // Beckmann
  ASSERT_EQ(glass.parameters[4].texture, 0u);
  // A number is the mean of a colour; Mitsuba's eval_1() begins with color1.
  expect_near(loaded.scene.textures.at(0).color0, Color(0.2f));
  expect_near(loaded.scene.textures.at(0).color1, Color(1.0f / 3.0f));  // golden
}

TEST(MitsubaSurface, principledWithAllItsParameters) {
  const auto principled = [](const std::string& inside) {
    return material_with("<bsdf type=\"principled\"><rgb name=\"base_color\" value=\"0.2\"/>" +
                         inside + "</bsdf>");
  };
  const MaterialDescription plain = principled("");
  EXPECT_EQ(plain.kind, kind_of<Principled>);
  EXPECT_TRUE(plain.one_sided);
  EXPECT_EQ(plain.color(0), Color(0.2f));
  EXPECT_EQ(plain.scalar(1), 0.5f);
  EXPECT_NEAR(plain.scalar(4), 1.5f, 1e-6f);  // specular 0.5
  const MaterialDescription glass =
      principled("<float name=\"spec_trans\" value=\"0.9\"/><float name=\"eta\" value=\"1\"/>");
  EXPECT_FALSE(glass.one_sided);
  EXPECT_FLOAT_EQ(glass.scalar(3), 0.9f);
  EXPECT_EQ(glass.scalar(4), 1.001f);
}

TEST(MitsubaSurface, everyReplacementIsReportedOnce) {
  std::string xml = "<sensor type=\"perspective\"/><emitter type=\"constant\"/>\n";
  for (const char* type : {"hair", "measured"}) {
    for (int i = 0; i < 3; ++i) {
      xml += std::string("<shape type=\"rectangle\"><bsdf type=\"") + type + "\"/></shape>\n";
    }
  }
  const LoadedScene loaded = load_xml(xml);
  EXPECT_EQ(loaded.warnings.size(), 2u);
  EXPECT_EQ(loaded.count("scene.xml:3: bsdf 'hair' is not supported: diffuse grey is used"), 1);
  expect_error([] { material_with("<bsdf type=\"twosided\"/>"); }, "has no bsdf inside");
}

/// The materials of a shape with this bsdf; the last one is the shape's.
std::vector<MaterialDescription> materials_of(const std::string& bsdf) {
  const LoadedScene loaded = load_xml(
      "<sensor type=\"perspective\"/><emitter type=\"constant\"/>\n<shape type=\"rectangle\">" +
      bsdf + "</shape>");
  EXPECT_EQ(loaded.warnings.size(), 0u);
  return loaded.scene.materials;
}

std::string grey_bsdf(double value) {
  return "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"" + std::to_string(value) +
         "\"/></bsdf>";
}

TEST(MitsubaSurface, mixturesAreBlends) {
  const auto m = materials_of(
      "<bsdf type=\"mixturebsdf\"><string name=\"weights\" "
      "value=\"0.2, 0.5\"/>" +
      grey_bsdf(0.4) + grey_bsdf(0.8) + "</bsdf>");
  // ((black, first), second): 0.3 black and 0.2 of 0.4, together a half, and 0.5 of 0.8.
  ASSERT_EQ(m.size(), 5u);
  EXPECT_EQ(m.back().node, MaterialNode::blend);
  EXPECT_NEAR(m.back().scalar(0), 0.5f, 1e-6f);
  EXPECT_EQ(m[m.back().children[1]].color(0), Color(0.8f));
  const MaterialDescription& rest = m[m.back().children[0]];
  EXPECT_NEAR(rest.scalar(0), 0.2f / 0.5f, 1e-6f);
  EXPECT_EQ(m[rest.children[0]].color(0), Color(0.0f));
  EXPECT_EQ(m[rest.children[1]].color(0), Color(0.4f));
  expect_error(
      [] {
        materials_of("<bsdf type=\"mixturebsdf\"><string name=\"weights\" value=\"1\"/>" +
                     grey_bsdf(0.4) + grey_bsdf(0.8) + "</bsdf>");
      },
      "'mixturebsdf' has 1 weights for 2 bsdfs");
}

TEST(MitsubaSurface, masksInsideMoveOutwards) {
  const std::string mask =
      "<bsdf type=\"mask\"><float name=\"opacity\" value=\"0.5\"/>" + grey_bsdf(0.4) + "</bsdf>";
  const auto blend = materials_of(
      "<bsdf type=\"blendbsdf\"><float name=\"weight\" "
      "value=\"0.2\"/>" +
      mask + grey_bsdf(0.8) + "</bsdf>");
  EXPECT_FLOAT_EQ(blend.back().opacity.offset, 0.8f * 0.5f + 0.2f);
  EXPECT_FLOAT_EQ(blend.back().scalar(0), 0.2f / (0.8f * 0.5f + 0.2f));
  const auto half = materials_of("<bsdf type=\"mask\"><float name=\"opacity\" value=\"0.5\"/>" +
                                 mask + "</bsdf>");
  EXPECT_FLOAT_EQ(half.back().opacity.offset, 0.25f);
  const auto absent = materials_of(
      "<bsdf type=\"blendbsdf\"><float name=\"weight\" "
      "value=\"0.25\"/>" +
      grey_bsdf(0.4) + "<bsdf type=\"null\"/></bsdf>");
  ASSERT_EQ(absent.size(), 1u);
  EXPECT_EQ(absent[0].node, MaterialNode::none);
  EXPECT_FLOAT_EQ(absent[0].opacity.offset, 0.75f);
  EXPECT_TRUE(materials_of("<bsdf type=\"null\"/>").empty());
}

TEST(MitsubaTexture, checkerboardsKeepTheirSquares) {
  const SceneData scene =
      load_xml(
          "<shape type=\"rectangle\"><bsdf type=\"diffuse\"><texture type=\"checkerboard\" "
          "name=\"reflectance\"><rgb name=\"color0\" value=\"0.9\"/><rgb name=\"color1\" "
          "value=\"0.1\"/><transform name=\"to_uv\"><scale x=\"2\" y=\"1\"/></transform></texture>"
          "</bsdf></shape>")
          .scene;
  ASSERT_EQ(scene.textures.size(), 1u);
  ASSERT_EQ(scene.meshes.size(), 1u);      // with texture coordinates, not a quad
  const auto at = [&](float u, float v) {  // Mitsuba's v, from the head
    return sample_texture(scene.textures[0], scene.texels.data(), {u, 1.0f - v}).x;
  };
  EXPECT_EQ(at(0.1f, 0.2f), 0.9f);
  EXPECT_EQ(at(0.3f, 0.2f), 0.1f);
  EXPECT_EQ(at(0.1f, 0.8f), 0.1f);
  EXPECT_EQ(at(0.3f, 0.8f), 0.9f);
  EXPECT_EQ(at(0.6f, 0.2f), 0.9f);
}

TEST(MitsubaTexture, imagesBeginAtTheirHead) {
  const TempFolder folder;
  Image image{2, 2, {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}};  // red, green; blue, white
  write_image(folder.file("a.png"), image, {});
  const std::string square =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nproperty float u\nproperty float v\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "-1 -1 0 0.25 0.25\n1 -1 0 0.75 0.25\n-1 1 0 0.25 0.75\n3 0 1 2\n";
  write_text(folder.file("t.ply"), square);
  write_text(folder.file("t.obj"),
             "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt .25 .25\nvt .75 .25\n"
             "vt .25 .75\nf 1/1 2/2 3/3\n");
  const auto color_of_first = [&](const std::string& file, const std::string& map) {
    write_text(folder.file("scene.xml"),
               "<scene version=\"3.0.0\"><shape type=\"" + file.substr(2) +
                   "\"><string name=\"filename\" value=\"" + file +
                   "\"/><bsdf type=\"diffuse\"><texture type=\"bitmap\" name=\"reflectance\">"
                   "<string name=\"filename\" value=\"a.png\"/>"
                   "<string name=\"filter_type\" value=\"nearest\"/>"
                   "<string name=\"wrap_mode\" value=\"clamp\"/>" +
                   map + "</texture></bsdf></shape></scene>");
    const SceneData scene = load_mitsuba_xml(folder.file("scene.xml"));
    return sample_texture(scene.textures.at(0), scene.texels.data(), scene.meshes.at(0).uvs.at(0));
  };
  // Golden: Mitsuba flips the v of obj, not that of ply.
  EXPECT_EQ(color_of_first("t.ply", ""), Color(1, 0, 0));
  EXPECT_EQ(color_of_first("t.obj", ""), Color(0, 0, 1));
  EXPECT_EQ(color_of_first("t.ply", "<transform name=\"to_uv\"><translate x=\"0.5\"/></transform>"),
            Color(0, 1, 0));
  EXPECT_EQ(color_of_first("t.ply", "<transform name=\"to_uv\"><translate y=\"0.5\"/></transform>"),
            Color(0, 0, 1));
}

// Raw pictures hold numbers, not colours in the sRGB curve.
TEST(MitsubaTexture, rawIsLinear) {
  const TempFolder folder;
  const std::string path = folder.file("a.png");
  write_image(path, Image{1, 1, {0.2f, 0.5f, 1}}, {});  // as bytes: 124, 188, 255
  const auto color_of = [&](const std::string& inside) {
    const SceneData scene = load_xml(
                                "<shape type=\"rectangle\"><bsdf type=\"diffuse\"><texture "
                                "type=\"bitmap\" name=\"reflectance\"><string "
                                "name=\"filename\" value=\"" +
                                path + "\"/>" + inside + "</texture></bsdf></shape>")
                                .scene;
    return sample_texture(scene.textures.at(0), scene.texels.data(), {0.5f, 0.5f});
  };
  const Vec3 linear(124.0 / 255, 188.0 / 255, 1), decoded(0.2, 0.5, 1);
  expect_near(color_of(""), decoded, 4e-3f);
  expect_near(color_of("<boolean name=\"raw\" value=\"false\"/>"), decoded, 4e-3f);
  expect_near(color_of("<boolean name=\"raw\" value=\"true\"/>"), linear, 1e-6f);
  expect_near(color_of("<float name=\"gamma\" value=\"1\"/>"), linear, 1e-6f);
}

TEST(MitsubaTexture, scaleMultiplies) {
  const SceneData scene =
      load_xml(
          "<shape type=\"rectangle\"><bsdf type=\"diffuse\"><texture type=\"scale\" "
          "name=\"reflectance\"><float name=\"scale\" value=\"0.25\"/><texture "
          "type=\"checkerboard\"/>"
          "</texture></bsdf></shape>",
          "0.6.0")
          .scene;
  EXPECT_EQ(scene.materials[0].color(0), Color(0.25f));
  EXPECT_EQ(scene.materials[0].parameters[0].texture, 0u);
}

TEST(MitsubaTexture, onesWithoutAFileNameAreErrors) {
  expect_error([] { reflectance("<texture type=\"bitmap\" name=\"reflectance\"/>"); },
               "no filename");
}

TEST(MitsubaLight, deltaLights) {
  const SceneData scene =
      load_xml(
          "<emitter type=\"point\"><point name=\"position\" x=\"1\" y=\"2\" z=\"3\"/>"
          "<rgb name=\"intensity\" value=\"4 5 6\"/></emitter>"
          "<emitter type=\"spot\"><transform name=\"to_world\"><lookat origin=\"0,5,0\" "
          "target=\"0,0,0\" up=\"1,0,0\"/></transform><float name=\"cutoff_angle\" value=\"60\"/>"
          "<float name=\"beam_width\" value=\"0\"/></emitter>"
          "<emitter type=\"directional\"><vector name=\"direction\" value=\"0,-2,0\"/>"
          "<rgb name=\"irradiance\" value=\"3\"/></emitter>")
          .scene;
  ASSERT_EQ(scene.delta_lights.size(), 3u);
  EXPECT_EQ(scene.delta_lights[0].position, Vec3(1, 2, 3));
  EXPECT_EQ(scene.delta_lights[0].intensity, Color(4, 5, 6));
  EXPECT_EQ(scene.delta_lights[1].kind, LightKind::spot);
  expect_near(scene.delta_lights[1].direction, {0, -1, 0});
  EXPECT_NEAR(scene.delta_lights[1].cos_outer, 0.5f, 1e-6f);
  EXPECT_EQ(scene.delta_lights[1].cos_inner, 1.0f);
  expect_near(scene.delta_lights[2].direction, {0, -1, 0});
  EXPECT_EQ(scene.delta_lights[2].intensity, Color(3.0f));
}

TEST(MitsubaLight, skies) {
  const LoadedScene loaded = load_xml(
      "<sensor type=\"perspective\"/><emitter type=\"constant\">"
      "<rgb name=\"radiance\" value=\"1 2 3\"/></emitter>");
  expect_near(loaded.scene.sky.zenith, {1, 2, 3});
  EXPECT_EQ(loaded.scene.sky.nadir, loaded.scene.sky.zenith);
  expect_error([] { load_xml("<emitter type=\"envmap\"/>"); }, "no filename");
}

/// `to_world` turns up to +y and what was +y to -z.
const std::string daylight =
    "<vector name=\"sun_direction\" x=\"0\" y=\"0.8\" z=\"-0.6\"/>"
    "<transform name=\"to_world\"><rotate x=\"1\" angle=\"-90\"/></transform></emitter>";

// What Mitsuba 3.9.1 shows, in the map that shines: between its texels within 1 %.
TEST(MitsubaLight, sunsky) {
  const LoadedScene loaded =
      load_xml("<sensor type=\"perspective\"/><emitter type=\"sunsky\">" + daylight);
  EXPECT_EQ(loaded.warnings.size(), 0u);
  const EnvironmentData& data = loaded.scene.environment;
  const EnvironmentMap map = make_environment(data.width, data.height, data.pixels, data.to_world);
  const auto expect_sky = [&](const Vec3& direction, const Color& expected) {
    const Color found = environment_radiance(map.view(), glm::normalize(direction));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 0.01f * expected[c]);
  };
  expect_sky({0, 1, 0}, {0.02908008f, 0.04823563f, 0.0955867f});
  expect_sky({0.7f, 0.714f, 0}, {0.03221959f, 0.05856199f, 0.11576091f});
  expect_sky({0.9998f, 0.02f, 0}, {0.14153433f, 0.18154782f, 0.20749627f});
  EXPECT_TRUE(is_black(environment_radiance(map.view(), {0.9998f, -0.02f, 0})));
  const Sun& sun = loaded.scene.sun;
  expect_near(sun.direction, {0, 0.8f, -0.6f});
  EXPECT_NEAR(sun.radiance.x / 21689.34f, 1, 2e-3);
  EXPECT_NEAR(sun.radiance.z / 13663.243f, 1, 2e-3);
}

TEST(MitsubaLight, sunOrSkyAlone) {
  const LoadedScene sky =
      load_xml("<sensor type=\"perspective\"/><emitter type=\"sky\">" + daylight);
  EXPECT_EQ(sky.scene.sun.one_minus_cos, 0.0f);
  EXPECT_GT(sky.scene.environment.width, 0);
  const LoadedScene sun = load_xml(
      "<sensor type=\"perspective\"/><emitter type=\"sun\"><float name=\"sun_scale\" value=\"2\"/>"
      "<float name=\"sun_aperture\" value=\"5\"/>" +
      daylight);
  EXPECT_EQ(sun.scene.environment.width, 0);
  // Mitsuba takes 1 minus a float cosine of the real sun: 0.2 % off.
  EXPECT_NEAR(sun.scene.sun.radiance.y / (2 * 206.68303f), 1, 3e-3);
  expect_error(
      [] {
        load_xml("<emitter type=\"sunsky\"><float name=\"turbidity\" value=\"11\"/></emitter>");
      },
      "expected 1 to 10");
}

TEST(MitsubaLight, environmentBeginsBehindTheCamera) {
  const TempFolder folder;
  Image image{8, 4, std::vector<float>(3 * 8 * 4)};
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x) {
      image.pixel(x, y)[0] = static_cast<float>(x + 1);
      image.pixel(x, y)[1] = static_cast<float>(y + 1);
    }
  }
  write_image(folder.file("sky.exr"), image, {});
  write_text(folder.file("scene.xml"),
             "<scene version=\"3.0.0\"><emitter type=\"envmap\"><string name=\"filename\" "
             "value=\"sky.exr\"/><float name=\"scale\" value=\"2\"/></emitter></scene>");
  const EnvironmentData sky = load_mitsuba_xml(folder.file("scene.xml")).environment;
  ASSERT_EQ(sky.width, 8);
  const auto radiance = [&](const Vec3& world) {  // as EnvironmentData says
    const Vec3 d = inverse(sky.to_world).vector(world);
    const float u = 0.5f + std::atan2(d.x, -d.z) / (2 * pi);
    const float v = std::atan2(std::hypot(d.x, d.z), d.y) / pi;
    return sky.pixels[static_cast<std::size_t>(4 * v) * 8 + static_cast<std::size_t>(8 * u)];
  };
  // Golden: Mitsuba's eval() in the middle of the first two columns gives 1 and 2.
  const float c = std::cos(pi / 8), s = std::sin(pi / 8);
  EXPECT_EQ(radiance({s, 0.1f, -c}), Color(2, 4, 0));
  EXPECT_EQ(radiance({c, 0.1f, -s}), Color(4, 4, 0));
  EXPECT_EQ(radiance({c, -5.0f, -s}), Color(4, 8, 0));
}

TEST(MitsubaLight, areaLightsOfAGroupAreBlack) {
  const LoadedScene loaded = load_xml(
      "<sensor type=\"perspective\"/><shape type=\"shapegroup\" id=\"g\">"
      "<shape type=\"rectangle\"><emitter type=\"area\"/></shape></shape>"
      "<shape type=\"instance\"><ref id=\"g\"/></shape>");
  EXPECT_EQ(loaded.count("an emitter in a shapegroup"), 1);
  EXPECT_EQ(loaded.count("NO LIGHT"), 1);
  EXPECT_TRUE(is_black(loaded.scene.materials.at(0).emission.radiance));
}

// The scenes of shared/scenes: counts from their files.
TEST(MitsubaScenes, theWorldsLoad) {
  struct Expected {
    std::string name;
    std::size_t quads, meshes;
    int width, height, spp;
  };
  for (const Expected& e : {Expected{"cornell-box", 18, 0, 1024, 1024, 64},
                            Expected{"modern-hall", 8, 24, 1024, 1024, 64},
                            Expected{"grey-white-room", 0, 65, 1280, 720, 100}}) {
    const std::string path = shared_file("scenes/" + e.name + "/scene.xml");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    const LoadedScene loaded = load_with_warnings(path);
    EXPECT_EQ(loaded.scene.name, e.name);
    EXPECT_EQ(loaded.scene.quads.size(), e.quads);
    EXPECT_EQ(loaded.scene.meshes.size(), e.meshes);
    EXPECT_EQ(loaded.scene.defaults.width, e.width);
    EXPECT_EQ(loaded.scene.defaults.height, e.height);
    EXPECT_EQ(loaded.scene.defaults.spp, e.spp);
    EXPECT_EQ(loaded.scene.defaults.max_depth, 65);
    EXPECT_EQ(loaded.scene.media.size(), e.name == "modern-hall" ? 1u : 0u);
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
  }
}

}  // namespace
}  // namespace pt
