// A scene that is edited between renders: whatever was kept, the image has the bits of one that was
// never prepared with other values.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "app/options/check_options.h"
#include "app/render/render_session.h"
#include "common/accel/embree/embree_tree.h"
#include "common/image/compare/compare.h"
#include "common/scene/edit/scene_parameters.h"
#include "load/mitsuba_scene.h"

namespace {

using namespace pt;

using EditWords = std::vector<std::pair<std::string, std::string>>;

RenderCommand edit_command(const EditWords& more, const std::string& scene = "memory") {
  EditWords words{
      {"scene", scene}, {"width", "24"}, {"height", "18"}, {"spp", "2"}, {"device", "cpu"}};
  words.insert(words.end(), more.begin(), more.end());
  std::vector<Setting> settings;
  for (const auto& [name, value] : words) settings.push_back({&find_option(name), value});
  return make_render_command(settings);
}

RenderResult render_now(RenderSession& session, const RenderCommand& command) {
  MeasureHooks hooks;
  hooks.stop = [] { return false; };
  return session.render(command, hooks, {});
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

void set_by_name(RenderSession& session, const std::string& name, std::span<const float> values) {
  for (const SceneParameter& p : scene_parameters(session.scene())) {
    if (p.name == name)
      return session.change_scene(p.changes, [&](SceneData& scene) { p.set(scene, values); });
  }
  FAIL() << "no " << name;
}

/// The session's next image and its report's counts are those of its scene prepared anew.
RenderResult expect_as_anew(RenderSession& session, const RenderCommand& command) {
  RenderResult edited = render_now(session, command);
  RenderSession fresh{SceneData(session.scene())};
  const RenderResult anew = render_now(fresh, command);
  EXPECT_EQ(compare_images(edited.image, anew.image, 0).differing_pixels, 0u);
  EXPECT_EQ(edited.report.scene.lights, anew.report.scene.lights);
  EXPECT_EQ(edited.report.plan, anew.report.plan);
  return edited;
}

/// Changes each parameter of the scene, one after the other. Returns how many changed the image.
int expect_edits_as_anew(const SceneData& scene, const EditWords& words) {
  const RenderCommand command = edit_command(words);
  RenderSession session{SceneData(scene)};
  Image before = render_now(session, command).image;
  int changed = 0;
  for (const SceneParameter& p : scene_parameters(scene)) {
    SCOPED_TRACE(p.name);
    set_by_name(session, p.name, edited_values(p, p.get(session.scene())));
    Image after = expect_as_anew(session, command).image;
    changed += compare_images(before, after, 0).differing_pixels > 0;
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
  <shape type="cube" id="box"><ref id="blend"/>
    <transform name="to_world"><scale value="0.5"/><translate x="1" y="0.5" z="1"/></transform>
  </shape>
  <shape type="cube"><emitter type="area" id="lamp"><rgb name="radiance" value="4, 5, 6"/></emitter>
    <transform name="to_world"><scale value="0.3"/><translate x="-1" y="3"/></transform></shape>
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
  std::vector<EditWords> all = {{{"mode", "serial"}},
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
  for (const EditWords& words : all) {
    SCOPED_TRACE(words.front().second + (words.size() > 1 ? " " + words[1].second : ""));
    EXPECT_GE(expect_edits_as_anew(scene, words), 20);
  }
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

// 17 emitters, with the room's two, have a light tree, 16 a table; a black one is none.
TEST(SceneEdits, LightsGoOutAndOn) {
  std::string lamps;
  for (int i = 0; i < 15; ++i) {
    lamps += fmt::format(R"(<shape type="cube"><emitter type="area" id="l{}"/><transform
        name="to_world"><scale value="0.05"/><translate x="{}" y="2"/></transform></shape>)",
                         i, 0.3 * (i - 7));
  }
  const RenderCommand command = edit_command({});
  for (const char* mode : {"megakernel", "wavefront"}) {
    const RenderCommand by_mode = edit_command({{"mode", mode}});
    RenderSession session(scene_of(room + lamps));
    render_now(session, by_mode);
    for (const auto& [name, value] : std::vector<std::pair<std::string, float>>{
             {"l1", 0}, {"lamp", 0}, {"l1", 3}, {"lamp", 2}}) {
      const std::vector<float> radiance(3, value);
      set_by_name(session, "lights." + name + ".radiance", radiance);
      expect_as_anew(session, by_mode);
    }
  }
  RenderSession session(scene_of(room));  // opacity 1 and less: with masks and without
  render_now(session, command);
  for (const float opacity : {0.5f, 0.25f, 1.0f}) {
    set_by_name(session, "materials.red.opacity", std::vector{opacity});
    expect_as_anew(session, command);
  }
}

TEST(SceneEdits, KeepTheTreeAndTheRenderer) {
  const RenderCommand command = edit_command({{"accel", "cwbvh"}});
  RenderSession session(scene_of(std::string(room) + instances));
  const RenderReport first = render_now(session, command).report;
  for (const auto& p : scene_parameters(session.scene())) {
    if (p.changes.move_surfaces() || p.name.ends_with(".opacity")) continue;
    SCOPED_TRACE(p.name);
    set_by_name(session, p.name, edited_values(p, p.get(session.scene())));
    const RenderReport next = render_now(session, command).report;
    EXPECT_EQ(next.scene.tree.build_ms, first.scene.tree.build_ms);
    EXPECT_EQ(next.setup_ms, first.setup_ms) << "another renderer";
  }
  for (const char* name : {"instances.1.to_world", "meshes.box.vertices"}) {
    SCOPED_TRACE(name);
    for (const SceneParameter& p : scene_parameters(session.scene())) {
      if (p.name == name) set_by_name(session, name, edited_values(p, p.get(session.scene())));
    }
    const RenderReport next = expect_as_anew(session, command).report;
    EXPECT_EQ(next.scene.tree.build_ms, first.scene.tree.build_ms);
    EXPECT_EQ(next.setup_ms, first.setup_ms) << "another renderer";
    EXPECT_NE(next.scene.tree.sah_cost, first.scene.tree.sah_cost) << "not measured again";
  }
  const RenderReport again = render_now(session, command).report;
  EXPECT_EQ(again.scene_ms, 0) << "nothing has changed";
}

// A tree is fitted until it costs a third more than when it was built.
TEST(SceneEdits, ARefitEndsWhereTheTreeIsBad) {
  for (const EditWords& words :
       std::vector<EditWords>{{{"accel", "bvh2"}}, {{"accel", "cwbvh"}, {"builder", "sbvh"}}}) {
    const RenderCommand command = edit_command(words);
    RenderSession session(edit_command({}, "terrain:2000"), {});
    TreeFacts built = render_now(session, command).report.scene.tree;
    const std::string name = "meshes.mesh_0.vertices";
    std::vector<Vec3> points = session.scene().meshes[0].positions;
    const auto move = [&](const auto& change) {
      for (Vec3& p : points) p = change(p);
      set_by_name(session, name, {&points.front().x, 3 * points.size()});
      const TreeFacts tree = expect_as_anew(session, command).report.scene.tree;
      RenderSession fresh{SceneData(session.scene())};
      return std::pair(tree, render_now(fresh, command).report.scene.tree);
    };
    const auto [bent, bent_anew] = move([](Vec3 p) { return p * Vec3(1, 1.2f, 1); });
    EXPECT_EQ(bent.build_ms, built.build_ms);
    EXPECT_LT(bent.sah_cost, 4.0 / 3.0 * built.sah_cost);
    std::mt19937 random(1);
    std::ranges::shuffle(points, random);
    const auto [shuffled, shuffled_anew] = move([](Vec3 p) { return p; });
    EXPECT_NE(shuffled.build_ms, built.build_ms) << "not built anew";
    EXPECT_EQ(shuffled.sah_cost, shuffled_anew.sah_cost);
    EXPECT_EQ(shuffled.nodes, shuffled_anew.nodes);
    const auto [moved, moved_anew] = move([](Vec3 p) { return p + Vec3(0.5f); });
    EXPECT_EQ(moved.build_ms, shuffled.build_ms) << "compared with the first tree";
  }
}

// What cannot be is refused at the next render, and the one after it is right.
TEST(SceneEdits, GoOnAfterAnError) {
  const RenderCommand command = edit_command({});
  const SceneData scene = scene_of(room);
  RenderSession session{SceneData(scene)};
  render_now(session, command);
  const auto box =
      std::ranges::find(scene.names.meshes, "box", [](const auto& p) { return p.second; });
  ASSERT_NE(box, scene.names.meshes.end());
  const std::vector<Vec3> vertices = scene.meshes[box->first].positions;
  const std::vector<float> far(3 * vertices.size(), 1e13f);
  set_by_name(session, "meshes.box.vertices", far);
  EXPECT_THROW(render_now(session, command), Error);
  EXPECT_THROW(render_now(session, command), Error);
  set_by_name(session, "meshes.box.vertices", {&vertices[0].x, 3 * vertices.size()});
  expect_as_anew(session, command);
  const SceneParameter bad = scene_parameters(session.scene()).front();
  EXPECT_THROW(
      session.change_scene(
          bad.changes, [&](SceneData& scene) { bad.set(scene, std::vector<float>(3, HUGE_VALF)); }),
      Error);
  EXPECT_EQ(render_now(session, command).report.scene_ms, 0) << "nothing has changed";
}

}  // namespace
