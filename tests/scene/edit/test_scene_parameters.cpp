// The table of what can be changed in a scene: names, and values against scenes that were made with
// them.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "common/scene/data/plastic_material.h"
#include "common/scene/edit/scene_parameters.h"
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

/// Names are the keys of scene.params: they stay.
TEST(BsdfParameters, HaveTheirNames) {
  const std::map<std::string, std::string> names = {
      {"diffuse", "albedo*"},
      {"metal", "albedo* fuzz"},
      {"dielectric", "tint* eta"},
      {"oren-nayar", "albedo* sigma"},
      {"plastic", "diffuse* specular* (coat*)"},
      {"rough plastic",
       "diffuse* specular* alpha (coat*) (transmittance_0*) (transmittance_1*) (transmittance_2*) "
       "is_beckmann"},
      {"phong", "diffuse* specular* exponent"},
      {"ward", "diffuse* specular* alpha_x alpha_y"},
      {"conductor", "tint* eta* k* alpha_x alpha_y is_beckmann"},
      {"compensated conductor", "tint* eta* k* alpha_x alpha_y is_beckmann"},
      {"rough dielectric", "reflected* passed* eta alpha_x alpha_y is_beckmann"},
      {"thin dielectric", "reflected* passed* eta"},
      {"principled",
       "base_color* roughness metallic spec_trans eta anisotropic spec_tint sheen sheen_tint "
       "flatness clearcoat clearcoat_gloss"},
      {"thin principled",
       "base_color* roughness spec_trans eta anisotropic spec_tint sheen sheen_tint flatness "
       "diff_trans"}};
  for_each_type(Bsdfs{}, [&]<class Bsdf>(std::type_identity<Bsdf>) {
    std::string text;
    for (const BsdfParameter& p : bsdf_parameters(kind_of<Bsdf>)) {
      const std::string name = std::string(p.name) + (p.is_color ? "*" : "");
      text += (text.empty() ? "" : " ") + (p.is_precomputed ? "(" + name + ")" : name);
    }
    if (names.contains(Bsdf::name)) {
      EXPECT_EQ(text, names.at(Bsdf::name));
    }
  });
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

/// A scene of 3 materials without names and 2 with that name, and one of each other thing.
SceneData scene_of_all() {
  SceneData scene;
  scene.camera.aperture = 0.1f;
  MaterialDescription lamp = make_diffuse(Color(0.5f));
  lamp.emission.radiance = Color(3, 4, 5);
  const std::uint32_t a = scene.add_material(lamp), b = scene.add_material(lamp);
  scene.names.materials = {{a, "one"}, {b, "one"}};
  scene.names.emitters = {{a, "lamp"}, {b, "lamp"}};
  scene.add_material(make_plastic(Color(0.5f), Color(1.0f), {1.5f, false}));
  MaterialDescription blend;
  blend.node = MaterialNode::blend;
  blend.parameters[0].value = Color(0.25f);
  blend.children[0] = a, blend.children[1] = b;
  scene.add_material(blend);
  MaterialDescription thin = make_diffuse(Color(0.5f));
  thin.opacity = constant_opacity(0.75f);
  scene.add_material(thin);
  scene.delta_lights.resize(3);
  scene.names.delta_lights = {{0, "bulb"}, {2, "bulb"}};
  scene.sun.one_minus_cos = 1e-5f;
  scene.instances = {{1, {}}, {1, {}}};
  scene.meshes.resize(4);
  for (Mesh& mesh : scene.meshes)
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, mesh.material = 2;
  scene.meshes[0].material = a, scene.meshes[1].material = b;
  scene.meshes[0].normals.resize(3, Vec3(0, 0, 1));
  scene.names.meshes = {{2, "bust"}};
  scene.add_sphere({1, 2, 3}, 0.5f, a), scene.add_sphere({4, 5, 6}, 2, b);
  scene.add_sphere({7, 8, 9}, 3, 2);
  return scene;
}

TEST(SceneParameters, AreAllThatASceneHas) {
  const std::vector<std::string> expected{"camera.origin",
                                          "camera.target",
                                          "camera.up",
                                          "camera.to_world",
                                          "camera.shutter_open",
                                          "camera.shutter_close",
                                          "camera.fov",
                                          "camera.aperture",
                                          "camera.focus_distance",
                                          "materials.one.albedo",
                                          "materials.one.opacity",
                                          "materials.one_2.albedo",
                                          "materials.one_2.opacity",
                                          "materials.material_2.diffuse",
                                          "materials.material_2.specular",
                                          "materials.material_2.eta",
                                          "materials.material_2.opacity",
                                          "materials.material_3.weight",
                                          "materials.material_4.albedo",
                                          "materials.material_4.opacity",
                                          "lights.lamp.radiance",
                                          "lights.lamp_2.radiance",
                                          "lights.bulb.intensity",
                                          "lights.light_1.intensity",
                                          "lights.bulb_2.intensity",
                                          "lights.sky.nadir",
                                          "lights.sky.zenith",
                                          "lights.sun.radiance",
                                          "instances.0.to_world",
                                          "instances.1.to_world",
                                          "meshes.one.vertices",
                                          "meshes.one.normals",
                                          "meshes.one_2.vertices",
                                          "meshes.bust.vertices",
                                          "meshes.mesh_3.vertices",
                                          "spheres.one.center",
                                          "spheres.one.radius",
                                          "spheres.one_2.center",
                                          "spheres.one_2.radius",
                                          "spheres.sphere_2.center",
                                          "spheres.sphere_2.radius"};
  SceneData scene = scene_of_all();
  EXPECT_EQ(names_in(scene), expected);
  const std::map<std::string, SceneChanges> stale = {
      {"camera.fov", {.camera = true}},
      {"camera.shutter_open", {.camera = true}},
      {"materials.one.albedo", {.shading = true}},
      {"materials.one.opacity", {.shading = true, .lights = true}},
      {"materials.material_3.weight", {.shading = true}},
      {"lights.lamp.radiance", {.shading = true, .lights = true}},
      {"lights.sun.radiance", {.shading = true, .lights = true}},
      {"instances.1.to_world", {.instances = true}},
      {"meshes.one.vertices", {.vertices = true}},
      {"meshes.one.normals", {.normals = true}},
      {"spheres.one_2.center", {.instances = true}},
      {"spheres.one_2.radius", {.instances = true}}};
  int found = 0;
  for (const SceneParameter& p : scene_parameters(scene)) {
    if (!stale.contains(p.name)) continue;
    EXPECT_EQ(p.changes, stale.at(p.name)) << p.name;
    ++found;
  }
  EXPECT_EQ(found, stale.size());

  scene.camera.orthographic = true;  // without a field of view, a lens or a plane in focus
  std::vector<std::string> others(expected.begin(), expected.begin() + 6);
  others.insert(others.end(), expected.begin() + 9, expected.end());
  EXPECT_EQ(names_in(scene), others);
}

TEST(SceneParameters, AMaskIsNoNumber) {
  SceneData scene = scene_of_all();
  const auto opacities = [&] {
    return std::ranges::count_if(
        names_in(scene), [](const std::string& name) { return name.ends_with(".opacity"); });
  };
  EXPECT_EQ(opacities(), 4);
  scene.materials[4].opacity = textured_opacity(1.0f, 0);
  EXPECT_EQ(opacities(), 3);
  scene.materials[4].opacity = {0.75f, 0.0f, no_texture, 0.5f};
  EXPECT_EQ(opacities(), 3) << "there or not, by its cutoff";
  set(scene, "materials.one.opacity", {0.5f});
  EXPECT_EQ(scene.materials[0].opacity.offset, 0.5f);
  EXPECT_EQ(scene.materials[0].opacity.scale, 0.0f);
  EXPECT_EQ(scene.materials[0].opacity.texture, no_texture);
}

/// Numbers that differ from what is there and from each other.
std::vector<float> other_values(const SceneParameter& p, std::size_t count) {
  if (p.name.ends_with("to_world")) return {2, 3, 4, 5, 6, 8, 9, 1, 3, 1, 7, 2, 0, 0, 0, 1};
  std::vector<float> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(1.25f + 0.125f * static_cast<float>(i));
  return values;
}

TEST(SceneParameters, EachIsReadBackAndChangesNoOther) {
  const SceneData before = scene_of_all();
  for (const SceneParameter& p : scene_parameters(before)) {
    if (p.name == "camera.to_world") continue;  // is made of others
    SceneData scene = before;
    const std::vector<float> values = other_values(p, p.get(before).size());
    std::size_t size = 1;
    for (const std::size_t n : p.shape) size *= n;
    EXPECT_EQ(size, values.size()) << p.name;
    p.set(scene, values);
    EXPECT_EQ(p.get(scene), values) << p.name;
    EXPECT_NE(p.get(before), values) << p.name;
    for (const SceneParameter& other : scene_parameters(before)) {
      if (other.name == "camera.to_world") continue;
      const SceneData& expected = other.name == p.name ? scene : before;
      EXPECT_EQ(other.get(scene), other.get(expected)) << other.name;
    }
  }
}

TEST(SceneParameters, AreWhatTheirNamesSay) {
  SceneData scene = scene_of_all();
  set(scene, "camera.origin", {1, 2, 3}), set(scene, "camera.target", {4, 5, 6});
  set(scene, "camera.up", {0, 0, 1}), set(scene, "camera.fov", {33});
  set(scene, "camera.aperture", {0.5f}), set(scene, "camera.focus_distance", {7});
  EXPECT_EQ(scene.camera.look_from, Vec3(1, 2, 3));
  EXPECT_EQ(scene.camera.look_at, Vec3(4, 5, 6));
  EXPECT_EQ(scene.camera.up, Vec3(0, 0, 1));
  EXPECT_EQ(scene.camera.fov_degrees, 33);
  EXPECT_EQ(scene.camera.aperture, 0.5f);
  EXPECT_EQ(scene.camera.focus_distance, 7);
  set(scene, "lights.lamp_2.radiance", {1, 2, 3}), set(scene, "lights.bulb_2.intensity", {4, 5, 6});
  EXPECT_EQ(scene.materials[1].emission.radiance, Color(1, 2, 3));
  EXPECT_EQ(scene.delta_lights[2].intensity, Color(4, 5, 6));
  set(scene, "lights.sky.nadir", {1, 1, 2}), set(scene, "lights.sky.zenith", {1, 2, 2});
  set(scene, "lights.sun.radiance", {9, 8, 7});
  EXPECT_EQ(scene.sky.nadir, Color(1, 1, 2));
  EXPECT_EQ(scene.sky.zenith, Color(1, 2, 2));
  EXPECT_EQ(scene.sun.radiance, Color(9, 8, 7));
  set(scene, "materials.material_3.weight", {0.75f});
  EXPECT_EQ(scene.materials[3].parameters[0].value.x, 0.75f);
  set(scene, "spheres.one_2.center", {5, 4, 3}), set(scene, "spheres.one_2.radius", {0.25f});
  EXPECT_EQ(scene.spheres[1].center, Vec3(5, 4, 3));
  EXPECT_EQ(scene.spheres[1].radius_squared, 0.0625f);
  for (const float none : {0.0f, -1.0f, 1e-30f, 1e30f})
    EXPECT_THROW(set(scene, "spheres.one_2.radius", {none}), Error);
  EXPECT_EQ(scene.spheres[1].radius_squared, 0.0625f);
  set(scene, "materials.one_2.albedo", {0.1f, 0.2f, 0.3f});
  EXPECT_EQ(scene.materials[1].color(0), Color(0.1f, 0.2f, 0.3f));
}

TEST(SceneParameters, TheViewIsOfOriginTargetAndUp) {
  SceneData scene = scene_of_all();
  set(scene, "camera.origin", {1, 2, 3}), set(scene, "camera.target", {1, 2, 5});
  const auto view = [&] {
    for (const SceneParameter& p : scene_parameters(scene))
      if (p.name == "camera.to_world") return affine_of(p.get(scene), "view");
    return Affine();
  };
  EXPECT_EQ(view(), translate({1, 2, 3}));  // x to the left
  set(scene, "camera.to_world", matrix_of(view()));
  EXPECT_EQ(scene.camera.look_at, Vec3(1, 2, 5)) << "the same view changes nothing";
  const Affine turned = translate({4, 5, 6}) * rotate({0, 1, 0}, 90);
  set(scene, "camera.to_world", matrix_of(turned));
  EXPECT_EQ(scene.camera.look_from, Vec3(4, 5, 6));
  EXPECT_LT(glm::length(normalize(scene.camera.look_at - Vec3(4, 5, 6)) - Vec3(1, 0, 0)), 1e-6f);
  EXPECT_LT(glm::length(scene.camera.up - Vec3(0, 1, 0)), 1e-6f);
  EXPECT_THROW(set(scene, "camera.to_world", matrix_of(scale({-1, 1, 1}))), Error);
}

TEST(SceneParameters, MotionIsOfKeysThatAscendAndCanBeInverted) {
  SceneData scene = scene_of_all();
  const auto parameter = [&](const std::string& name) {
    const auto all = scene_parameters(scene);
    return *std::ranges::find(all, name, &SceneParameter::name);
  };
  const auto error_of = [&](const std::string& name, const std::vector<TransformKey>& keys) {
    try {
      parameter(name).set_keys(scene, keys);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const float none = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::pair<std::vector<TransformKey>, const char*>> cases = {
      {{}, "0 key"},
      {{{0, {}}}, "1 key"},
      {{{0, {}}, {0, {}}}, "key 1 of its motion at 0 s; expected times that ascend"},
      {{{0, {}}, {none, {}}}, "key 1 of its motion at nan s"},
      {{{HUGE_VALF, {}}, {1, {}}}, "key 0 of its motion at inf s"},
      {{{0, {}}, {1, scale({1, 0, 1})}}, "key 1 of its motion; expected a transform that can"},
      {{{0, translate({none, 0, 0})}, {1, {}}}, "key 0 of its motion; expected a transform that"},
      {{{0, {}}, {1, scale({-1, 1, 1})}}, "key 1 of its motion mirrors other than key 0"}};
  for (const char* name : {"instances.1.to_world", "camera.to_world"}) {
    for (const auto& [keys, text] : cases) {
      const std::string error = error_of(name, keys);
      EXPECT_TRUE(error.starts_with(name)) << error;
      EXPECT_NE(error.find(text), std::string::npos) << error;
      EXPECT_FALSE(scene.moves()) << text;
    }
  }
  EXPECT_EQ(error_of("instances.1.to_world", {{0, translate({1, 2, 3})}, {1, {}}}), "");
  EXPECT_EQ(error_of("instances.0.to_world", {{0, {}}, {2, translate({1, 2, 3})}}), "");
  ASSERT_EQ(scene.motion.instances.size(), 2u);
  EXPECT_EQ(scene.motion.instances[1].instance, 0u);
  EXPECT_EQ(scene.instances[1].to_world, translate({1, 2, 3}));
  parameter("instances.1.to_world").set(scene, matrix_of(scale({2, 2, 2})));
  ASSERT_EQ(scene.motion.instances.size(), 1u);
  EXPECT_EQ(scene.motion.instances[0].keys.back().time, 2.0f);
  set(scene, "camera.shutter_open", {0.25f}), set(scene, "camera.shutter_close", {0.5f});
  EXPECT_EQ(scene.motion.shutter, (Shutter{0.25f, 0.5f}));
}

TEST(SceneParameters, NoLightTakesANegativeNumber) {
  for (const SceneParameter& p : scene_parameters(scene_of_all())) {
    if (!p.name.starts_with("lights.")) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      SceneData scene = scene_of_all();
      std::vector<float> values{1, 1, 1};
      values[i] = -1e-3f;
      EXPECT_THROW(p.set(scene, values), Error) << p.name << ' ' << i;
      EXPECT_EQ(p.get(scene), p.get(scene_of_all())) << p.name;
      values[i] = 0;
      EXPECT_NO_THROW(p.set(scene, values)) << p.name;
    }
  }
}

TEST(SceneParameters, AMapCanBeInvertedAndIsAffine) {
  for (const int i : {12, 13, 14, 15}) {
    SceneData scene = scene_of_all();
    std::vector<float> map{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    map[static_cast<std::size_t>(i)] += 1;
    EXPECT_THROW(set(scene, "instances.1.to_world", map), Error) << i;
  }
}

TEST(MaterialNames, ThoseOfNodesGoToWhatTheyAreMadeOf) {
  SceneData scene;
  const std::uint32_t a = scene.add_material(make_diffuse(Color(0.5f)));
  const std::uint32_t b = scene.add_material(make_diffuse(Color(0.5f)));
  const std::uint32_t c = scene.add_material(make_diffuse(Color(0.5f)));
  MaterialDescription blend = make_mapped(MaterialNode::blend, {}, 0);
  blend.children[0] = a, blend.children[1] = b;
  const std::uint32_t blended = scene.add_material(blend);
  const std::uint32_t bumped = scene.add_material(make_mapped(MaterialNode::bump_map, {}, c));
  scene.names.materials = {{blended, "mix"}, {bumped, "rough"}};
  EXPECT_EQ(material_names(scene),
            (std::vector<std::string>{"mix.0", "mix.1", "rough", "mix", "rough"}));
  scene.names.materials[a] = "mix.1";  // the name of another
  EXPECT_EQ(material_names(scene),
            (std::vector<std::string>{"mix.1", "mix.1_2", "rough", "mix", "rough"}));
}

}  // namespace
