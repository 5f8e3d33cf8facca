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

/// A spectrum as a plugin, in the two ways of writing one.
std::string plugin(const char* tag, const char* type, const char* name, const std::string& inside) {
  return fmt::format("<{0} type='{1}' name='{2}'>{3}</{0}>", tag, type, name, inside);
}

std::string string_of(const char* name, const char* value) {
  return fmt::format("<string name='{}' value='{}'/>", name, value);
}

struct PluginRow {
  const char* type;
  std::string inside;
  Color reflectance, radiance;
};

// Golden, but for the sampled ones and blackbody, which Mitsuba's RGB variants lack: those are
// what the same samples are as a <spectrum value>.
std::vector<PluginRow> plugin_rows() {
  const std::string wavelengths = string_of("wavelengths", "450, 650");
  const std::string two = string_of("values", "0.2, 0.8");
  const std::string range = number("wavelength_min", 400) + number("wavelength_max", 700);
  const std::string one_two = string_of("values", "1, 2");
  const Color rising(0.686533f, 0.49604f, 0.0954527f);
  const Color bright(2.14f, 1.40424f, 1.01714f);
  const Color all(-1.0f);  // not looked at
  const Color rgb(0.2f, 0.5f, 0.7f);
  return {
      {"d65", number("scale", 0.4), Color(0.4f), Color(0.4f)},
      {"d65", "", Color(1.0f), Color(1.0f)},
      {"d65",
       "<rgb name='color' value='.2 .3 .4'/>" + number("scale", 0.5),
       {0.1f, 0.15f, 0.2f},
       {0.1f, 0.15f, 0.2f}},
      {"d65",
       "<vector name='color' x='.2' y='.3' z='.4'/>",
       {0.2f, 0.3f, 0.4f},
       {0.2f, 0.3f, 0.4f}},
      {"d65",
       number("scale", 0.5) + "<texture type='uniform'>" + number("value", 0.3) + "</texture>",
       Color(0.3f), Color(0.3f)},
      {"d65", "<spectrum type='uniform'>" + number("value", 0.3) + "</spectrum>", Color(0.3f),
       Color(0.3f)},
      {"uniform", number("value", 0.4), Color(0.4f), Color(0.4f)},
      {"uniform", "<integer name='value' value='1'/>", Color(1.0f), Color(1.0f)},
      {"uniform", number("value", 0.4) + number("wavelength_min", 500), Color(0.4f), Color(0.4f)},
      {"srgb", "<rgb name='color' value='.2 .5 .7'/>", rgb, rgb},
      {"srgb", "<vector name='color' x='.2' y='.5' z='.7'/>", rgb, rgb},
      {"srgb",
       "<rgb name='color' value='2 .5 .7'/><boolean name='unbounded' value='true'/>",
       {1.0f, 0.5f, 0.7f},
       {2.0f, 0.5f, 0.7f}},
      {"rgb", "<rgb name='value' value='.2 .5 .7'/>", rgb, rgb},
      {"rawconstant", number("value", 0.4), Color(0.4f), Color(0.4f)},
      {"rawconstant", "<vector name='value' value='.2 .5 .7'/>", rgb, rgb},
      {"irregular", wavelengths + two, rising, all},
      {"irregular", string_of("wavelengths", "400 700") + one_two, all, bright},
      {"irregular", "<spectrum name='value' value='450:0.2, 650:0.8'/>", rising, all},
      {"regular", range + one_two, all, bright},
      {"regular", string_of("range", "400, 700") + one_two, all, bright},
      {"regular", number("lambda_min", 400) + number("lambda_max", 700) + one_two, all, bright},
      {"regular", "<spectrum name='value' value='400:1, 700:2'/>", all, bright},
      {"regular", string_of("values", "0.7, 0.7, 0.7"), {0.69929f, 0.699212f, 0.699161f}, all},
      {"spectrum", "<spectrum name='value' value='450:0.2, 650:0.8'/>", rising, all},
  };
}

