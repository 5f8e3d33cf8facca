// Diffuse surfaces with and without highlights, as files say them and as materials have them.
#include <gtest/gtest.h>

#include "common/scene/data/plastic_material.h"
#include "load/mitsuba_scene.h"

namespace pt {
namespace {

LoadedScene load_bsdf(const std::string& type, const std::string& inside,
                      const std::string& version = "3.0.0") {
  return load_xml("<shape type=\"rectangle\"><bsdf type=\"" + type + "\">" + inside +
                      "</bsdf></shape><sensor type=\"perspective\"/><emitter type=\"constant\"/>",
                  version);
}

std::string rgb(const std::string& name, const std::string& value) {
  return "<rgb name=\"" + name + "\" value=\"" + value + "\"/>";
}
std::string number_of(const std::string& name, const std::string& value) {
  return "<float name=\"" + name + "\" value=\"" + value + "\"/>";
}
std::string checkerboard(const std::string& name) {
  return "<texture type=\"checkerboard\" name=\"" + name + "\"/>";
}

const std::string ior = number_of("int_ior", "1.5") + number_of("ext_ior", "1");

void expect_same(const MaterialDescription& a, const MaterialDescription& b) {
  EXPECT_EQ(a.kind, b.kind);
  for (int i = 0; i < parameters_max; ++i) EXPECT_EQ(a.color(i), b.color(i)) << i;
}

TEST(MitsubaPlastic, SmoothAndRough) {
  const Color body(0.25f, 0.5f, 0.75f), coat(0.9f, 0.5f, 0.7f);
  const std::string colors = rgb("diffuse_reflectance", "0.25 0.5 0.75") +
                             rgb("specular_reflectance", "0.9 0.5 0.7") + ior;
  const LoadedScene smooth =
      load_bsdf("plastic", colors + "<boolean name=\"nonlinear\" value=\"true\"/>");
  EXPECT_TRUE(smooth.warnings.empty());
  EXPECT_TRUE(smooth.scene.materials[0].one_sided);
  expect_same(smooth.scene.materials[0], make_plastic(body, coat, {1.5f, true}));
  const LoadedScene rough = load_bsdf("roughplastic", colors + number_of("alpha", "0.3") +
                                                          "<string name=\"distribution\" "
                                                          "value=\"ggx\"/>");
  EXPECT_TRUE(rough.warnings.empty());
  expect_same(rough.scene.materials[0], make_rough_plastic(body, coat, {1.5f}, 0.3f, false));
}

// As Mitsuba 3.9.1 prints them.
TEST(MitsubaPlastic, Defaults) {
  const MaterialDescription material = load_bsdf("roughplastic", "").scene.materials[0];
  expect_same(material, make_rough_plastic(Color(0.5f), Color(1.0f),
                                           {static_cast<float>(1.49 / 1.000277)}, 0.1f, true));
}

TEST(MitsubaPlastic, TexturesOnEveryParameter) {
  const LoadedScene scene =
      load_bsdf("roughplastic", checkerboard("diffuse_reflectance") +
                                    checkerboard("specular_reflectance") + checkerboard("alpha"));
  for (int i = 0; i < 3; ++i) {
    EXPECT_NE(scene.scene.materials[0].parameters[i].texture, no_texture) << i;
  }
  EXPECT_EQ(scene.count("what the coat lets through"), 1);
}

// Beckmann's root mean square slope is sqrt(2) times the angle's standard deviation.
TEST(MitsubaRoughDiffuse, IsOrenNayar) {
  const LoadedScene scene =
      load_bsdf("roughdiffuse", rgb("reflectance", "0.3") + number_of("alpha", "0.4"), "0.6.0");
  EXPECT_TRUE(scene.warnings.empty());
  const MaterialDescription& material = scene.scene.materials[0];
  EXPECT_EQ(material.kind, kind_of<OrenNayar>);
  EXPECT_EQ(material.color(0), Color(0.3f));
  EXPECT_NEAR(material.scalar(1), 0.2828427f, 1e-6f);
  const auto textured = load_bsdf("roughdiffuse", checkerboard("alpha"), "0.6.0").scene;
  EXPECT_NE(textured.materials[0].parameters[1].texture, no_texture);
}

TEST(MitsubaPhong, OfVersion06) {
  const LoadedScene scene =
      load_bsdf("phong", rgb("diffuseReflectance", "0.3") + number_of("exponent", "50"), "0.6.0");
  EXPECT_TRUE(scene.warnings.empty());
  expect_same(scene.scene.materials[0], make_material<Phong>(0.3f, 0.2f, 50.0f));
}

TEST(MitsubaWard, OfVersion06) {
  const LoadedScene scene =
      load_bsdf("ward",
                rgb("specularReflectance", "0.4") + number_of("alphaU", "0.2") +
                    checkerboard("alphaV") + "<string name=\"variant\" value=\"ward\"/>",
                "0.6.0");
  const MaterialDescription& material = scene.scene.materials[0];
  EXPECT_EQ(material.kind, kind_of<Ward>);
  EXPECT_EQ(material.color(0), Color(0.5f));
  EXPECT_EQ(material.color(1), Color(0.4f));
  EXPECT_EQ(material.scalar(2), 0.2f);
  EXPECT_NE(material.parameters[3].texture, no_texture);
  EXPECT_EQ(scene.count("balanced is used"), 1);
}

}  // namespace
}  // namespace pt
