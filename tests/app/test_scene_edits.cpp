// A scene that is edited between renders: whatever was kept, the image has the bits of one that was
// never prepared with other values.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "common/accel/embree/embree_tree.h"
#include "common/device/devices.h"
#include "common/scene/edit/scene_parameters.h"
#include "common/scene/prepare/prepare_scene.h"
#include "load/mitsuba_scene.h"
#include "render_words.h"
#include "scene/moving_room.h"

namespace {

using namespace pt;

RenderCommand edit_command(const OptionWords& more, const std::string& scene = "memory") {
  return command_from(
      {{"scene", scene}, {"width", "24"}, {"height", "18"}, {"spp", "1"}, {"device", "cpu"}}, more);
}

/// Other values that the parameter can have.
std::vector<float> edited_values(const SceneParameter& p, std::vector<float> values) {
  if (p.name.ends_with(".to_world")) {
    for (const std::size_t i : {3u, 7u, 11u}) values[i] += 0.125f;
  } else if (p.name.ends_with(".normals")) {
    for (std::size_t i = 0; i < values.size(); i += 3) {
      const Vec3 n = glm::normalize(Vec3(values[i] + 0.3f, values[i + 1], values[i + 2] - 0.2f));
      values[i] = n.x, values[i + 1] = n.y, values[i + 2] = n.z;
    }
  } else {
    for (float& x : values) x = 0.875f * x + 0.0625f;
  }
  return values;
}

/// A session and what can be changed in its scene, as a user has both.
struct Editor {
  explicit Editor(const SceneData& scene)
      : session(SceneData(scene)), parameters(scene_parameters(scene)) {}

  const SceneParameter& operator[](const std::string& name) const {
    const auto found = std::ranges::find(parameters, name, &SceneParameter::name);
    if (found == parameters.end()) throw Error("no " + name);
    return *found;
  }
  void set(const SceneParameter& p, std::span<const float> values) {
    session.change_scene(p.changes, [&](SceneData& scene) { p.set(scene, values); });
  }
  void set(const std::string& name, std::span<const float> values) { set((*this)[name], values); }
  void change(const SceneParameter& p) { set(p, edited_values(p, p.get(session.scene()))); }

