// What the page of a live render is told: values, not their form. And what of a render's options
// its modes keep.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "render_words.h"
#include "view/change_settings.h"
#include "view/live_render.h"
#include "view/view_site.h"

namespace pt {
namespace {

std::vector<Setting> page_settings(const OptionWords& more = {}) {
  return settings_from({{"scene", "cornell"},
                        {"output", "page.png"},
                        {"width", "16"},
                        {"height", "12"},
                        {"device", "cpu"},
                        {"spp", "7"}},
                       more);
}

/// Nobody watches, so that nothing is rendered.
struct Page {
  LiveRender live{page_settings(), {}};
  ViewSite site;
  double now_s = 0;

  explicit Page(int port = 4000) : site(live, "token", port, [this] { return now_s; }) {}

  HttpReply get(const std::string& name, const std::map<std::string, std::string>& query = {}) {
    return site.answer({"GET", "/token/" + name, query, "", "", ""});
  }
  HttpReply post(const std::string& name, const std::string& body) {
    return site.answer({"POST", "/token/" + name, {}, "", "", body});
  }
  int status_for(const std::string& host, const std::string& origin = {},
                 const std::string& path = "/token/settings") {
    const auto refused = site.refuse({"POST", path, {}, host, origin, ""});
    return refused ? refused->status : 200;
  }
  nlohmann::json state() { return nlohmann::json::parse(get("state").body); }
};

TEST(ViewSite, TellsTheStateAsItIs) {
  Page page;
  ASSERT_EQ(
      page.post(
              "settings",
              R"({"orbit": {"yaw": 10, "pitch": -5, "zoom": 1.5}, "mode": "split", "exposure": -2.5})")
          .status,
      204);
  const nlohmann::json state = page.state();
  EXPECT_EQ(state["scene"], "cornell");
  EXPECT_EQ(state["device"], page.live.device());
  EXPECT_EQ(state["spp"], 7);
  EXPECT_EQ(state["status"], "idle");
  EXPECT_EQ(state["error"], "");
  EXPECT_EQ(state["mode"], "split");
  EXPECT_EQ(state["exposure"], -2.5);
  EXPECT_EQ(state["size"], (nlohmann::json{16, 12}));
  EXPECT_EQ(state["layer"], "color");
  EXPECT_EQ(state["paused"], false);
  EXPECT_TRUE(state["ratio"].is_null());
  EXPECT_EQ(state["orbit"], (nlohmann::json{{"yaw", 10}, {"pitch", -5}, {"zoom", 1.5}}));
  const PitchRange range = pitch_range(page.live.camera());
  EXPECT_EQ(state["pitch_range"], (nlohmann::json{range.least, range.most}));
  EXPECT_LT(range.least, range.most);
  ASSERT_EQ(state["views"].size(), 2u);
  EXPECT_EQ(state["views"][0]["mode"], "wavefront");
  EXPECT_EQ(state["views"][1]["mode"], "megakernel");
  EXPECT_EQ(state["views"][0]["samples"], 0);
  EXPECT_EQ(state["views"][0]["image"], 0);
  EXPECT_EQ(state["version"], page.live.state().version);
  EXPECT_EQ(page.get("image", {{"mode", "wavefront"}}).status, 204);
  EXPECT_EQ(page.get("image", {{"mode", "quick"}}).status, 404);
}

// One pass of several: each number is that of the view.
TEST(ViewSite, TellsWhatItsPassesTook) {
  Page page;
  page.live.set_watched(true);
  LiveState now = page.live.state();
  for (int i = 0; i < 600 && now.status != LiveStatus::done; ++i)
    now = page.live.wait(now.version, 0.2);
  ASSERT_EQ(now.status, LiveStatus::done);
  const LiveView& view = now.views.at(0);
  EXPECT_LT(view.pass_samples, view.samples);
  const nlohmann::json told = page.state()["views"].at(0);
  EXPECT_EQ(told["samples"], view.samples);
  EXPECT_EQ(told["pass_samples"], view.pass_samples);
  EXPECT_EQ(told["pass_ms"], view.pass_ms);
  EXPECT_EQ(told["msamples_per_s"], view.msamples_per_s);
  EXPECT_EQ(told["image"], view.image_number);
  EXPECT_EQ(page.state()["status"], "done");
  EXPECT_NEAR(view.msamples_per_s, 16 * 12 * view.pass_samples / view.pass_ms / 1e3, 1e-9);
  // A picture is made anew for each exposure.
  const std::string mode = told["mode"];
  const std::string first = page.get("image", {{"mode", mode}}).body;
  EXPECT_EQ(page.get("image", {{"mode", mode}}).body, first);
  page.post("settings", R"({"exposure": 3})");
  EXPECT_NE(page.get("image", {{"mode", mode}}).body, first);
  page.post("settings", nlohmann::json{{"exposure", now.display.exposure}}.dump());
  EXPECT_EQ(page.get("image", {{"mode", mode}}).body, first);
}

TEST(ViewSite, TakesWhatItTells) {
  Page page;
  const std::string name = page.live.parameters().front().parameter.name;
  const nlohmann::json change = {
      {"size", {20, 10}}, {"scale", 0.5},     {"spp", 3},
      {"layer", "depth"}, {"exposure", 1.5},  {"curve", "neutral"},
      {"paused", true},   {"mode", "serial"}, {"parameters", {{name, {0.25, 0.5, 1.0}}}}};
  ASSERT_EQ(page.post("settings", change.dump()).status, 204);
  const nlohmann::json state = page.state();
  for (const auto& [key, value] : change.items()) EXPECT_EQ(state[key], value) << key;
  EXPECT_EQ(state["status"], "paused");
  ASSERT_EQ(page.post("settings", R"({"parameters": null, "paused": false})").status, 204);
  EXPECT_TRUE(page.state()["parameters"].empty());
  EXPECT_EQ(page.state()["status"], "idle");
  EXPECT_EQ(page.post("settings", R"({"parameters": {"materials.x": 1}, "spp": 9})").status, 400);
  EXPECT_EQ(page.state()["spp"], 3) << "all or nothing";
  const auto list = nlohmann::json::parse(page.get("parameters").body);
  ASSERT_EQ(list.size(), page.live.parameters().size());
  EXPECT_EQ(list.front()["name"], name);
  EXPECT_EQ(list.front()["value"], nlohmann::json(page.live.parameters().front().value));
}

TEST(ViewSite, SavesNothingBeforeThereIsAnImage) {
  Page page;
  EXPECT_EQ(page.get("save", {{"mode", "auto"}, {"form", "png"}}).status, 404);
  page.live.set_watched(true);
  LiveState now = page.live.state();
  for (int i = 0; i < 600 && now.status != LiveStatus::done; ++i)
    now = page.live.wait(now.version, 0.2);
  EXPECT_EQ(page.get("save", {{"mode", "auto"}, {"form", "jpg"}}).status, 400);
  EXPECT_EQ(page.get("save", {{"mode", "serial"}, {"form", "png"}}).status, 404);
  const HttpReply saved = page.get("save", {{"mode", "auto"}, {"form", "exr"}});
  EXPECT_EQ(saved.status, 200);
  EXPECT_EQ(saved.headers.at("Content-Disposition"), "attachment; filename=\"cornell.exr\"");
}

// A browser leaves out port 80, and no other.
TEST(ViewSite, KnowsItsOwnNames) {
  Page page(4000), plain(80);
  for (const char* host : {"127.0.0.1:4000", "localhost:4000"})
    EXPECT_EQ(page.status_for(host), 200);
  for (const char* host : {"127.0.0.1", "localhost", "127.0.0.1:80", "example.com:4000", ""})
    EXPECT_EQ(page.status_for(host), 403) << host;
  for (const char* host : {"127.0.0.1:80", "localhost:80", "127.0.0.1", "localhost"})
    EXPECT_EQ(plain.status_for(host), 200) << host;
  EXPECT_EQ(plain.status_for("127.0.0.1:8080"), 403);
  const char* own = "127.0.0.1:4000";
  EXPECT_EQ(page.status_for(own, "http://localhost:4000"), 200);
  for (const char* origin :
       {"http://localhost", "https://localhost:4000", "http://example.com", "null"})
    EXPECT_EQ(page.status_for(own, origin), 403) << origin;
  for (const char* path : {"/token", "/token/state", "/tokem/settings", "/token/settings/", "/"})
    EXPECT_EQ(page.status_for(own, "", path), 404) << path;
}

TEST(ViewSite, LimitsOfItsQueries) {
  Page page;
  const auto status = [&](const char* name, const std::string& value) {
    return page.get("state", {{name, value}}).status;
  };
  EXPECT_EQ(status("viewer", std::string(64, 'v')), 200);
  EXPECT_EQ(status("viewer", std::string(65, 'v')), 400);
  EXPECT_EQ(status("after", "0"), 200);
  EXPECT_EQ(status("after", "18446744073709551615"), 200);
  EXPECT_EQ(status("after", "18446744073709551616"), 400);
  EXPECT_EQ(status("after", "1 "), 400);
}

// A viewer is there for 2.5 seconds after he asked.
TEST(ViewSite, RendersWhileSomebodyIsThere) {
  Page page;
  page.now_s = 10;
  page.get("state", {{"viewer", "a"}});
  EXPECT_NE(page.live.state().status, LiveStatus::idle);
  page.now_s = 12.4;
  page.site.look_for_viewers();
  EXPECT_NE(page.live.state().status, LiveStatus::idle);
  page.now_s = 12.6;
  page.site.look_for_viewers();
  const LiveStatus after = page.live.state().status;
  EXPECT_TRUE(after == LiveStatus::idle || after == LiveStatus::done);
}

// The camera is the session's, which an orbit moves; the options of the image and of the mode stay.
TEST(ModeCommand, LeavesTheCameraToTheSession) {
  const std::vector<Setting> settings = page_settings({{"look-from", "1,2,3"},
                                                       {"look-at", "0,0,1"},
                                                       {"up", "0,0,1"},
                                                       {"fov", "33"},
                                                       {"aperture", "0.1"},
                                                       {"focus-distance", "2"},
                                                       {"max-depth", "3"},
                                                       {"pool-size", "1000"}});
  const RenderCommand wave = mode_command(settings, Mode::wavefront);
  const CameraOverrides& camera = wave.options.camera;
  EXPECT_FALSE(camera.look_from || camera.look_at || camera.up || camera.vertical_fov_degrees ||
               camera.aperture || camera.focus_distance);
  EXPECT_EQ(wave.options.max_depth, 3);
  EXPECT_EQ(wave.options.spp, 7);
  EXPECT_EQ(wave.options.width, 16);
  EXPECT_EQ(wave.options.mode, Mode::wavefront);
  EXPECT_TRUE(wave.given.contains("pool-size"));
  const RenderCommand serial = mode_command(settings, Mode::serial);
  EXPECT_EQ(serial.options.mode, Mode::serial);
  EXPECT_FALSE(serial.given.contains("pool-size"));
}

}  // namespace
}  // namespace pt
