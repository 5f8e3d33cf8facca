// <medium>s of Mitsuba's files: coefficients, phase functions, and where they lie.
#include <gtest/gtest.h>

#include "load/expect_near.h"
#include "load/mitsuba_scene.h"

namespace pt {
namespace {

std::string medium(const std::string& inside, const std::string& side = "interior",
                   const std::string& type = "homogeneous") {
  return "<medium type='" + type + "' name='" + side + "'>" + inside + "</medium>";
}

std::string ball(const std::string& inside) {
  return "<shape type='sphere'>" + inside + "</shape>";
}

/// With a light and, unless it has one, a sensor, of whose absence nothing is said then.
SceneData load_media(const std::string& inside, const std::string& version = "3.0.0") {
  std::string more = "<emitter type='constant'/>";
  if (inside.find("<sensor") == std::string::npos) more += "<sensor type='perspective'/>";
  const LoadedScene loaded = load_xml(inside + more, version);
  EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
  return loaded.scene;
}

const std::string null_bsdf = "<bsdf type='null'/>";

TEST(MitsubaMedia, HaveDefaults) {
  const SceneData scene = load_media(ball(null_bsdf + medium("")));
  ASSERT_EQ(scene.media.size(), 1u);
  expect_near(scene.media[0].extinction, Color(1));
  expect_near(scene.media[0].albedo, Color(0.75f));
  EXPECT_TRUE(scene.media[0].is_homogeneous());
  EXPECT_EQ(scene.media[0].phase, phase_kind_of<Isotropic>);
}

TEST(MitsubaMedia, ReadExtinctionAlbedoAndScale) {
  const SceneData scene = load_media(
      ball(null_bsdf + medium("<rgb name='sigma_t' value='0.1 0.2 1'/><rgb name='albedo' value='1 "
                              "0.5 0'/>" +
                              number("scale", 4))));
  expect_near(scene.media[0].extinction, Color(0.4f, 0.8f, 4));
  expect_near(scene.media[0].albedo, Color(1, 0.5f, 0));
}

TEST(MitsubaMedia, ReadOldCoefficients) {
  const SceneData scene = load_media(
      ball(medium("<spectrum name='sigmaS' value='2'/><spectrum name='sigmaA' value='0.5'/>")),
      "0.6.0");
  expect_near(scene.media[0].extinction, Color(2.5f));
  expect_near(scene.media[0].albedo, Color(0.8f));
}

TEST(MitsubaMedia, ReadConstantVolumes) {
  const SceneData scene = load_media(ball(
      null_bsdf + medium("<volume type='constvolume' name='albedo'><rgb name='value' value='0.2 "
                         "0.4 0.6'/></volume>")));
  expect_near(scene.media[0].albedo, Color(0.2f, 0.4f, 0.6f));
}

TEST(MitsubaMedia, ReadPhaseFunctions) {
  const auto phase_of = [](const std::string& phase) {
    return load_media(ball(null_bsdf + medium(phase))).media.at(0);
  };
  const Medium forward = phase_of("<phase type='hg'>" + number("g", 0.3) + "</phase>");
  EXPECT_EQ(forward.phase, phase_kind_of<HenyeyGreenstein>);
  EXPECT_FLOAT_EQ(forward.phase_parameter, 0.3f);
  EXPECT_FLOAT_EQ(phase_of("<phase type='hg'/>").phase_parameter, 0.8f);
  EXPECT_EQ(phase_of("<phase type='rayleigh'/>").phase, phase_kind_of<Rayleigh>);
  EXPECT_EQ(phase_of("<phase type='isotropic'/>").phase, phase_kind_of<Isotropic>);
}

TEST(MitsubaMedia, LieInsideAndOutside) {
  const SceneData scene =
      load_media("<medium type='homogeneous' id='fog'/>" +
                 ball(null_bsdf + medium(number("scale", 3)) + "<ref name='exterior' id='fog'/>") +
                 ball("<bsdf type='diffuse'/><ref name='exterior' id='fog'/>") +
                 ball("<bsdf type='diffuse'/>"));
  EXPECT_EQ(scene.media.size(), 2u);
  ASSERT_EQ(scene.materials.size(), 3u);
  const MaterialDescription &first = scene.materials[0], &second = scene.materials[1];
  EXPECT_TRUE(first.is_boundary && first.passes);
  EXPECT_NE(first.media.inside, first.media.outside);
  EXPECT_TRUE(second.is_boundary && !second.passes);
  EXPECT_EQ(second.media.outside, first.media.outside);
  EXPECT_EQ(second.media.inside, no_medium);
  EXPECT_FALSE(scene.materials[2].is_boundary || scene.materials[2].passes);
}

TEST(MitsubaMedia, TheCameraMayStandInOne) {
  const SceneData scene =
      load_media(ball("") + "<sensor type='perspective'>" + medium("", "medium") + "</sensor>");
  EXPECT_EQ(scene.camera_medium, 0u);
  EXPECT_EQ(scene.media.size(), 1u);
  EXPECT_EQ(load_media(ball("")).camera_medium, no_medium);
}

TEST(MitsubaMedia, MayHaveAPriority) {
  const auto priority_of = [](const std::string& inside) {
    return load_media(ball(null_bsdf + medium(inside))).media.at(0).priority;
  };
  EXPECT_EQ(priority_of(""), 0);
  EXPECT_EQ(priority_of("<integer name='priority' value='-7'/>"), -7);
}

TEST(MitsubaMedia, WhatIsNotSupportedIsSaidAndLeftOut) {
  const auto expect_left_out = [](const LoadedScene& loaded, const std::string& what) {
    EXPECT_EQ(loaded.count(what + " is not supported"), 1) << what;
    EXPECT_TRUE(loaded.scene.media.empty()) << what;
  };
  const std::string texture = "<texture type='checkerboard' name='sigma_t'/>";
  const std::string volume = "<volume type='other' name='albedo'/>";
  expect_left_out(load_xml(ball(null_bsdf + medium("", "interior", "other"))), "medium 'other'");
  expect_left_out(load_xml(ball(null_bsdf + medium("", "interior", "heterogeneous")), "0.6.0"),
                  "medium 'heterogeneous'");
  expect_left_out(load_xml(ball(null_bsdf + medium("<string name='material' value='Milk'/>"))),
                  "a medium by the name of its material");
  for (const std::string& inside : {texture, volume}) {
    expect_left_out(load_xml(ball(null_bsdf + medium(inside))),
                    "a homogeneous medium of textures or grids");
    expect_left_out(load_xml(ball(null_bsdf + medium(inside, "interior", "heterogeneous"))),
                    "a heterogeneous medium of other things than gridvolume and constvolume");
  }
  const LoadedScene phase = load_xml(ball(null_bsdf + medium("<phase type='sggx'/>")));
  EXPECT_EQ(phase.count("phase function 'sggx' is not supported"), 1);
  EXPECT_EQ(phase.scene.media.size(), 1u);
}

TEST(MitsubaMedia, WrongNumbersAreErrors) {
  const auto error_of = [](const std::string& inside) -> std::string {
    try {
      load_xml(ball(null_bsdf + medium(inside)));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(error_of("<phase type='hg'>" + number("g", 1) + "</phase>").find("less than 1"),
            std::string::npos);
  EXPECT_NE(error_of(number("scale", -1)).find("at least 0"), std::string::npos);
}

}  // namespace
}  // namespace pt