  RenderSession session;
  std::vector<SceneParameter> parameters;
};

/// The session's next image and its report's counts are those of its scene prepared anew.
RenderResult expect_as_anew(RenderSession& session, const RenderCommand& command) {
  RenderResult edited = render_now(session, command);
  RenderSession fresh{SceneData(session.scene())};
  const RenderResult anew = render_now(fresh, command);
  EXPECT_EQ(differing_pixels(edited.image, anew.image), 0u);
  EXPECT_EQ(edited.report.scene.lights, anew.report.scene.lights);
  EXPECT_EQ(edited.report.plan, anew.report.plan);
  return edited;
}

/// The error of a render, or empty.
std::string error_of(RenderSession& session, const RenderCommand& command) {
  try {
    render_now(session, command);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// Changes each parameter of the scene, one after the other. Returns how many changed the image.
int expect_edits_as_anew(const SceneData& scene, const OptionWords& words) {
  const RenderCommand command = edit_command(words);
  Editor editor(scene);
  Image before = render_now(editor.session, command).image;
  int changed = 0;
  for (const SceneParameter& p : editor.parameters) {
    SCOPED_TRACE(p.name);
    const std::vector<float> old = p.get(editor.session.scene());
    editor.change(p);
    if (const std::string error = error_of(editor.session, command); !error.empty()) {
      RenderSession fresh{SceneData(editor.session.scene())};
      EXPECT_EQ(error_of(fresh, command), error);  // a masked sphere
      editor.set(p, old);
    }
    Image after = expect_as_anew(editor.session, command).image;
    changed += differing_pixels(before, after) > 0;
    before = std::move(after);
  }
  return changed;
}

constexpr const char* view = R"(<sensor type="perspective"><float name="fov" value="50"/>
  <transform name="to_world"><lookat origin="0.5, 2, 6" target="0, 0.5, 0" up="0, 1, 0"/></transform>
  </sensor>)";

constexpr const char* room = R"(
  <bsdf type="diffuse" id="red"><rgb name="reflectance" value="0.8, 0.3, 0.2"/></bsdf>
  <bsdf type="blendbsdf" id="blend"><float name="weight" value="0.4"/>
    <bsdf type="roughplastic"/><bsdf type="roughconductor"><float name="alpha" value="0.2"/></bsdf>
  </bsdf>
  <shape type="rectangle"><ref id="red"/>
    <transform name="to_world"><rotate x="1" angle="-90"/><scale value="3"/></transform></shape>
  <shape type="cylinder" id="tin"><ref id="blend"/>
    <transform name="to_world"><scale value="0.5"/><translate x="1" y="0.5" z="1"/></transform>
  </shape>
  <shape type="cube"><emitter type="area" id="lamp"><rgb name="radiance" value="4, 5, 6"/></emitter>
    <transform name="to_world"><scale value="0.3"/><translate x="-1" y="3"/></transform></shape>
  <shape type="cylinder" id="tube"><emitter type="area" id="neon"/>
    <transform name="to_world"><scale value="0.2"/><translate x="2" y="1"/></transform></shape>
  <emitter type="point" id="bulb"><point name="position" x="-2" y="2" z="3"/></emitter>)";

constexpr const char* instances = R"(
  <shape type="shapegroup" id="group"><shape type="cube" id="brick"><bsdf type="diffuse"/>
    <transform name="to_world"><scale value="0.4"/></transform></shape></shape>
  <shape type="instance"><ref id="group"/>
    <transform name="to_world"><translate x="-1" y="0.4"/></transform></shape>
  <shape type="instance"><ref id="group"/>
    <transform name="to_world"><rotate y="1" angle="30"/><translate y="1.2"/></transform></shape>)";

SceneData scene_of(const std::string& parts) { return load_xml(view + parts).scene; }

TEST(SceneEdits, EveryParameterWithEveryStructure) {
  const SceneData scene = scene_of(std::string(room) + instances);
  std::vector<OptionWords> all = {{{"mode", "serial"}},
                                  {{"mode", "megakernel"}},
                                  {{"mode", "wavefront"}},
                                  {{"device", "cpu:2"}},
                                  {{"accel", "bvh2"}, {"builder", "sah"}},
                                  {{"accel", "bvh2"}, {"builder", "sbvh"}},
                                  {{"accel", "cwbvh"}, {"builder", "sbvh"}},
                                  {{"accel", "cwbvh"}, {"builder", "sah-reinsert"}},
                                  {{"accel", "brute"}},
                                  {{"light-selection", "tree"}},
                                  {{"light-selection", "uniform"}}};
  if (!embree_version().empty()) all.push_back({{"accel", "embree"}});
  for (const OptionWords& words : all) {
    SCOPED_TRACE(words.front().second + (words.size() > 1 ? " " + words[1].second : ""));
    EXPECT_GE(expect_edits_as_anew(scene, words), 20);
  }
}

void expect_edits_on_cuda(const std::vector<OptionWords>& all) {
  const SceneData scene = scene_of(std::string(room) + instances);
  for (OptionWords words : all) {
    SCOPED_TRACE(words.front().second);
    words.emplace_back("device", "cuda");
    EXPECT_GE(expect_edits_as_anew(scene, words), 20);
  }
}

TEST(CudaSceneEdits, EveryParameterInEachMode) {
  if (list_devices().size() < 2) GTEST_SKIP() << "no CUDA device";
  expect_edits_on_cuda({{{"mode", "megakernel"}},
                        {{"mode", "wavefront"}},
                        {{"accel", "cwbvh"}, {"builder", "hploc"}},
                        {{"light-selection", "tree"}}});
}

