// pbrt's materials and textures, against Mitsuba's of the same meaning and against white furnaces.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/scene/prepare/prepare_scene.h"
#include "common/texture/sample_texture.h"
#include "load/expect_near.h"
#include "load/pbrt_scene.h"
#include "render_serial.h"

namespace pt {
namespace {

SceneData with_material(const std::string& material) {
  return load_pbrt_silently(pbrt_world(lit + material + "\nShape \"sphere\""));
}

MaterialDescription pbrt_material(const std::string& material) {
  return with_material(material).materials.back();
}

MaterialDescription mitsuba_material(const std::string& bsdf) {
  return load_xml("<emitter type='constant'/><shape type='sphere'>" + bsdf + "</shape>")
      .scene.materials.back();
}

void expect_same(const MaterialDescription& a, const MaterialDescription& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.node, b.node);
  for (int i = 0; i < parameters_max; ++i) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(a.parameters[i].value[c], b.parameters[i].value[c], 1e-5f) << "parameter " << i;
    }
  }
}

TEST(PbrtSurfaces, AreThoseOfMitsuba) {
  expect_same(
      pbrt_material("Material \"diffuse\" \"rgb reflectance\" [.1 .2 .3]"),
      mitsuba_material("<bsdf type='diffuse'><rgb name='reflectance' value='.1 .2 .3'/></bsdf>"));
  expect_same(pbrt_material("Material \"dielectric\" \"float eta\" 1.4"),
              mitsuba_material("<bsdf type='dielectric'><float name='int_ior' value='1.4'/>"
                               "<float name='ext_ior' value='1'/></bsdf>"));
  // Roughness is remapped to its root.
  expect_same(
      pbrt_material("Material \"dielectric\" \"float roughness\" .04"),
      mitsuba_material("<bsdf type='roughdielectric'><string name='distribution' value='ggx'/>"
                       "<float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/>"
                       "<float name='alpha' value='.2'/></bsdf>"));
  expect_same(pbrt_material("Material \"thindielectric\""),
              mitsuba_material("<bsdf type='thindielectric'><float name='int_ior' value='1.5'/>"
                               "<float name='ext_ior' value='1'/></bsdf>"));
  expect_same(pbrt_material("Material \"conductor\" \"rgb eta\" [.2 .4 1.4] \"rgb k\" [4 2 1] "
                            "\"float uroughness\" .1 \"float vroughness\" .2 "
                            "\"bool remaproughness\" false"),
              mitsuba_material("<bsdf type='roughconductor'><rgb name='eta' value='.2 .4 1.4'/>"
                               "<rgb name='k' value='4 2 1'/>"
                               "<string name='distribution' value='ggx'/><float name='alpha_u' "
                               "value='.1'/><float name='alpha_v' value='.2'/></bsdf>"));
  const std::string plastic =
      "<rgb name='diffuse_reflectance' value='.1 .2 .3'/><boolean name='nonlinear' value='true'/>"
      "<float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
  expect_same(
      pbrt_material(
          "Material \"coateddiffuse\" \"rgb reflectance\" [.1 .2 .3] \"float thickness\" 0"),
      mitsuba_material("<bsdf type='plastic'>" + plastic));
  expect_same(pbrt_material("Material \"coateddiffuse\" \"rgb reflectance\" [.1 .2 .3] "
                            "\"float roughness\" .09 \"float thickness\" 0"),
              mitsuba_material("<bsdf type='roughplastic'><string name='distribution' value='ggx'/>"
                               "<float name='alpha' value='.3'/>" +
                               plastic));
}

TEST(PbrtSurfaces, AMetalMayBeGivenByWhatItReflects) {
  const MaterialDescription m =
      pbrt_material("Material \"conductor\" \"rgb reflectance\" [.2 .5 .9]");
  const Color reflected = fresnel_conductor(1.0f, m[&Conductor::eta].value, m[&Conductor::k].value);
  expect_near(reflected, {0.2f, 0.5f, 0.9f});
}

TEST(PbrtSurfaces, NamedMetalsReflectAsTheirSpectraDo) {
  const auto reflected = [](const std::string& metal) {
    const MaterialDescription m = pbrt_material("Material \"conductor\" " + metal);
    return fresnel_conductor(1.0f, m[&Conductor::eta].value, m[&Conductor::k].value);
  };
  // Fresnel's reflectance by wavelength, of pbrt's data, in daylight to sRGB.
  const Color copper(0.954f, 0.637f, 0.537f), silver(0.971f, 0.959f, 0.914f);
  expect_near(reflected(""), copper, 0.02f);
  expect_near(reflected("\"spectrum eta\" \"metal-Ag-eta\" \"spectrum k\" \"metal-Ag-k\""), silver,
              0.005f);
}

