// pbrt's media: coefficients, the sides of shapes, and light that gets through.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>

#include "common/medium/sample_grid.h"
#include "load/expect_near.h"
#include "load/pbrt_scene.h"
#include "load/render_loaded.h"

namespace pt {
namespace {

std::string named_medium(const std::string& parameters, const std::string& type = "homogeneous",
                         const std::string& name = "fog") {
  return fmt::format("MakeNamedMedium \"{}\" \"string type\" \"{}\" {}\n", name, type, parameters);
}

const std::string fog_inside = "MediumInterface \"fog\" \"\"\n";
const std::string passing_ball = fog_inside + "Material \"interface\" Shape \"sphere\"\n";

/// The only medium of a scene that has it in a sphere.
Medium loaded_medium(const std::string& parameters, const std::string& before = {}) {
  const SceneData scene =
      load_pbrt_silently(pbrt_world(lit + named_medium(parameters) + passing_ball, before));
  EXPECT_EQ(scene.media.size(), 1u);
  return scene.media.at(0);
}

TEST(PbrtMedia, HomogeneousOnesHaveDefaults) {
  const Medium medium = loaded_medium("");
  expect_near(medium.extinction, Color(2));
  expect_near(medium.albedo, Color(0.5f));
  EXPECT_EQ(medium.emission, Color(0));
  EXPECT_EQ(medium.phase, phase_kind_of<Isotropic>);
  EXPECT_TRUE(medium.is_homogeneous());
}

TEST(PbrtMedia, CoefficientsAreScaledOnce) {
  const Medium medium = loaded_medium(
      "\"rgb sigma_a\" [.1 .2 0] \"rgb sigma_s\" [.3 .2 0] \"float scale\" 4 \"float g\" -.3");
  expect_near(medium.extinction, Color(1.6f, 1.6f, 0));
  expect_near(medium.albedo, Color(0.75f, 0.5f, 0));
  EXPECT_EQ(medium.phase, phase_kind_of<HenyeyGreenstein>);
  EXPECT_FLOAT_EQ(medium.phase_parameter, -0.3f);
  // Those of wavelengths are not of luminance 1.
  expect_near(
      loaded_medium("\"spectrum sigma_a\" [200 .2 900 .2] \"rgb sigma_s\" [0 0 0]").extinction,
      Color(0.2f), 1e-3f);
}

TEST(PbrtMedia, EmissionIsALightsRadiance) {
  expect_near(loaded_medium("\"rgb Le\" [1 2 3] \"float Lescale\" 2").emission, Color(2, 4, 6));
  // The film's exposure is that of all light, and a blackbody has luminance 1.
  const Color warm = loaded_medium("\"blackbody Le\" 3000",
                                   "# the film comes again\n"
                                   "Film \"rgb\" \"float iso\" 300")
                         .emission;
  EXPECT_NEAR(dot(warm, Color(0.2126f, 0.7152f, 0.0722f)), 3, 1e-3);
  EXPECT_GT(warm.x, warm.z);
}

TEST(PbrtMedia, WhatGlowsLightsTheScene) {
  const SceneData scene =
      load_pbrt_silently(pbrt_world(named_medium("\"rgb Le\" [1 1 1]") + passing_ball));
  EXPECT_TRUE(is_black(scene.sky.zenith));
  const LoadedScene dark = load_pbrt_text(pbrt_world(named_medium("") + passing_ball));
  EXPECT_EQ(dark.count("no light that is supported"), 1);
}

TEST(PbrtMedia, AFilmsWhiteIsThatOfMediaToo) {
  const std::string balanced = "Film \"rgb\" \"float whitebalance\" 4000";
  const auto load = [&](const std::string& world) {
    return load_pbrt_text(pbrt_world(world, balanced)).scene;
  };
  const Color light = load("LightSource \"point\" \"rgb I\" [3 2 1]").delta_lights.at(0).intensity;
  ASSERT_GT(std::abs(light.z - 1), 0.1f);
  const SceneData even = load(named_medium("\"rgb Le\" [3 2 1]") + passing_ball);
  expect_near(even.media.at(0).emission, light);
  const SceneData grid =
      load(named_medium("\"rgb sigma_a\" [1 1 1] \"rgb Le\" [3 2 1]", "rgbgrid") + passing_ball);
  const VolumeGrids grids{grid.grids.data(), grid.grid_values.data(), nullptr};
  expect_near(emission_at(grids, grid.media.at(0), Vec3(0.5f)), light);
}

TEST(PbrtMedia, PresetsAreThoseMeasured) {
  const Medium milk = loaded_medium("\"string preset\" \"Wholemilk\" \"float scale\" 10");
  expect_near(milk.extinction, Color(25.511f, 32.124f, 37.84f), 1e-4f);
  expect_near(milk.albedo, Color(2.55f / 2.5511f, 3.21f / 3.2124f, 3.77f / 3.784f));
  const LoadedScene other = load_pbrt_text(pbrt_world(
      lit + named_medium("\"string preset\" \"Mud\" \"rgb sigma_s\" [0 0 0]") + passing_ball));
  EXPECT_EQ(other.count("preset 'Mud' is not supported"), 1);
  expect_near(other.scene.media.at(0).extinction, Color(1));
}

TEST(PbrtMedia, InterfacesPassAndPartTwoMedia) {
  const SceneData scene = load_pbrt_silently(pbrt_world(
      lit + named_medium("") + named_medium("\"float scale\" 3", "homogeneous", "smoke") +
      "AttributeBegin MediumInterface \"fog\" \"smoke\"\n"
      "Material \"interface\" Shape \"sphere\"\n"
      "Material \"dielectric\" Shape \"sphere\" AttributeEnd\n"
      "Material \"diffuse\" Shape \"sphere\" "
      "MediumInterface \"fog\" Shape \"sphere\""));
  ASSERT_EQ(scene.media.size(), 2u);
  expect_near(scene.media[0].extinction, Color(2));
  ASSERT_EQ(scene.materials.size(), 3u);
  const MaterialDescription &boundary = scene.materials[0], &glass = scene.materials[1];
  EXPECT_TRUE(boundary.is_boundary && boundary.passes && boundary.opacity.is_opaque());
  EXPECT_EQ(boundary.media, (MediumBoundary{1, 0}));
  EXPECT_TRUE(glass.is_boundary && !glass.passes);
  EXPECT_EQ(glass.kind, kind_of<Dielectric>);
  EXPECT_EQ(glass.media, (MediumBoundary{1, 0}));
  // Without media, and with the same on both sides, a shape keeps its surroundings'.
  EXPECT_EQ(scene.sphere_material[2], scene.sphere_material[3]);
  EXPECT_FALSE(scene.materials[2].is_boundary);
}

TEST(PbrtMedia, TheCameraIsInTheOutsideOfItsDirective) {
  const auto medium_with = [](const std::string& before) {
    return load_pbrt_silently(pbrt_world(lit + "Shape \"sphere\"", before));
  };
  const SceneData scene =
      medium_with(named_medium("\"float scale\" 3") + "MediumInterface \"\" \"fog\"");
  EXPECT_EQ(scene.camera_medium, 0u);
  // The state goes on after WorldBegin.
  EXPECT_EQ(scene.materials.at(0).media, (MediumBoundary{0, no_medium}));
  EXPECT_EQ(medium_with(named_medium("") + fog_inside).camera_medium, no_medium);
}

TEST(PbrtMedia, MayHaveAPriority) {
  const auto priority_of = [](const std::string& parameters) {
    return load_pbrt_silently(pbrt_world(lit + named_medium(parameters) + fog_inside +
                                         "Material \"interface\" Shape \"sphere\""))
        .media.at(0)
        .priority;
  };
  EXPECT_EQ(priority_of(""), 0);
  EXPECT_EQ(priority_of("\"integer priority\" 12"), 12);
}

TEST(PbrtMedia, TheBackOfALampHasItsSidesSwapped) {
  const SceneData scene = load_pbrt_silently(
      pbrt_world(named_medium("") + fog_inside +
                 "AreaLightSource \"diffuse\" \"bool twosided\" true\n" + facing_wall));
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.materials[scene.meshes[0].material].media, (MediumBoundary{no_medium, 0}));
  EXPECT_EQ(scene.materials[scene.meshes[1].material].media, (MediumBoundary{0, no_medium}));
}

TEST(PbrtMedia, ALampOfABoundaryIsIgnored) {
  const LoadedScene loaded = load_pbrt_text(
      pbrt_world(lit + named_medium("") + "AreaLightSource \"diffuse\"\n" + passing_ball));
  EXPECT_EQ(loaded.count("between two media is ignored"), 1);
  EXPECT_TRUE(loaded.scene.materials.at(0).passes);
  EXPECT_TRUE(is_black(loaded.scene.materials.at(0).emission.radiance));
}

TEST(PbrtMedia, AreInObjectsToo) {
  const SceneData scene = load_pbrt_silently(
      pbrt_world(lit + named_medium("") + "ObjectBegin \"drop\"\n" + passing_ball +
                 "ObjectEnd ObjectInstance \"drop\" Translate 5 0 0 ObjectInstance \"drop\""));
  EXPECT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.media.size(), 1u);
  EXPECT_TRUE(scene.materials[scene.meshes.at(0).material].passes);
}