// This one runs under compute-sanitizer, which reports false errors of graphs (docs/testing.md).
TEST(CudaSceneEdits, EveryParameterWithoutAGraph) {
  if (list_devices().size() < 2) GTEST_SKIP() << "no CUDA device";
  expect_edits_on_cuda({{{"mode", "megakernel"}}, {{"schedule", "host"}, {"mode", "wavefront"}}});
}

// A lamp that goes out and on, a mesh that deforms and is told to emit, and all else.
TEST(SceneEdits, OfWhatMoves) {
  for (const char* mode : {"megakernel", "wavefront"})
    EXPECT_GE(expect_edits_as_anew(moving_room(), {{"mode", mode}}), 4);
}

TEST(CudaSceneEdits, OfWhatMoves) {
  if (list_devices().size() < 2) GTEST_SKIP() << "no CUDA device";
  for (const char* mode : {"megakernel", "wavefront"})
    EXPECT_GE(expect_edits_as_anew(moving_room(), {{"mode", mode}, {"device", "cuda"}}), 4);
}

// The lights before and after have other places in their list.
TEST(SceneEdits, LightsOfWhatMovesGoOutAndOn) {
  SceneData scene = moving_room();
  scene.meshes[1].material = scene.add_material(make_diffuse(Color(0.5f), Color(0.2f)));
  const RenderCommand command = edit_command({{"spp", "4"}});
  RenderSession session{SceneData(scene)};
  render_now(session, command);
  constexpr SceneChanges changes{.shading = true, .lights = true};
  for (const float value : {0.0f, 0.3f}) {
    session.change_scene(
        changes, [&](SceneData& own) { own.materials.back().emission.radiance = Color(value); });
    expect_as_anew(session, command);
  }
  session.change_scene(changes, [](SceneData& own) {
    own.materials[own.meshes[3].material].emission.radiance = Color(1.0f);
  });
  expect_as_anew(session, command);  // what deforms shines, too
}

TEST(CudaSceneEdits, MaterialsAndLightsKeepTheRenderer) {
  if (list_devices().size() < 2) GTEST_SKIP() << "no CUDA device";
  const RenderCommand command = edit_command({{"device", "cuda"}, {"schedule", "host"}});
  Editor editor(scene_of(std::string(room) + instances));
  const RenderReport first = render_now(editor.session, command).report;
  for (const char* name : {"materials.red.albedo", "lights.lamp.radiance", "lights.sky.zenith"}) {
    editor.change(editor[name]);
    EXPECT_EQ(expect_as_anew(editor.session, command).report.setup_ms, first.setup_ms)
        << name << ": another renderer";
  }
}

// Whose bits those of a pbrt file are is for the tests of Python.
TEST(SceneEdits, OfMotion) {
  const RenderCommand command = edit_command({{"spp", "4"}});
  Editor editor(scene_of(std::string(room) + instances));
  const auto move = [&](const std::string& name, const std::vector<TransformKey>& keys) {
    const SceneParameter& p = editor[name];
    editor.session.change_scene(p.changes, [&](SceneData& scene) { p.set_keys(scene, keys); });
    EXPECT_EQ(p.get_keys(editor.session.scene()), keys);
  };
  const auto map = [&](const std::string& name) {
    return affine_of(editor[name].get(editor.session.scene()), name);
  };
  const Affine brick = map("instances.1.to_world"), camera = map("camera.to_world");
  const Image still = render_now(editor.session, command).image;
  Image before = still;
  const auto expect_other = [&](const char* what) {
    SCOPED_TRACE(what);
    const Image after = expect_as_anew(editor.session, command).image;
    EXPECT_GT(differing_pixels(before, after), 0u);
    before = after;
  };
  move("instances.1.to_world", {{0, brick}, {1, translate({1, 0, 0}) * brick}});
  expect_other("an instance");
  move("instances.0.to_world", {{0, brick}, {0.5f, brick * rotate({0, 1, 0}, 90)}, {2, brick}});
  expect_other("another one before it");
  editor.set("camera.shutter_close", std::vector{0.5f});
  expect_other("the shutter");
  editor.change(editor["materials.red.albedo"]);
  expect_other("a colour of what moves");
  move("camera.to_world", {{0, camera}, {1, camera * translate({0.5f, 0, 0})}});
  expect_other("the camera");
  const auto set_map = [&](const std::string& name, const Affine& to) {
    editor.set(name, matrix_of(to));
    EXPECT_TRUE(editor[name].get_keys(editor.session.scene()).empty());
  };
  set_map("camera.to_world", camera);
  expect_other("the camera stands");
  set_map("instances.1.to_world", brick);
  expect_other("one stands");
  move("camera.to_world", {{0, camera}, {1, camera * translate({0.5f, 0, 0})}});
  expect_other("the camera once more");
  editor.set("camera.up", std::vector<float>{0, 1, 0});
  EXPECT_TRUE(editor.session.scene().motion.camera.empty());
  expect_other("the camera stands again");
}