/// The mean radiance of an image that a sphere around the camera, or what is before it, fills, in
/// a white world.
Color furnace(const std::string& material, const std::string& shape) {
  const std::string text = pbrt_world(lit + material + "\n" + shape);
  SceneData scene = load_pbrt_text(text).scene;
  Options options = image_options(16, 16, 256, 20);
  options.filter = FilterChoice();
  prepare_scene(scene, options);
  const Image image = render(scene, options).image;
  Color sum(0.0f);
  for (std::size_t i = 0; i < image.rgb.size(); ++i) sum[static_cast<int>(i % 3)] += image.rgb[i];
  return sum / 256.0f;
}

TEST(PbrtSurfaces, DiffuseTransmissionSharesTheLight) {
  const std::string material =
      "Material \"diffusetransmission\" \"rgb reflectance\" [.1 .4 0] \"rgb transmittance\" "
      "[.5 .2 .3] \"float scale\" 1.25";
  // In the same light from both sides.
  expect_near(furnace(material, facing_wall), {0.75f, 0.75f, 0.375f}, 0.02f);
  // What reflects only: a black world behind it makes no difference.
  expect_near(
      furnace("Material \"diffusetransmission\" \"rgb transmittance\" [0 0 0]", facing_wall),
      Color(0.25f), 1e-3f);
}

TEST(PbrtSurfaces, ACoatedMirrorKeepsItsEnergy) {
  // A perfect metal below a clear coat reflects everything.
  const std::string metal =
      "Material \"coatedconductor\" \"rgb reflectance\" [1 1 1] \"float thickness\" 0";
  expect_near(furnace(metal, facing_wall), Color(1.0f), 0.01f);
}

TEST(PbrtSurfaces, MixTakesTheSecondByItsAmount) {
  const std::string named =
      "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [1 0 0]\n"
      "MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"rgb reflectance\" [0 0 1]\n";
  expect_near(
      furnace(named + "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .25",
              facing_wall),
      {0.75f, 0, 0.25f}, 0.01f);
}

TEST(PbrtSurfaces, AnInterfaceIsNotThere) {
  const LoadedScene loaded =
      load_pbrt_text(pbrt_world(lit + "Material \"interface\" Shape \"sphere\" Shape \"disk\""));
  EXPECT_TRUE(loaded.scene.spheres.empty());
  EXPECT_TRUE(loaded.scene.meshes.empty());
  EXPECT_EQ(loaded.count("a shape that light passes"), 1);
}

TEST(PbrtSurfaces, EqualMaterialsAreOne) {
  const SceneData scene = load_pbrt_silently(pbrt_world(
      lit +
      "Material \"diffuse\" Shape \"sphere\" Shape \"disk\" Material \"diffuse\" Shape \"disk\""));
  EXPECT_EQ(scene.materials.size(), 1u);
}

// ---- textures

struct TexturedScene {
  SceneData scene;

  Color at(float u, float v) const {
    const Parameter& p = scene.materials.back().parameters[0];
    if (p.texture == no_texture) return p.value;
    return p.value * sample_texture(scene.textures.data(), p.texture, scene.texels.data(), {u, v});
  }
};

/// Two texels in a row and two rows, as an sRGB picture: black, white over red, green.
TexturedScene textured(const std::string& textures) {
  const TempFolder folder;
  std::string bytes = "P6 2 2 255\n";
  for (const int b : {0, 0, 0, 255, 255, 255, 255, 0, 0, 0, 255, 0}) bytes += static_cast<char>(b);
  write_text(folder.file("a.ppm"), bytes);
  write_text(folder.file("scene.pbrt"),
             pbrt_world(lit + textures +
                        "Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\""));
  const LoadedScene loaded = load_pbrt_file(folder.file("scene.pbrt"));
  EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
  return {loaded.scene};
}

std::string image_map(const std::string& more = {}, const char* name = "t") {
  return fmt::format(
      "Texture \"{}\" \"spectrum\" \"imagemap\" \"string filename\" \"a.ppm\" "
      "\"string filter\" \"point\" {}\n",
      name, more);
}

TEST(PbrtTextures, ImagesStandOnTheirFoot) {
  const TexturedScene scene = textured(image_map());
  expect_near(scene.at(0.25f, 0.25f), {1, 0, 0});
  expect_near(scene.at(0.75f, 0.25f), {0, 1, 0});
  expect_near(scene.at(0.75f, 0.75f), {1, 1, 1});
}

TEST(PbrtTextures, MappingScaleAndInversion) {
  const TexturedScene moved = textured(image_map("\"float uscale\" 2 \"float udelta\" .5"));
  expect_near(moved.at(0.125f, 0.25f), {0, 1, 0});
  expect_near(textured(image_map("\"float scale\" .25")).at(0.25f, 0.25f), {0.25f, 0, 0});
  // One minus what is scaled, not below 0.
  expect_near(textured(image_map("\"float scale\" .25 \"bool invert\" true")).at(0.25f, 0.25f),
              {0.75f, 1, 1});
  const TexturedScene clamped = textured(image_map("\"string wrap\" \"clamp\""));
  expect_near(clamped.at(7.25f, 0.25f), {0, 1, 0});
}

