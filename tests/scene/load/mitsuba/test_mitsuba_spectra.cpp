// Spectra as colours. The numbers are what Mitsuba 3.9.1 (scalar_rgb) makes of the same spectra:
// traverse() of the loaded object.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "load/expect_near.h"
#include "load/mitsuba_scene.h"

namespace pt {
namespace {

std::string spectrum(const char* name, const std::string& value) {
  return fmt::format("<spectrum name='{}' value='{}'/>", name, value);
}

MaterialDescription material_with(const std::string& inside, const std::string& version) {
  const SceneData scene = load_xml("<shape type='rectangle'>" + inside + "</shape>", version).scene;
  return scene.materials.at(scene.quad_material.at(0));
}

Color reflectance(const std::string& value) {
  return material_with("<bsdf type='diffuse'>" + spectrum("reflectance", value) + "</bsdf>",
                       "3.0.0")
      .color(0);
}

Color radiance(const std::string& value, const std::string& version = "3.0.0") {
  return material_with("<emitter type='area'>" + value + "</emitter>", version).emission.radiance;
}

Color radiance_of(const std::string& value) { return radiance(spectrum("radiance", value)); }

struct Index {
  Color eta, k;
};

Index index_of(const std::string& eta, const std::string& k) {
  const MaterialDescription metal = material_with(
      "<bsdf type='conductor'>" + spectrum("eta", eta) + spectrum("k", k) + "</bsdf>", "3.0.0");
  return {metal.color(1), metal.color(2)};
}

void expect_mitsubas(const Color& ours, const Color& theirs) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(ours[c], theirs[c], 2e-5f * (1 + theirs[c])) << c;
}

const std::string two_samples = "450:0.2, 650:0.8";

TEST(MitsubaSpectrum, ReflectancesAreMitsubas) {
  // The walls of the Cornell box.
  expect_mitsubas(reflectance("400:0.04, 444:0.046, 500:0.065, 548:0.062, 576:0.14, 600:0.42, "
                              "640:0.61, 700:0.64"),
                  {0.555274f, 0.0745531f, 0.037161f});
  expect_mitsubas(reflectance("404:0.092, 450:0.11, 500:0.33, 524:0.48, 560:0.37, 600:0.17, "
                              "650:0.14, 700:0.16"),
                  {0.095208f, 0.411445f, 0.129531f});
  expect_mitsubas(reflectance("400:0.343, 500:0.74, 600:0.74, 700:0.75"),
                  {0.727362f, 0.754962f, 0.531627f});
  expect_mitsubas(reflectance("400:0.1,500:.1,600:.2,700:.2"), {0.223116f, 0.140664f, 0.0925723f});
  expect_mitsubas(reflectance(two_samples), {0.686533f, 0.49604f, 0.0954527f});
  expect_mitsubas(reflectance("360:0.7, 830:0.7"), {0.69929f, 0.699212f, 0.699161f});
  expect_mitsubas(reflectance("300:0.7, 900:0.7"), {0.69929f, 0.699212f, 0.699161f});
  expect_mitsubas(reflectance("500:1, 510:1"), {0.0f, 0.0781108f, 0.0146232f});  // out of gamut
}

TEST(MitsubaSpectrum, IndicesOfMetalsAreMitsubas) {
  const Index gold =
      index_of("400:1.66, 450:1.5, 500:0.92, 550:0.35, 600:0.24, 650:0.16, 700:0.13",
               "400:1.95, 450:1.88, 500:1.85, 550:2.69, 600:3.07, 650:3.59, 700:4.1");
  expect_mitsubas(gold.eta, {0.0614319f, 0.469747f, 1.51411f});
  expect_mitsubas(gold.k, {3.57549f, 2.46547f, 1.77598f});
  const Index two = index_of(two_samples, "400:2, 700:5");
  expect_mitsubas(two.eta, {0.686533f, 0.49604f, 0.0954527f});
  expect_mitsubas(two.k, {4.40313f, 3.42888f, 2.39794f});
}

TEST(MitsubaSpectrum, EmissionIsMitsubas) {
  expect_mitsubas(radiance_of("400:0, 500:8, 600:15.6, 700:18.4"), {20.7108f, 10.8546f, 2.77115f});
  expect_mitsubas(radiance_of("400:1, 700:2"), {2.14f, 1.40424f, 1.01714f});
  expect_mitsubas(radiance_of("400:1,500:1,600:2,700:2"), {2.60267f, 1.34425f, 0.831981f});
  expect_mitsubas(radiance_of("360:2, 830:2"), {2.40977f, 1.89646f, 1.81853f});
}

TEST(MitsubaSpectrum, OneNumberIsGreyButForEmissionToday) {
  EXPECT_EQ(reflectance("0.5"), Color(0.5f));
  expect_near(radiance_of("2"), {2.40959f, 1.89658f, 1.81783f}, 1e-4f);
  EXPECT_EQ(radiance(spectrum("radiance", "2"), "0.6.0"), Color(2.0f));
  EXPECT_EQ(radiance("<float name='radiance' value='2'/>"), Color(2.0f));
}

TEST(MitsubaSpectrum, BlackBodiesAreReddish) {
  const Color warm = radiance("<blackbody name='radiance' temperature='2700K'/>", "0.6.0");
  EXPECT_GT(warm.x, warm.y);
  EXPECT_GT(warm.y, warm.z);
}

TEST(MitsubaSpectrum, WavelengthsMustAscend) {
  expect_error([] { reflectance("500:1,400:1"); }, "ascending");
}

}  // namespace
}  // namespace pt