TEST(SceneEdits, MotionThatCannotBeBlurredIsHeldStill) {
  Editor editor(scene_of(std::string(room) + instances));
  const RenderCommand path = edit_command({}), mlt = edit_command({{"integrator", "mlt"}});
  const Image still = render_now(editor.session, mlt).image;
  const SceneParameter& p = editor["instances.1.to_world"];
  const Affine begin = affine_of(p.get(editor.session.scene()), p.name);
  editor.session.change_scene(p.changes, [&](SceneData& scene) {
    p.set_keys(scene, {{0, begin}, {1, translate({1, 0, 0}) * begin}});
  });
  const Image moving = render_now(editor.session, path).image;
  std::vector<std::string> warnings;
  MeasureHooks hooks;
  hooks.stop = [] { return false; };
  const auto render = [&] {
    warnings.clear();
    const auto warn = [&](const std::string& text) { warnings.push_back(text); };
    return editor.session.render(mlt, hooks, warn).image;
  };
  EXPECT_EQ(differing_pixels(render(), still), 0u);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("--integrator mlt knows no motion blur"), std::string::npos);
  EXPECT_EQ(differing_pixels(render_now(editor.session, path).image, moving), 0u);
  render();
  for (const char* name : {"camera.fov", "materials.red.albedo"}) {
    editor.change(editor[name]);
    const Image edited = render();
    EXPECT_TRUE(warnings.empty()) << name << ": " << warnings.front();  // was prepared anew
    SceneData stands = editor.session.scene();
    hold_still(stands);
    RenderSession other(std::move(stands));
    EXPECT_EQ(differing_pixels(edited, render_now(other, mlt).image), 0u) << name;
    EXPECT_GT(differing_pixels(edited, still), 0u) << name;
  }
  const RenderCommand strict = edit_command({{"integrator", "mlt"}, {"strict", "on"}});
  EXPECT_NE(error_of(editor.session, strict).find("knows no motion blur"), std::string::npos);
}

TEST(SceneEdits, VerticesThatAreSetNoLongerDeform) {
  SceneData deforming = moving_room();
  Mesh& floor = deforming.meshes.front();
  floor.normals.assign(floor.positions.size(), Vec3(0, 1, 0));
  ASSERT_FALSE(deforming.meshes[3].later_normals.empty());
  const RenderCommand command = edit_command({{"spp", "4"}});
  Editor editor(deforming);
  const Image before = render_now(editor.session, command).image;
  editor.change(editor["meshes.mesh_0.normals"]);  // of what stands beside what deforms
  EXPECT_GT(differing_pixels(expect_as_anew(editor.session, command).image, before), 0u);
  editor.change(editor["meshes.mesh_3.normals"]);
  deforming = editor.session.scene();
  EXPECT_TRUE(deforming.deforms());
  deforming.meshes[3].later_normals = {deforming.meshes[3].normals};
  RenderSession same(SceneData{deforming});
  EXPECT_EQ(differing_pixels(expect_as_anew(editor.session, command).image,
                             render_now(same, command).image),
            0u);
  editor.change(editor["meshes.mesh_3.vertices"]);
  const SceneData& now = editor.session.scene();
  deforming.meshes[3] = {
      now.meshes[3].positions, deforming.meshes[3].triangles, deforming.meshes[3].normals, {}};
  RenderSession stands(SceneData{deforming});
  EXPECT_EQ(differing_pixels(expect_as_anew(editor.session, command).image,
                             render_now(stands, command).image),
            0u);
}