TEST(PbrtTextures, CheckerboardsHaveSquaresOfOne) {
  const TexturedScene scene = textured(
      "Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 2 \"float vscale\" 3 \"rgb "
      "tex1\" "
      "[1 0 0] \"rgb tex2\" [0 1 0]\n");
  expect_near(scene.at(0.25f, 0.1f), {1, 0, 0});
  expect_near(scene.at(0.75f, 0.1f), {0, 1, 0});
  expect_near(scene.at(0.25f, 0.5f), {0, 1, 0});
  expect_near(scene.at(0.75f, 0.5f), {1, 0, 0});
}

TEST(PbrtTextures, ScaleAndMixOfTextures) {
  const std::string two = image_map("", "a") + image_map("\"float udelta\" .5", "b");
  const TexturedScene product = textured(two +
                                         "Texture \"f\" \"float\" \"imagemap\" \"string "
                                         "filename\" \"a.ppm\" \"string filter\" \"point\"\n"
                                         "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" "
                                         "\"a\" \"texture scale\" \"f\"\n");
  // A float is the mean of its picture's colours.
  expect_near(product.at(0.25f, 0.25f), {1 / 3.0f, 0, 0});
  expect_near(product.at(0.75f, 0.75f), {1, 1, 1});
  const TexturedScene mixed = textured(two +
                                       "Texture \"t\" \"spectrum\" \"mix\" \"texture tex1\" "
                                       "\"a\" \"texture tex2\" \"b\" \"float amount\" .25\n");
  expect_near(mixed.at(0.25f, 0.25f), {0.75f, 0.25f, 0});
  const TexturedScene plain = textured(
      "Texture \"t\" \"spectrum\" \"mix\" \"rgb tex1\" [1 0 0] "
      "\"rgb tex2\" [0 1 0] \"float amount\" .25\n");
  expect_near(plain.at(0.25f, 0.25f), {0.75f, 0.25f, 0});
}

TEST(PbrtTextures, ANumberIsTheAlphaOfAPictureThatHasOne) {
  const TempFolder folder;
  // TGA, 2 x 1 pixels of B G R A: white and transparent, grey and half so.
  const auto write = [&](int first, int second) {
    std::string bytes("\0\0\2\0\0\0\0\0\0\0\0\0\2\0\1\0\40\10", 18);
    for (const int b : {255, 255, 255, first, 128, 128, 128, second}) bytes += static_cast<char>(b);
    write_text(folder.file("a.tga"), bytes);
  };
  const auto opacity = [&](float u) {
    write_text(folder.file("scene.pbrt"),
               pbrt_world(lit + "Texture \"a\" \"float\" \"imagemap\" \"string filename\" "
                                "\"a.tga\" \"string filter\" \"point\" Shape \"disk\" \"texture "
                                "alpha\" \"a\""));
    const SceneData scene = load_pbrt_file(folder.file("scene.pbrt")).scene;
    const auto& o = scene.materials[scene.meshes.at(0).material].opacity;
    EXPECT_EQ(o.cutoff, 0.0f);
    return sample_texture(scene.textures.data(), o.texture, scene.texels.data(), {u, 0.5f}).x;
  };
  write(0, 51);
  EXPECT_NEAR(opacity(0.25f), 0.0f, 1e-5f);
  EXPECT_NEAR(opacity(0.75f), 0.2f, 1e-5f);
  write(255, 255);
  EXPECT_NEAR(opacity(0.25f), 1.0f, 1e-5f);
  EXPECT_NEAR(opacity(0.75f), 0.2159f, 1e-3f);  // of sRGB
}

TEST(PbrtTextures, DisplacementOfAMaterialIsABumpMap) {
  const TexturedScene scene = textured(
      "Texture \"h\" \"float\" \"imagemap\" \"string filename\" \"a.ppm\" \"float scale\" .25\n"
      "Material \"diffuse\" \"texture displacement\" \"h\" Shape \"disk\"\n" +
      image_map() + "Material \"diffuse\" \"string normalmap\" \"a.ppm\" Shape \"disk\"\n");
  ASSERT_EQ(scene.scene.meshes.size(), 2u);
  const auto material = [&](std::size_t mesh) {
    return scene.scene.materials[scene.scene.meshes[mesh].material];
  };
  EXPECT_EQ(material(0).node, MaterialNode::bump_map);
  expect_near(material(0).parameters[0].value, {0.25f, 1, 1});
  EXPECT_EQ(material(1).node, MaterialNode::normal_map);
  EXPECT_EQ(scene.scene.materials[material(1).children[0]].kind, kind_of<Diffuse>);
}

TEST(PbrtTextures, OneThatRefersToItselfIsLeftOut) {
  EXPECT_NE(pbrt_complaint(pbrt_world("Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"t\"\n"
                                      "Material \"diffuse\" \"texture reflectance\" \"t\" Shape "
                                      "\"sphere\""))
                .find("refers to itself"),
            std::string::npos);
}

}  // namespace
}  // namespace pt