TEST(MitsubaSpectrum, PluginsAreReadAsSpectraAndAsTextures) {
  for (const PluginRow& row : plugin_rows()) {
    for (const char* tag : {"spectrum", "texture"}) {
      SCOPED_TRACE(fmt::format("{} {} {}", tag, row.type, row.inside));
      const std::string bsdf =
          "<bsdf type='diffuse'>" + plugin(tag, row.type, "reflectance", row.inside) + "</bsdf>";
      const MaterialDescription material = material_with(bsdf, "3.0.0");
      if (row.reflectance.x >= 0) expect_mitsubas(material.color(0), row.reflectance);
      EXPECT_FALSE(material.is_textured());
      if (row.radiance.x >= 0) {
        expect_mitsubas(radiance(plugin(tag, row.type, "radiance", row.inside)), row.radiance);
      }
    }
  }
}

// In every parameter that has a colour or a number.
TEST(MitsubaSpectrum, PluginsStandWhereColoursAndNumbersDo) {
  const auto half = [](const char* name) {
    return plugin("texture", "uniform", name, number("value", 0.5));
  };
  const auto rgb = [](const char* name) {
    return plugin("texture", "srgb", name, "<rgb name='color' value='.1 .2 .6'/>");
  };
  const auto bsdf = [](const std::string& type, const std::string& inside) {
    return load_xml("<shape type='rectangle'><bsdf type='" + type + "'>" + inside +
                    "</bsdf></shape>")
        .scene.materials.back();
  };
  EXPECT_EQ(bsdf("principled", half("roughness")).scalar(1), 0.5f);
  EXPECT_EQ(bsdf("principled", half("metallic")).scalar(2), 0.5f);
  EXPECT_EQ(bsdf("principledthin", half("diff_trans")).scalar(9), 0.5f);
  EXPECT_EQ(bsdf("roughconductor", half("alpha")).scalar(3), 0.5f);
  EXPECT_FLOAT_EQ(bsdf("roughconductor", rgb("alpha")).scalar(4), 0.3f) << "the mean";
  EXPECT_EQ(bsdf("roughdielectric", half("alpha_v")).scalar(4), 0.5f);
  EXPECT_EQ(bsdf("conductor", half("eta")).color(1), Color(0.5f));
  EXPECT_EQ(bsdf("conductor", half("eta")).color(2), Color(1.0f));
  EXPECT_EQ(bsdf("conductor", rgb("k")).color(2), Color(0.1f, 0.2f, 0.6f));
  EXPECT_EQ(bsdf("conductor", rgb("k")).color(1), Color(0.0f)) << "k alone is k and eta 0";
  EXPECT_EQ(bsdf("conductor", half("specular_reflectance")).color(0), Color(0.5f));
  EXPECT_EQ(bsdf("plastic", rgb("specular_reflectance")).color(1), Color(0.1f, 0.2f, 0.6f));
  const std::string diffuse = "<bsdf type='diffuse'/>";
  EXPECT_EQ(bsdf("mask", half("opacity") + diffuse).opacity.offset, 0.5f);
  EXPECT_FLOAT_EQ(bsdf("mask", rgb("opacity") + diffuse).opacity.offset, 0.3f)
      << "golden: the mean";
  EXPECT_FLOAT_EQ(bsdf("blendbsdf", rgb("weight") + diffuse + diffuse).scalar(0), 0.3f);

  const SceneData lights =
      load_xml("<emitter type='point'>" + rgb("intensity") + "</emitter><emitter type='spot'>" +
               rgb("intensity") + "</emitter><emitter type='directional'>" + rgb("irradiance") +
               "</emitter><emitter type='projector'>" + rgb("irradiance") + "</emitter>" +
               "<emitter type='constant'>" + rgb("radiance") + "</emitter>")
          .scene;
  ASSERT_EQ(lights.delta_lights.size(), 4u);
  for (int i = 0; i < 4; ++i) {
    const float factor = i == 3 ? pi : 1.0f;
    expect_near(lights.delta_lights[static_cast<std::size_t>(i)].intensity / factor,
                {0.1f, 0.2f, 0.6f}, 1e-6f);
  }
  EXPECT_EQ(lights.sky.zenith, Color(0.1f, 0.2f, 0.6f));

  const auto medium = [&](const std::string& inside) {
    return load_xml(
               "<shape type='sphere'><bsdf type='null'/><medium type='homogeneous' "
               "name='interior'>" +
               inside + "</medium></shape>")
        .scene.media.at(0);
  };
  EXPECT_EQ(medium(rgb("albedo")).albedo, Color(0.1f, 0.2f, 0.6f));
  EXPECT_EQ(medium(half("sigma_t")).extinction, Color(0.5f));
  const std::string within =
      "<volume type='constvolume' name='albedo'>" + rgb("value") + "</volume>";
  EXPECT_EQ(medium(within).albedo, Color(0.1f, 0.2f, 0.6f));
}