// Where other materials, spheres, media or lights make preparation another one.
TEST(SceneEdits, EveryParameterOfOtherScenes) {
  const std::string sphere = R"(<shape type="sphere" id="ball"><bsdf type="dielectric"/>
    <point name="center" x="0" y="0.5" z="2"/><float name="radius" value="0.4"/></shape>)";
  const std::string fog = R"(<shape type="cube"><bsdf type="null"/>
    <medium type="homogeneous" name="interior"><float name="sigma_t" value="0.5"/></medium>
    <transform name="to_world"><scale value="4"/></transform></shape>)";
  const std::string mask =
      R"(<shape type="cube"><bsdf type="mask"><float name="opacity" value="0.5"/>
    <bsdf type="diffuse"/></bsdf></shape>)";
  const std::string sky = R"(<emitter type="sunsky"/>)";
  for (const std::string& parts :
       {room + sphere, room + sphere + instances, room + fog, room + mask, room + sky}) {
    SCOPED_TRACE(parts.substr(parts.size() - 200));
    EXPECT_GE(expect_edits_as_anew(scene_of(parts), {}), 15);
  }
  for (const char* name : {"spheres", "cornell", "terrain:500"}) {
    SCOPED_TRACE(name);
    const RenderSession loaded(edit_command({}, name), {});
    EXPECT_GE(expect_edits_as_anew(loaded.scene(), {}), 4);
  }
}

// 17 emitters, with the room's three, have a light tree, 16 a table; a black one is none.
TEST(SceneEdits, LightsGoOutAndOn) {
  std::string lamps;
  for (int i = 0; i < 14; ++i) {
    lamps += fmt::format(R"(<shape type="cube"><emitter type="area" id="l{}"/><transform
        name="to_world"><scale value="0.05"/><translate x="{}" y="2"/></transform></shape>)",
                         i, 0.3 * (i - 7));
  }
  for (const char* mode : {"megakernel", "wavefront"}) {
    const RenderCommand command = edit_command({{"mode", mode}});
    Editor editor(scene_of(room + lamps));
    render_now(editor.session, command);
    for (const auto& [name, value] : std::vector<std::pair<std::string, float>>{
             {"l1", 0}, {"neon", 0}, {"l1", 3}, {"neon", 2}, {"lamp", 0}}) {
      SCOPED_TRACE(name);
      editor.set("lights." + name + ".radiance", std::vector<float>(3, value));
      expect_as_anew(editor.session, command);
    }
  }
  {  // a tree that loses its last light
    const RenderCommand command =
        edit_command({{"mode", "wavefront"}, {"light-selection", "tree"}});
    Editor editor(scene_of(std::string(room) + R"(<emitter type="directional" id="far"/>)"));
    for (const float value : {0.0f, 2.0f}) {
      for (const char* name : {"lamp.radiance", "neon.radiance", "bulb.intensity"}) {
        SCOPED_TRACE(name);
        editor.set(std::string("lights.") + name, std::vector<float>(3, value));
        expect_as_anew(editor.session, command);
      }
    }
  }
  Editor editor(scene_of(room));  // opacity 1 and less: with masks and without
  render_now(editor.session, edit_command({}));
  for (const float opacity : {0.5f, 0.25f, 1.0f}) {
    editor.set("materials.red.opacity", std::vector{opacity});
    expect_as_anew(editor.session, edit_command({}));
  }
}

