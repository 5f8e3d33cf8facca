// Files of pbrt-v3 and before, against that version's formulas.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/scene/data/plastic_material.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/texture/sample_texture.h"
#include "load/expect_near.h"
#include "load/pbrt_scene.h"
#include "render_serial.h"

namespace pt {
namespace {

MaterialDescription earlier_material(const std::string& material) {
  return load_pbrt_text(pbrt_world(lit + "Material " + material + " Shape \"sphere\""))
      .scene.materials.back();
}

/// What a wall reflects and lets pass along its normal, in a white world.
Color earlier_furnace(const std::string& material, const std::string& before = {}) {
  SceneData scene = load_pbrt_text(
                        "Film \"image\" \"integer xresolution\" 16 \"integer yresolution\" 16 "
                        "PixelFilter \"box\" Camera \"perspective\" \"float fov\" 1 WorldBegin\n" +
                        lit + before + "Material " + material + "\n" + facing_wall + "WorldEnd")
                        .scene;
  Options options = image_options(16, 16, 256, 20);
  options.filter = FilterChoice();
  prepare_scene(scene, options);
  const Image image = render(scene, options).image;
  Color sum(0.0f);
  for (std::size_t i = 0; i < image.rgb.size(); ++i) sum[static_cast<int>(i % 3)] += image.rgb[i];
  return sum / 256.0f;
}

TEST(PbrtEarlier, FilesSaySoOnce) {
  const char* texts[] = {
      "Material \"matte\" Shape \"sphere\" Material \"plastic\" Shape \"sphere\"",
      "Texture \"t\" \"color\" \"constant\" Shape \"sphere\"",
      "AttributeBegin AreaLightSource \"area\" Shape \"disk\" AttributeEnd",
      "MakeNamedMaterial \"m\" \"string type\" \"uber\" NamedMaterial \"m\" Shape \"sphere\"",
      "LightSource \"point\" \"blackbody I\" [3000 2] Shape \"sphere\"",
      "LightSource \"point\" \"color I\" [1 1 1] Shape \"sphere\"",
  };
  for (const char* text : texts) {
    const LoadedScene loaded = load_pbrt_text(pbrt_world(lit + text));
    EXPECT_EQ(loaded.count("pbrt --upgrade"), 1) << text;
    EXPECT_EQ(loaded.warnings.size(), 1u) << text;
  }
  LoadOptions strict;
  strict.strict = true;
  EXPECT_EQ(pbrt_error(pbrt_world(lit + texts[0]), strict), "");
  EXPECT_EQ(load_pbrt_text("Film \"image\" SurfaceIntegrator \"path\" WorldBegin " + lit +
                           "Shape \"sphere\"")
                .count("pbrt --upgrade"),
            1);
}

TEST(PbrtEarlier, SurfacesAreSumsOfLobes) {
  expect_near(earlier_furnace("\"matte\" \"rgb Kd\" [.2 .4 .6]"), {0.2f, 0.4f, 0.6f}, 1e-3f);
  EXPECT_EQ(earlier_material("\"matte\"").parameters[0].value, Color(0.5f));
  // Lambert's Kd, and of Ks Fresnel's share, 0.04 along the normal.
  expect_near(earlier_furnace("\"plastic\" \"rgb Kd\" [.2 .4 .6] \"rgb Ks\" [0 0 0]"),
              {0.2f, 0.4f, 0.6f}, 1e-3f);
  expect_near(
      earlier_furnace("\"plastic\" \"rgb Kd\" [0 0 0] \"rgb Ks\" [1 1 1] \"float roughness\" .001 "
                      "\"bool remaproughness\" false"),
      Color(0.04f), 5e-3f);
  expect_near(earlier_furnace(
                  "\"plastic\" \"rgb Kd\" [.5 .5 .5] \"rgb Ks\" [1 1 1] \"float roughness\" .001 "
                  "\"bool remaproughness\" false"),
              Color(0.54f), 0.02f);
  expect_near(earlier_furnace("\"plastic\""), Color(0.26f), 0.01f);
  expect_near(earlier_furnace("\"mirror\""), Color(0.9f), 1e-3f);
  expect_near(earlier_furnace("\"mirror\" \"rgb Kr\" [.1 .2 .3]"), {0.1f, 0.2f, 0.3f}, 1e-3f);
  // What is reflected at the first side is tinted by Kr, what passes by Kt: through one surface,
  // radiance is that in glass over the square of its index.
  expect_near(earlier_furnace("\"glass\" \"rgb Kr\" [0 0 0] \"rgb Kt\" [.5 .5 .5]"),
              Color(0.48f / 2.25f), 0.02f);
  expect_near(earlier_furnace("\"glass\" \"rgb Kr\" [1 1 1] \"rgb Kt\" [0 0 0]"), Color(0.04f),
              5e-3f);
  expect_near(
      earlier_furnace(
          "\"uber\" \"rgb Kd\" [.4 .4 .4] \"rgb Ks\" [0 0 0] \"rgb opacity\" [.25 .25 .25]"),
      Color(0.1f + 0.75f), 0.01f);
  expect_near(
      earlier_furnace("\"uber\" \"rgb Kd\" [.4 .4 .4] \"rgb Ks\" [0 0 0] \"rgb Kr\" [1 1 1]"),
      Color(0.44f), 0.02f);
  expect_near(earlier_furnace("\"uber\" \"rgb Kd\" [0 0 0] \"rgb Ks\" [0 0 0] \"rgb Kt\" [1 1 1]"),
              Color(0.96f / 2.25f), 0.02f);
  expect_near(
      earlier_furnace(
          "\"translucent\" \"rgb Kd\" [1 1 1] \"rgb Ks\" [0 0 0] \"rgb reflect\" [.3 .3 .3] "
          "\"rgb transmit\" [.5 .4 .5]"),
      {0.8f, 0.7f, 0.8f}, 0.02f);
  expect_near(earlier_furnace("\"translucent\""), Color(0.25f + 0.125f * (0.05f + 0.95f / 2.25f)),
              0.01f);
  // Kd (1 - Ks) 28/23 (1 - 1/32) and Ks along the normal, in FresnelBlend.
  expect_near(earlier_furnace("\"substrate\" \"rgb Kd\" [.5 .5 .5] \"rgb Ks\" [.04 .04 .04]"),
              Color(0.505f), 0.03f);
}

TEST(PbrtEarlier, UnitsAndDefaultsOfMaterials) {
  const MaterialDescription metal = earlier_material("\"metal\"");
  EXPECT_EQ(metal.kind, kind_of<Conductor>);
  // RoughnessToAlpha of 0.01: 1.62142 - 3.77604 + 3.67736 - 1.67206 + 0.28818.
  EXPECT_NEAR(metal[&Conductor::alpha_x].value.x, 0.13886f, 2e-4f);
  EXPECT_NEAR(
      earlier_material(
          "\"metal\" \"float roughness\" .2 \"bool remaproughness\" false")[&Conductor::alpha_x]
          .value.x,
      0.2f, 1e-6f);
  EXPECT_EQ(earlier_material("\"glass\"").kind, kind_of<Dielectric>);
  EXPECT_EQ(earlier_material("\"glass\"").parameters[1].value.x, 1.5f);
  EXPECT_EQ(earlier_material("\"glass\" \"float index\" 1.3").parameters[1].value.x, 1.3f);
  EXPECT_EQ(earlier_material("\"glass\" \"float eta\" 1.3").parameters[1].value.x, 1.3f);
  EXPECT_EQ(earlier_material("\"glass\" \"float uroughness\" .1").kind, kind_of<RoughDielectric>);
  // The spectra of metals that come with pbrt-v3.
  const LoadedScene gold = load_pbrt_text(
      pbrt_world(lit + "Material \"metal\" \"spectrum eta\" \"spds/Au.eta.spd\" \"spectrum k\" "
                       "\"spds/Au.k.spd\" Shape \"sphere\""));
  EXPECT_EQ(gold.warnings.size(), 1u);
  const MaterialDescription named = earlier_material(
      "\"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\"");
  for (const int i : {index_of(&Conductor::eta), index_of(&Conductor::k)}) {
    expect_near(gold.scene.materials.back().parameters[i].value, named.parameters[i].value);
  }
  const MaterialDescription disney = earlier_material(
      "\"disney\" \"rgb color\" [.1 .2 .3] \"float metallic\" .4 \"float roughness\" .6 \"float "
      "speculartint\" .7 \"float clearcoat\" .8 \"float clearcoatgloss\" .9");
  EXPECT_EQ(disney.kind, kind_of<Principled>);
  expect_near(disney[&Principled::base_color].value, {0.1f, 0.2f, 0.3f});
  EXPECT_EQ(disney[&Principled::metallic].value.x, 0.4f);
  EXPECT_EQ(disney[&Principled::roughness].value.x, 0.6f);
  EXPECT_EQ(disney[&Principled::spec_tint].value.x, 0.7f);
  EXPECT_EQ(disney[&Principled::clearcoat].value.x, 0.8f);
  EXPECT_EQ(disney[&Principled::clearcoat_gloss].value.x, 0.9f);
  EXPECT_EQ(disney[&Principled::sheen_tint].value.x, 0.5f);
  EXPECT_EQ(disney[&Principled::eta].value.x, 1.5f);
  EXPECT_EQ(earlier_material("\"disney\" \"bool thin\" true").kind, kind_of<PrincipledThin>);
}

TEST(PbrtEarlier, MixesCountTheFirst) {
  const std::string two =
      "MakeNamedMaterial \"a\" \"string type\" \"matte\" \"rgb Kd\" [1 0 0]\n"
      "MakeNamedMaterial \"b\" \"string type\" \"matte\" \"rgb Kd\" [0 0 1]\n";
  const std::string mix =
      "\"mix\" \"string namedmaterial1\" \"a\" \"string namedmaterial2\" \"b\" ";
  expect_near(earlier_furnace(mix, two), {0.5f, 0, 0.5f}, 0.02f);
  expect_near(earlier_furnace(mix + "\"rgb amount\" [.25 .25 .25]", two), {0.25f, 0, 0.75f}, 0.02f);
  expect_near(earlier_furnace(mix + "\"rgb amount\" [1 1 1]", two), {1, 0, 0}, 1e-3f);
}

float earlier_luminance(const Color& c) { return dot(c, Color(0.2126f, 0.7152f, 0.0722f)); }

TEST(PbrtEarlier, LightsAreAsTheyAreGiven) {
  const auto sky = [](const std::string& L) {
    return load_pbrt_text(
               "Film \"image\" Camera \"perspective\" WorldBegin LightSource "
               "\"infinite\" " +
               L + " Shape \"sphere\"")
        .scene.sky.zenith;
  };
  expect_near(sky("\"color L\" [1 2 3]"), {1, 2, 3});
  expect_near(sky("\"rgb L\" [1 2 3] \"rgb scale\" [2 3 4]"), {2, 6, 12});
  expect_near(sky("\"rgb L\" [1 2 3] \"color scale\" [2 2 2]"), {2, 4, 6});
  expect_near(sky("\"xyz L\" [.95047 1 1.08883]"), Color(1.0f), 2e-3f);
  // A constant spectrum of 7 has luminance 7; of 1 and 2 beside each other, about their mean.
  EXPECT_NEAR(earlier_luminance(sky("\"spectrum L\" [360 7 830 7]")), 7.0f, 1e-3f);
  // Planck's law over its maximum: 1 where that lies in the middle of what is seen (5200 K), and
  // what it falls to at 555 nm, e^4.965 - 1 and so on, of 2700 K.
  EXPECT_NEAR(earlier_luminance(sky("\"blackbody L\" [5200 1]")), 0.985f, 0.015f);
  EXPECT_NEAR(earlier_luminance(sky("\"blackbody L\" [5200 3]")), 2.955f, 0.045f);
  const auto planck = [](double nm, double kelvins) {
    return std::pow(nm, -5) / std::expm1(1.438776877e7 / (nm * kelvins));
  };
  const double lamp = planck(570, 2700) / planck(2.897771955e6 / 2700, 2700);
  EXPECT_NEAR(earlier_luminance(sky("\"blackbody L\" [2700 1]")), lamp, 0.06 * lamp);
}

TEST(PbrtEarlier, PicturesOfTheSkyAreByLongitude) {
  const TempFolder folder;
  std::string bytes = "PF\n32 16\n-1\n";
  for (int i = 0; i < 32 * 16; ++i) {
    const Color c(3.0f);
    bytes.append(reinterpret_cast<const char*>(&c), sizeof c);
  }
  write_text(folder.file("sky.pfm"), bytes);
  write_text(
      folder.file("scene.pbrt"),
      pbrt_world("LightSource \"infinite\" \"string mapname\" \"sky.pfm\" \"rgb L\" [.5 1 2] "
                 "\"rgb scale\" [2 2 2] \"integer nsamples\" 16 Shape \"sphere\""));
  const LoadedScene loaded = load_pbrt_file(folder.file("scene.pbrt"));
  EXPECT_EQ(loaded.warnings.size(), 1u);
  expect_near(loaded.scene.environment.pixels.at(100), {3, 6, 12}, 1e-4f);
}

TEST(PbrtEarlier, TexturesAreRead) {
  const TempFolder folder;
  write_text(folder.file("a.png"), std::string("P6 1 1 255\n\x80\x40\x20"));
  const auto at = [&](const std::string& textures, const char* use) {
    write_text(folder.file("scene.pbrt"),
               pbrt_world(lit + textures + " Material \"matte\" " + use + " Shape \"disk\""));
    const LoadedScene loaded = load_pbrt_file(folder.file("scene.pbrt"));
    EXPECT_EQ(loaded.warnings.size(), 1u);
    return loaded.scene;
  };
  const auto kd = [&](const std::string& textures) {
    const SceneData scene = at(textures, "\"texture Kd\" \"t\"");
    const Parameter& p = scene.materials.back().parameters[0];
    if (p.texture == no_texture) return p.value;
    return p.value *
           sample_texture(scene.textures.data(), p.texture, scene.texels.data(), {0.5f, 0.5f});
  };
  const std::string t = "Texture \"t\" \"color\" ";
  const std::string map =
      t + "\"imagemap\" \"string filename\" \"a.png\" \"bool trilinear\" \"true\" ";
  const auto srgb = [](double v) {
    return static_cast<float>(std::pow((v / 255 + 0.055) / 1.055, 2.4));
  };
  expect_near(kd(map), {srgb(128), srgb(64), srgb(32)}, 1e-4f);
  expect_near(kd(map + "\"bool gamma\" \"false\""), Color(128, 64, 32) / 255.0f, 1e-4f);
  EXPECT_NEAR(kd(map + "\"float gamma\" 2.2").x, std::pow(128 / 255.0, 2.2), 1e-4);
  expect_near(kd(t + "\"scale\" \"color tex1\" [.5 .6 .7] \"color tex2\" [.2 .4 1]"),
              {0.1f, 0.24f, 0.7f});
  expect_near(kd(t + "\"checkerboard\" \"string aamode\" \"none\" \"color tex1\" [.1 .2 .3]"),
              {0.1f, 0.2f, 0.3f});
  // A number is the luminance of a picture, and what is not 0 is opaque.
  const SceneData masked = at("Texture \"a\" \"float\" \"imagemap\" \"string filename\" \"a.png\" ",
                              "Attribute \"shape\" \"texture alpha\" \"a\"");
  const Opacity& opacity = masked.materials[masked.meshes.at(0).material].opacity;
  EXPECT_GT(opacity.cutoff, 0.0f);
  EXPECT_LT(opacity.cutoff, 1e-3f);
  EXPECT_NEAR(
      sample_texture(masked.textures.data(), opacity.texture, masked.texels.data(), {0.5f, 0.5f}).x,
      0.212671f * srgb(128) + 0.71516f * srgb(64) + 0.072169f * srgb(32), 5e-3f);
}

TEST(PbrtEarlier, MediaHaveTheirDefaults) {
  for (const char* type : {"homogeneous", "heterogeneous"}) {
    const SceneData scene =
        load_pbrt_text(fmt::format("Film \"image\" WorldBegin {} MakeNamedMedium \"m\" \"string "
                                   "type\" \"{}\" \"float density\" [1] MediumInterface \"m\" "
                                   "\"\" Material \"\" Shape \"sphere\"",
                                   lit, type))
            .scene;
    expect_near(scene.media.at(0).extinction, {2.5511f, 3.2124f, 3.784f});
  }
}

TEST(PbrtEarlier, ViewsAreRead) {
  const auto scene = [](const std::string& options) {
    return load_pbrt_text(options +
                          " WorldBegin LightSource \"infinite\" Shape \"sphere\" WorldEnd")
        .scene;
  };
  const std::string image = "Film \"image\" ";
  EXPECT_EQ(scene(image + "\"float scale\" 2").sky.zenith.x, 2.0f);
  // Time does not expose.
  EXPECT_EQ(scene(image + "Camera \"perspective\" \"float shutterclose\" .25").sky.zenith.x, 1.0f);
  EXPECT_EQ(*scene(image).defaults.filter, (FilterChoice{FilterKind::box, 0.5f, 0.0f}));
  EXPECT_EQ(*scene(image + "PixelFilter \"triangle\" \"float xwidth\" 1 \"float ywidth\" 1")
                 .defaults.filter,
            (FilterChoice{FilterKind::tent, 1.0f, 0.0f}));
  EXPECT_EQ(scene(image + "PixelFilter \"gaussian\"").defaults.filter->a, 0.5f);
  EXPECT_EQ(scene(image + "PixelFilter \"gaussian\" \"float alpha\" 8").defaults.filter->a, 0.25f);
  EXPECT_EQ(scene(image + "Sampler \"lowdiscrepancy\" \"integer pixelsamples\" 8").defaults.spp, 8);
  EXPECT_EQ(scene(image + "SurfaceIntegrator \"path\" \"integer maxdepth\" 3").defaults.max_depth,
            4);
  EXPECT_EQ(scene(image + "Integrator \"directlighting\"").defaults.max_depth, 2);
  EXPECT_EQ(
      scene(image + "Renderer \"sampler\" VolumeIntegrator \"emission\" Accelerator \"kdtree\"")
          .spheres.size(),
      1u);
}

}  // namespace
}  // namespace pt
