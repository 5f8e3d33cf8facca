// A renderer goes on where its last render ended, shows its image between batches, and looks
// through another camera: every image is that of a new renderer that renders it at once.
#include <gtest/gtest.h>

#include "common/device/devices.h"
#include "common/render/dispatch.h"
#include "common/scene/prepare/prepare_scene.h"
#include "mode_cases.h"

namespace pt {
namespace {

struct PassCase {
  std::string device, mode, scene;
  Settings settings{};
};

std::string name_of(const PassCase& one) {
  std::string name = one.device + " " + one.mode + " " + one.scene;
  for (const auto& [key, value] : one.settings) name += " --" + key + " " + value;
  return name;
}

std::vector<PassCase> pass_cases() {
  std::vector<std::string> devices{"cpu"};
  if (choose_device({}).choice.kind == DeviceChoice::Kind::cuda) devices.push_back("cuda");
  std::vector<PassCase> cases;
  for (const std::string& device : devices) {
    for (const std::string mode : {"serial", "megakernel", "wavefront"}) {
      if (device == "cuda" && mode == "serial") continue;
      cases.push_back({device, mode, "cornell"});
      cases.push_back({device, mode, "boxes", {{"aov", "albedo,variance"}}});
      cases.push_back({device, mode, "boxes", {{"filter", "mitchell"}, {"crop", "3,2,30,20"}}});
    }
    cases.push_back({device, "wavefront", "cornell", {{"schedule", "host"}}});
  }
  return cases;
}

Options options_of(const PassCase& one, const Settings& more = {}) {
  const Options options = with(Options(), {{"device", one.device},
                                           {"mode", one.mode},
                                           {"scene", one.scene},
                                           {"width", "37"},
                                           {"height", "23"},
                                           {"spp", "9"},
                                           {"max-depth", "5"}});
  return with(with(options, one.settings), more);
}

/// A renderer of these options, and the scene that it views.
struct Ready {
  explicit Ready(const Options& options)
      : device(choose_device(options.device)),
        scene(make_scene_for(options, device)),
        renderer(make_renderer(options, scene, device)) {}

  DeviceInfo device;
  SceneData scene;
  std::unique_ptr<Renderer> renderer;
};

Image at_once(const PassCase& one, const Settings& more = {}) {
  return render_options(options_of(one, more)).image;
}

void expect_same_image(const Image& a, const Image& b) {
  EXPECT_EQ(a.rgb, b.rgb);
  ASSERT_EQ(a.layers.size(), b.layers.size());
  for (std::size_t i = 0; i < a.layers.size(); ++i)
    EXPECT_EQ(a.layers[i].values, b.layers[i].values) << a.layers[i].name;
}

TEST(Passes, GiveTheBitsOfOneRender) {
  for (const PassCase& one : pass_cases()) {
    SCOPED_TRACE(name_of(one));
    const Ready ready(options_of(one));
    const auto& renderer = ready.renderer;
    int done = 0;
    for (const int samples : {1, 1, 2, 5}) {
      EXPECT_EQ(renderer->add(samples, {}).samples_done, samples);
      done += samples;
      if (done != 3)
        expect_same_image(renderer->image(), at_once(one, {{"spp", std::to_string(done)}}));
    }
    renderer->render({});  // of spp samples, whatever was before
    expect_same_image(renderer->image(), at_once(one));
    renderer->add(2, {});
    expect_same_image(renderer->image(), at_once(one, {{"spp", "11"}}));
  }
}

TEST(Passes, GoOnAfterOneThatWasCutShort) {
  for (const PassCase& one : pass_cases()) {
    SCOPED_TRACE(name_of(one));
    const Ready ready(options_of(one));
    const auto& renderer = ready.renderer;
    RenderHooks hooks;
    hooks.stop = [] { return true; };
    hooks.stops.seconds = 1e6;  // the first batch has one sample
    EXPECT_EQ(renderer->add(6, hooks).samples_done, 1);
    EXPECT_EQ(renderer->add(8, {}).samples_done, 8);
    expect_same_image(renderer->image(), at_once(one));
  }
}

TEST(Passes, OfMarkovChainsAreRefused) {
  const Ready ready(options_of({"cpu", "megakernel", "cornell", {{"integrator", "mlt"}}}));
  EXPECT_THROW(ready.renderer->add(1, {}), Error);
}

// In a scene of triangles: move_camera refuses spheres, whose bounds depend on its place.
TEST(Cameras, OfARendererCanBeChanged) {
  const Settings moved{{"look-from", "0.3,0.7,2.5"}, {"look-at", "0,0.4,0"}, {"fov", "50"}};
  for (const PassCase& one : pass_cases()) {
    if (one.scene != "boxes") continue;
    for (const std::string accel : {"bvh2", "cwbvh"}) {
      PassCase general = one;
      general.scene = "terrain:2000";
      general.settings.emplace_back("accel", accel);
      SCOPED_TRACE(name_of(general));
      Ready ready(options_of(general));
      const auto& renderer = ready.renderer;
      renderer->render({});
      const CameraParameters first = ready.scene.camera;
      const Options after = options_of(general, moved);
      ASSERT_TRUE(move_camera(ready.scene, first, after));
      const Camera camera = make_camera(ready.scene.camera, after.width, after.height);
      ASSERT_TRUE(renderer->set_camera(camera));
      renderer->add(2, {});
      Settings two = moved;
      two.emplace_back("spp", "2");
      expect_same_image(renderer->image(), at_once(general, two));
      renderer->render({});
      expect_same_image(renderer->image(), at_once(general, moved));
    }
  }
}

}  // namespace
}  // namespace pt