TEST(SceneEdits, KeepTheTreeAndTheRenderer) {
  const RenderCommand command = edit_command({{"accel", "cwbvh"}});
  Editor editor(scene_of(std::string(room) + instances));
  const RenderReport first = render_now(editor.session, command).report;
  const auto expect_kept = [&](const RenderReport& next) {
    EXPECT_GT(next.scene_ms, 0) << "not seen";
    EXPECT_EQ(next.scene.tree.build_ms, first.scene.tree.build_ms);
    EXPECT_EQ(next.setup_ms, first.setup_ms) << "another renderer";
  };
  for (const SceneParameter& p : editor.parameters) {
    if (p.changes.move_surfaces() || p.name.ends_with(".opacity")) continue;
    SCOPED_TRACE(p.name);
    editor.change(p);
    expect_kept(render_now(editor.session, command).report);
  }
  double cost = first.scene.tree.sah_cost;
  for (const char* name : {"instances.1.to_world", "meshes.tin.vertices", "meshes.tube.vertices"}) {
    SCOPED_TRACE(name);
    editor.change(editor[name]);
    const RenderReport next = expect_as_anew(editor.session, command).report;
    expect_kept(next);
    EXPECT_NE(next.scene.tree.sah_cost, cost) << "not measured again";
    cost = next.scene.tree.sah_cost;
  }
  EXPECT_EQ(render_now(editor.session, command).report.scene_ms, 0) << "nothing has changed";
}

// A tree is fitted until it costs a third more than when it was built.
TEST(SceneEdits, ARefitEndsWhereTheTreeIsBad) {
  const RenderSession terrain(edit_command({}, "terrain:2000"), {});
  for (const char* accel : {"bvh2", "cwbvh"}) {
    SCOPED_TRACE(accel);
    const RenderCommand command = edit_command({{"accel", accel}, {"builder", "sah"}});
    Editor editor(terrain.scene());
    const TreeFacts built = render_now(editor.session, command).report.scene.tree;
    std::vector<Vec3> points = terrain.scene().meshes[0].positions;
    const auto move = [&](const auto& change) {
      for (Vec3& p : points) p = change(p);
      editor.set("meshes.mesh_0.vertices", {&points.front().x, 3 * points.size()});
      return expect_as_anew(editor.session, command).report.scene.tree;
    };
    const TreeFacts bent = move([](Vec3 p) { return p * Vec3(1, 1.2f, 1); });
    EXPECT_EQ(bent.build_ms, built.build_ms);
    EXPECT_LT(bent.sah_cost, 4.0 / 3.0 * built.sah_cost);
    std::mt19937 random(1);
    std::ranges::shuffle(points, random);
    const TreeFacts shuffled = move([](Vec3 p) { return p; });
    RenderSession fresh{SceneData(editor.session.scene())};
    const TreeFacts anew = render_now(fresh, command).report.scene.tree;
    EXPECT_NE(shuffled.build_ms, built.build_ms) << "not built anew";
    EXPECT_GT(shuffled.sah_cost, 4.0 / 3.0 * built.sah_cost);
    EXPECT_EQ(shuffled.sah_cost, anew.sah_cost);
    EXPECT_EQ(shuffled.nodes, anew.nodes);
    const TreeFacts moved = move([](Vec3 p) { return p + Vec3(0.5f); });
    EXPECT_EQ(moved.build_ms, shuffled.build_ms) << "compared with the first tree";
  }
}

// What cannot be is refused at the next render, and the one after it is right.
TEST(SceneEdits, GoOnAfterAnError) {
  const RenderCommand command = edit_command({});
  Editor editor(scene_of(room));
  render_now(editor.session, command);
  const SceneParameter& vertices = editor["meshes.tin.vertices"];
  const std::vector<float> old = vertices.get(editor.session.scene());
  editor.set(vertices, std::vector<float>(old.size(), 1e13f));
  for (int i = 0; i < 2; ++i)
    EXPECT_NE(error_of(editor.session, command).find("expected finite coordinates"),
              std::string::npos);
  editor.set(vertices, old);
  expect_as_anew(editor.session, command);
  EXPECT_THROW(editor.set("camera.origin", std::vector<float>(3, HUGE_VALF)), Error);
  EXPECT_EQ(render_now(editor.session, command).report.scene_ms, 0) << "nothing has changed";
}

}  // namespace
