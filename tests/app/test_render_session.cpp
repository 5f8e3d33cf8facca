// A scene that is rendered again: whatever was kept, the image is that of a scene loaded anew.
#include <gtest/gtest.h>

#include "common/film/checkpoint.h"
#include "render_words.h"
#include "temp_folder.h"

namespace {

using namespace pt;

using Words = OptionWords;

RenderCommand command_of(const std::string& scene, const Words& more = {}) {
  return command_from(
      {{"scene", scene}, {"width", "32"}, {"height", "24"}, {"spp", "2"}, {"device", "cpu"}}, more);
}

/// Renders the scene by each of these, one after the other, and compares with a session each.
void expect_same_as_anew(const std::string& scene, const std::vector<Words>& commands) {
  RenderSession kept(command_of(scene), {});
  for (const Words& words : commands) {
    const RenderCommand command = command_of(scene, words);
    RenderSession fresh(command, {});
    const Image image = render_now(kept, command).image;
    EXPECT_EQ(differing_pixels(image, render_now(fresh, command).image), 0u)
        << scene << " --" << words.front().first << ' ' << words.front().second;
  }
}

TEST(RenderSession, OptionsOfOneRenderDoNotStayInTheNext) {
  expect_same_as_anew(
      "cornell", {{{"seed", "1"}},
                  {{"seed", "2"}},
                  {{"mode", "megakernel"}},
                  {{"look-from", "250,250,-700"}},
                  {{"look-from", "250,250,-700"}, {"accel", "bvh2"}, {"kernel-set", "general"}},
                  {{"filter", "gaussian"}},
                  {{"crop", "3,4,20,20"}},
                  {{"nee", "off"}},
                  {{"kernel-set", "general"}},
                  {{"kernel-set", "general"}, {"look-from", "250,250,-700"}},
                  {{"seed", "1"}}});
  expect_same_as_anew("spheres", {{{"seed", "1"}}, {{"look-from", "5,3,2"}}, {{"fov", "60"}}});
}

// One message tells what ended a render and whether its samples are in the checkpoint.
TEST(RenderSession, AnErrorLeavesTheCheckpointAndSaysSo) {
  const TempFolder folder;
  const std::string file = folder.file("c/c.exr");
  for (const bool has_folder : {true, false}) {
    std::filesystem::create_directory(folder.file("c"));
    const RenderCommand command =
        command_of("cornell", {{"checkpoint", file}, {"spp", "64"}, {"threads", "1"}});
    RenderSession session(command, {});
    MeasureHooks hooks;
    hooks.stop = [] { return false; };
    hooks.progress = [&](std::uint64_t done, std::uint64_t) {
      if (done == 0) return;
      if (!has_folder) std::filesystem::remove_all(folder.file("c"));
      throw Error("broken");
    };
    expect_error(
        [&] { session.render(command, hooks, {}); },
        has_folder ? "broken; ptexp resume " + file + " goes on" : "broken; cannot write " + file);
    if (has_folder) {
      EXPECT_GT(read_checkpoint(file).film.samples(), 0u);
    }
  }
}

// Whatever changes between two passes, the second one's image is that of a session that never
// rendered anything else.
TEST(RenderSession, PassesAddSamplesUntilSomethingChanges) {
  for (const std::string device : {"cpu", "cpu:2"}) {
    SCOPED_TRACE(device);
    const Words words{{"device", device}};
    RenderSession session(command_of("terrain:2000", words), {});
    const auto expect_pass = [&](const Words& more, int samples, int in_all) {
      Words all = words;
      all.insert(all.end(), more.begin(), more.end());
      const RenderPass pass = session.add_pass(command_of("terrain:2000", all), samples, {}, {});
      EXPECT_EQ(pass.run.samples_done, samples);
      EXPECT_EQ(pass.samples, in_all);
      all.emplace_back("spp", std::to_string(in_all));
      RenderSession fresh(command_of("terrain:2000", all), {});
      fresh.change_camera() = session.scene().camera;
      EXPECT_EQ(
          differing_pixels(pass.image, render_now(fresh, command_of("terrain:2000", all)).image),
          0u);
    };
    expect_pass({}, 1, 1);
    expect_pass({}, 1, 2);
    expect_pass({}, 2, 4);
    session.change_camera().look_from.x += 0.1f;
    expect_pass({}, 2, 2);
    expect_pass({}, 1, 3);
    expect_pass({{"mode", "megakernel"}}, 1, 1);
    expect_pass({{"mode", "megakernel"}}, 1, 2);
    render_now(session, command_of("terrain:2000", words));  // two samples
    expect_pass({}, 1, 3);
  }
}

TEST(RenderSession, KeepsTheSceneOrItsTree) {
  RenderSession session(command_of("terrain:2000"), {});
  const RenderResult first = render_now(session, command_of("terrain:2000"));
  EXPECT_GT(first.report.scene_ms, 0);
  EXPECT_EQ(render_now(session, command_of("terrain:2000")).report.scene_ms, 0);
  session.change_camera().fov_degrees = 20;
  const RenderResult moved = render_now(session, command_of("terrain:2000"));
  EXPECT_GT(differing_pixels(moved.image, first.image), 0u);
  EXPECT_EQ(moved.report.scene.tree.build_ms, first.report.scene.tree.build_ms) << "built anew";
  const RenderResult by_options =
      render_now(session, command_of("terrain:2000", {{"look-from", "3,2,1"}, {"fov", "30"}}));
  EXPECT_GT(differing_pixels(by_options.image, moved.image), 0u);
  EXPECT_EQ(by_options.report.scene.tree.build_ms, first.report.scene.tree.build_ms)
      << "options of the camera need no other tree";
}

TEST(RenderSession, KeepsTheTreeWherePlansAgree) {
  RenderSession session(command_of("terrain:2000"), {});
  const auto built_ms = [&](const Words& words) {
    const RenderResult result = render_now(session, command_of("terrain:2000", words));
    EXPECT_EQ(result.report.process_ms.start, 0);
    EXPECT_GT(result.report.process_ms.render, 0);
    return result.report.scene.tree.build_ms;
  };
  const double first = built_ms({{"mode", "wavefront"}, {"accel", "cwbvh"}});
  EXPECT_EQ(built_ms({{"mode", "megakernel"}, {"accel", "cwbvh"}}), first);
  EXPECT_EQ(built_ms({{"mode", "wavefront"}, {"accel", "cwbvh"}, {"pool-size", "64"}}), first);
  EXPECT_EQ(built_ms({{"accel", "cwbvh"}, {"width", "40"}}), first);
  const double other = built_ms({{"accel", "bvh2"}});
  EXPECT_NE(other, first);
  EXPECT_NE(built_ms({{"accel", "bvh2"}, {"builder", "sbvh"}}), other);
}

// What a file asks for holds where the command says nothing.
TEST(RenderSession, OptionsGoBeforeTheScenesOwn) {
  SceneDefaults defaults;
  defaults.width = 40, defaults.height = 30, defaults.spp = 7, defaults.max_depth = 9;
  defaults.rr_depth = 3, defaults.crop = CropWindow{1, 2, 20, 21};
  Options options;
  apply_defaults(defaults, {}, options);
  EXPECT_EQ(options.width, 40);
  EXPECT_EQ(options.height, 30);
  EXPECT_EQ(options.spp, 7);
  EXPECT_EQ(options.max_depth, 9);
  EXPECT_EQ(options.rr_depth, 3);
  EXPECT_EQ(options.crop->x1, 20);
  Options given;
  given.width = 50, given.height = 60, given.spp = 2, given.max_depth = 4, given.rr_depth = 1;
  given.crop = CropWindow{0, 0, 45, 55};
  apply_defaults(defaults, {"width", "height", "spp", "max-depth", "rr"}, given);
  EXPECT_EQ(given.width, 50);
  EXPECT_EQ(given.height, 60);
  EXPECT_EQ(given.spp, 2);
  EXPECT_EQ(given.max_depth, 4);
  EXPECT_EQ(given.rr_depth, 1);
  EXPECT_EQ(given.crop->x1, 45);
  // An option that is given keeps only its own value.
  const std::pair<const char*, int Options::*> fields[] = {{"width", &Options::width},
                                                           {"height", &Options::height},
                                                           {"spp", &Options::spp},
                                                           {"max-depth", &Options::max_depth},
                                                           {"rr", &Options::rr_depth}};
  for (const auto& [name, field] : fields) {
    Options one;
    one.*field = 100;
    apply_defaults(defaults, {name}, one);
    for (const auto& [other, other_field] : fields)
      EXPECT_EQ(one.*other_field, other_field == field ? 100 : options.*other_field) << other;
  }
  // A stop decides instead of the number of samples, unless that is given.
  for (const bool has_time : {false, true}) {
    Options stopped;
    has_time ? stopped.time_limit = 1 : stopped.target_error = 0.1f;
    apply_defaults(defaults, {"spp"}, stopped);
    EXPECT_EQ(stopped.spp, Options().spp);
    apply_defaults(defaults, {}, stopped);
    EXPECT_EQ(stopped.spp, INT32_MAX);
  }
}

TEST(RenderSession, GoesOnAfterAnError) {
  RenderSession session(command_of("cornell"), {});
  const Image before = render_now(session, command_of("cornell")).image;
  EXPECT_THROW(render_now(session, command_of("cornell", {{"crop", "0,0,33,5"}})), Error);
  EXPECT_THROW(
      render_now(session, command_of("cornell", {{"look-from", "1,1,1"}, {"look-at", "1,1,1"}})),
      Error);
  EXPECT_EQ(differing_pixels(render_now(session, command_of("cornell")).image, before), 0u);
}

}  // namespace