TEST(MitsubaSpectrum, ADaylightWithinWhichAPictureLiesIsThePicture) {
  const LoadedScene loaded = load_xml(
      "<sensor type='perspective'/><shape type='rectangle'><emitter type='area'><texture "
      "type='d65' "
      "name='radiance'><float name='scale' value='3'/><texture "
      "type='checkerboard'/></texture></emitter></shape>");
  EXPECT_TRUE(loaded.warnings.empty());
  EXPECT_EQ(loaded.scene.materials.at(0).emission.radiance, Color(1.0f));
  EXPECT_EQ(loaded.scene.textures.at(0).kind, TextureKind::checkerboard);
}

// CIE 1931: the light of a black body is yellowish, white and bluish; its colour is that of the
// spectrum in steps of 1 nm.
TEST(MitsubaSpectrum, BlackBodiesAsPlugins) {
  for (const double kelvin : {2700.0, 4500.0, 9000.0}) {
    const Color whole =
        radiance(fmt::format("<blackbody name='radiance' temperature='{}'/>", kelvin));
    const std::string temperature = number("temperature", kelvin);
    for (const char* tag : {"spectrum", "texture"}) {
      EXPECT_EQ(radiance(plugin(tag, "blackbody", "radiance", temperature)), whole);
      const std::string scaled = temperature + number("scale", 0.25);
      expect_mitsubas(radiance(plugin(tag, "blackbody", "radiance", scaled)), 0.25f * whole);
    }
    const Color blue = radiance(
        plugin("spectrum", "blackbody", "radiance", temperature + number("wavelength_max", 480)));
    const Color rest = radiance(
        plugin("spectrum", "blackbody", "radiance", temperature + number("wavelength_min", 480)));
    EXPECT_GT(blue.z, 0.3f * whole.z);
    EXPECT_EQ(blue.x < whole.x, true);
    EXPECT_LT(rest.z, 0.7f * whole.z);
  }
}

TEST(MitsubaSpectrum, BadPluginsAreErrors) {
  const auto fails = [](const char* type, const std::string& inside, const std::string& part) {
    expect_error([&] { radiance(plugin("texture", type, "radiance", inside)); }, part);
  };
  fails("irregular", string_of("wavelengths", "400 500 600") + string_of("values", "1 2"),
        "3 wavelengths and 2 values");
  fails("irregular", string_of("wavelengths", "500 400") + string_of("values", "1 2"), "ascending");
  fails("irregular", "", "two values or more");
  fails("regular", string_of("values", "1"), "two values or more");
  fails("uniform", string_of("value", "1 x"), "expected a colour");
}

TEST(MitsubaSpectrum, WhatIsBelowZeroIsZero) {
  const LoadedScene loaded = load_xml(
      "<emitter type='constant'><rgb name='radiance' value='-1 1 2'/></emitter>"
      "<shape type='rectangle'><bsdf type='diffuse'><float name='reflectance' value='-1'/></bsdf>"
      "</shape>");
  EXPECT_EQ(loaded.scene.sky.zenith, Color(0, 1, 2));
  EXPECT_EQ(loaded.scene.materials.at(0).color(0), Color(0.0f));
  EXPECT_EQ(loaded.count("a negative component of a colour: 0 is used"), 1);
}

}  // namespace
}  // namespace pt
