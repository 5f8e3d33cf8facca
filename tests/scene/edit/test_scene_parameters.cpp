// The table of what can be changed in a scene: names, and values against scenes that were made with
// them.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "common/scene/data/plastic_material.h"
#include "common/scene/edit/bsdf_parameters.h"
#include "common/scene/edit/scene_parameters.h"
#include "common/scene/edit/set_material.h"
#include "load/mitsuba_scene.h"

namespace {

using namespace pt;

std::vector<std::string> names_in(const SceneData& scene) {
  std::vector<std::string> names;
  for (const SceneParameter& p : scene_parameters(scene)) names.push_back(p.name);
  return names;
}

void set(SceneData& scene, const std::string& name, const std::vector<float>& values) {
  for (const SceneParameter& p : scene_parameters(scene)) {
    if (p.name == name) return p.set(scene, values);
  }
  FAIL() << "no " << name;
}

TEST(BsdfParameters, HaveTheNamesOfTheirIndices) {
  const auto principled = bsdf_parameters(kind_of<Principled>);
  ASSERT_EQ(principled.size(), 12u);
  EXPECT_EQ(principled[Principled::Index::spec_tint].name, "spec_tint");
  EXPECT_TRUE(principled[Principled::Index::base_color].is_color);
  EXPECT_FALSE(principled[Principled::Index::clearcoat_gloss].is_color);
  for (int kind = 0; kind < Bsdfs::size; ++kind) {
    std::set<std::string> names;
    for (const BsdfParameter& p : bsdf_parameters(MaterialKind(kind))) {
      EXPECT_TRUE(names.insert(p.name).second) << kind << ": " << p.name << " twice";
      EXPECT_NE(p.name, "count") << kind;
      EXPECT_EQ(p.name.find_first_of(":;] ("), std::string::npos) << kind << ": " << p.name;
    }
  }
}

/// Sets one value of a material.
void change(MaterialDescription& material, const std::string& name, float value) {
  for (const MaterialValue& v : material_values(material)) {
    if (v.name == name) return v.set(material, Color(value));
  }
  FAIL() << "no " << name;
}

void expect_same(const MaterialDescription& a, const MaterialDescription& b) {
  for (int i = 0; i < parameters_max; ++i)
    EXPECT_EQ(a.parameters[i].value, b.parameters[i].value) << i;
}

TEST(MaterialValues, WhatIsPrecomputedFollows) {
  for (const bool nonlinear : {false, true}) {
    MaterialDescription rough =
        make_rough_plastic(Color(0.5f), Color(1.0f), {1.5f, nonlinear}, 0.1f, true);
    change(rough, "alpha", 0.3f);
    expect_same(rough, make_rough_plastic(Color(0.5f), Color(1.0f), {1.5f, nonlinear}, 0.3f, true));
    change(rough, "is_beckmann", 0.0f);
    expect_same(rough,
                make_rough_plastic(Color(0.5f), Color(1.0f), {1.5f, nonlinear}, 0.3f, false));
    MaterialDescription smooth = make_plastic(Color(0.5f), Color(1.0f), {1.5f, nonlinear});
    change(smooth, "eta", 1.8f);
    expect_same(smooth, make_plastic(Color(0.5f), Color(1.0f), {1.8f, nonlinear}));
  }
}

TEST(SceneParameters, NamesAreThoseOfTheFileAndDiffer) {
  const SceneData scene =
      load_xml(
          R"(<bsdf type="twosided" id="wall"><bsdf type="diffuse"/><bsdf type="plastic"/></bsdf>
      <shape type="cube" id="box"><bsdf type="conductor"/></shape>
      <shape type="rectangle"><ref id="wall"/></shape>
      <shape type="sphere"><bsdf type="diffuse"/><emitter type="area" id="lamp"/></shape>
      <shape type="cube"><ref id="wall"/><emitter type="area" id="lamp2"/></shape>
      <emitter type="point" id="bulb"/><emitter type="point"/>)")
          .scene;
  const std::vector<std::string> names = names_in(scene);
  EXPECT_EQ(std::set(names.begin(), names.end()).size(), names.size());
  for (const char* name :
       {"camera.fov", "materials.box.bsdf.eta", "materials.wall.0.albedo",
        "materials.wall.1.diffuse", "lights.lamp.radiance", "lights.lamp2.radiance",
        "lights.bulb.intensity", "lights.light_1.intensity"}) {
    EXPECT_TRUE(std::ranges::count(names, name) == 1) << name;
  }
}

TEST(SceneParameters, RefuseWhatCannotBe) {
  SceneData scene = load_xml(R"(<shape type="shapegroup" id="g"><shape type="cube"/></shape>
      <shape type="instance"><ref id="g"/></shape><emitter type="point" id="bulb"/>)")
                        .scene;
  EXPECT_THROW(set(scene, "lights.bulb.intensity", {1, -1, 1}), Error);
  EXPECT_THROW(set(scene, "camera.origin", {1, HUGE_VALF, 1}), Error);
  EXPECT_THROW(set(scene, "instances.0.to_world", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}),
               Error);
  set(scene, "instances.0.to_world", {1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1});
  EXPECT_EQ(scene.instances[0].to_world.point(Vec3(1.0f)), Vec3(6, 7, 8));
}

}  // namespace