TEST(PbrtMedia, OthersAreReportedAndLeftOut) {
  const LoadedScene loaded =
      load_pbrt_text(pbrt_world(lit + named_medium("", "foam") + passing_ball));
  EXPECT_EQ(loaded.count("medium 'foam' is not supported"), 1);
  EXPECT_TRUE(loaded.scene.media.empty());
  EXPECT_TRUE(loaded.scene.spheres.empty());
}

TEST(PbrtMedia, ErrorsNameThePlace) {
  const auto expect = [](const std::string& world, const std::string& place,
                         const std::string& part) {
    const std::string message = pbrt_complaint(pbrt_world(lit + world));
    EXPECT_EQ(message.substr(0, message.find(": ")), place) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect(passing_ball, "scene.pbrt:8:22",
         "there is no medium 'fog'; expected one that "
         "MakeNamedMedium defines");
  expect("MakeNamedMedium \"fog\"\n" + passing_ball, "scene.pbrt:7:1", "no 'string type'");
  const auto wrong = [&](const std::string& parameters, const std::string& part,
                         const std::string& type = "homogeneous") {
    const std::string message =
        pbrt_complaint(pbrt_world(lit + named_medium(parameters, type) + passing_ball));
    EXPECT_EQ(message.substr(0, 13), "scene.pbrt:7:") << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  wrong("\"float g\" 1", "less than 1");
  wrong("\"float scale\" -1", "at least 0");
  wrong("\"rgb sigma_a\" [-1 0 0]", "negative");
  wrong("", "no 'float density'", "uniformgrid");
  wrong("\"integer nx\" 2 \"float density\" [1 2 3]", "nx * ny * nz = 2", "uniformgrid");
  wrong("\"integer nx\" 0", "expected 1 to", "uniformgrid");
  wrong("\"float density\" -1", "at least 0", "uniformgrid");
  wrong("\"float density\" 1 \"float temperature\" 1 \"rgb Le\" [1 1 1]", "both", "uniformgrid");
  wrong("\"float density\" 1 \"point3 p1\" [1 0 1]", "without volume", "uniformgrid");
  wrong("", "sigma_a", "rgbgrid");
  wrong("\"rgb sigma_s\" [1 1 1] \"rgb Le\" [1 1 1]", "without 'rgb sigma_a'", "rgbgrid");
  wrong("\"rgb sigma_a\" [1 1 1 2 2 2]", "= 3", "rgbgrid");
}

// Renders, through a slab from z = 2 to z = 4 that the camera sees along its axis.

const std::string narrow_view =
    "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n"
    "PixelFilter \"box\" Camera \"perspective\" \"float fov\" .2\n";

std::string slab(const std::string& medium) {
  return narrow_view + "WorldBegin\n" + medium + fog_inside +
         "Material \"interface\"\n"
         "Shape \"bilinearmesh\" \"point3 P\" [-3 -3 2  -3 3 2  3 -3 2  3 3 2]\n"
         "ReverseOrientation\n"
         "Shape \"bilinearmesh\" \"point3 P\" [-3 -3 4  -3 3 4  3 -3 4  3 3 4]\n";
}

void expect_means(const ChannelMeans& means, const Color& expected) {
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(means.of[c].mean(), double{expected[c]}, 5 * means.of[c].sigma() + 1e-4)
        << "channel " << c;
    EXPECT_LT(means.of[c].sigma(), 0.02 * double{expected[c]} + 1e-4) << "channel " << c;
  }
}

TEST(PbrtMediaLight, AbsorptionIsBeersLaw) {
  const SceneData scene =
      load_pbrt_silently(slab(lit + named_medium("\"rgb sigma_a\" [.1 .3 .6] \"float scale\" 2 "
                                                 "\"rgb sigma_s\" [0 0 0]")));
  expect_means(channel_means(scene, 8, 256), {std::exp(-0.4f), std::exp(-1.2f), std::exp(-2.4f)});
}

TEST(PbrtMediaLight, EmissionIsThatOfASlab) {
  const SceneData scene = load_pbrt_silently(
      slab(named_medium("\"rgb sigma_a\" [.1 .3 .6] \"rgb sigma_s\" [0 0 0] \"rgb Le\" [1 2 3]")));
  expect_means(channel_means(scene, 8, 256),
               {1 - std::exp(-0.2f), 2 * (1 - std::exp(-0.6f)), 3 * (1 - std::exp(-1.2f))});
}

// Twice through a grid whose density, between its two samples, goes from one to the other.
TEST(PbrtMediaLight, AGridOfTwoSamplesAbsorbsItsMean) {
  const SceneData scene = load_pbrt_silently(
      slab(lit + named_medium("\"rgb sigma_a\" [1 .5 .25] \"rgb sigma_s\" [0 0 0] \"integer nz\" 2 "
                              "\"float density\" [.25 1.5] \"point3 p0\" [-9 -9 1] \"point3 p1\" "
                              "[9 9 5]",
                              "uniformgrid")));
  // Samples lie at z = 2 and z = 4.
  const float depth = 2 * 0.5f * (0.25f + 1.5f);
  expect_means(channel_means(scene, 8, 1024),
               {std::exp(-depth), std::exp(-0.5f * depth), std::exp(-0.25f * depth)});
}

TEST(PbrtMediaLight, AConstantGridIsAHomogeneousMedium) {
  const std::string colors =
      "\"rgb sigma_a\" [.1 .2 .3] \"rgb sigma_s\" [.5 .4 .3] \"float g\" .3 \"float scale\" 2 ";
  const auto means = [](const std::string& medium) {
    return channel_means(load_pbrt_silently(narrow_view + "WorldBegin\n" + lit + medium +
                                            "Translate 0 0 3\n" + passing_ball),
                         8, 2048);
  };
  const ChannelMeans even = means(named_medium(colors));
  // A box of a half more than the ball: there it fades.
  std::string ones;
  for (int i = 0; i < 64; ++i) ones += " 1";
  const ChannelMeans grid =
      means(named_medium(colors +
                             "\"point3 p0\" [-2 -2 1] \"point3 p1\" [2 2 5] \"integer nx\" 4 "
                             "\"integer ny\" 4 \"integer nz\" 4 \"float density\" [" +
                             ones + " ]",
                         "uniformgrid"));
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(grid.of[c].mean(), even.of[c].mean(),
                5 * std::hypot(grid.of[c].sigma(), even.of[c].sigma()));
    EXPECT_LT(grid.of[c].sigma(), 0.01);
    EXPECT_LT(even.of[c].mean(), 0.9);  // it absorbs
  }
}

TEST(PbrtMediaLight, GlassKeepsWhatAbsorbsInside) {
  // Straight through a pane of index 1.5: two faces, and all light that is reflected between them.
  std::string text = slab(lit + named_medium("\"rgb sigma_a\" [.1 .3 .6] \"rgb sigma_s\" [0 0 0]"));
  text.replace(text.find("interface"), 9, "dielectric");
  const double r = 0.04;
  Color expected;
  for (int c = 0; c < 3; ++c) {
    const double t = std::exp(-2 * std::array{0.1, 0.3, 0.6}[static_cast<std::size_t>(c)]);
    // The sky is white on both sides.
    const double through = (1 - r) * (1 - r) * t / (1 - r * r * t * t);
    const double back = r + (1 - r) * (1 - r) * r * t * t / (1 - r * r * t * t);
    expected[c] = static_cast<float>(through + back);
  }
  expect_means(channel_means(load_pbrt_silently(text), 8, 1024), expected);
}

}  // namespace
}  // namespace pt
