// Megakernel and wavefront on the CPU give the serial program's image, bit for bit, and trace the
// same rays, whatever the options that say how. The serial program itself is compared with a loop
// over pixels and samples that knows no batch, no film and no schedule.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <map>

#include "common/accel/trace_cpu/ray_block.h"
#include "common/render/batches.h"
#include "common/render/dispatch.h"
#include "common/render/settings_of.h"
#include "common/sampling/random.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/transport/generate_camera_path.h"
#include "common/transport/shade_miss.h"
#include "common/transport/shade_surface.h"
#include "mode_cases.h"

namespace pt {
namespace {

// Small, odd, and no multiple of a block or a range.
constexpr const char *width = "45", *height = "29", *spp = "5";
// For pools of a few slots, which need a wave for each of their rays.
constexpr const char *tiny_width = "13", *tiny_height = "7";

/// Sum over a pixel's samples, in their order.
struct PixelSum {
  glm::dvec3 radiance{0};
  std::uint64_t rays = 0, shadow_rays = 0;
  std::vector<std::uint64_t> live;

  void count_ray(std::size_t k) {
    if (live.size() <= k) live.resize(k + 1);
    ++live[k], ++rays;
  }
};

template <class Traits, class Draw>
Color follow_path(const Scene& scene, std::uint32_t pixel, const PathSettings& settings,
                  const Draw& draw, PixelSum& sum) {
  PathState path;
  Color radiance(0.0f);
  Ray ray = generate_camera_path(scene, pixel, draw(scatter_block(0)));
  while (true) {
    sum.count_ray(path.rays++);
    const Hit hit = intersect_closest<Traits>(scene, ray);
    if (hit.is_miss()) {
      return radiance + miss_radiance<Traits::lighting>(scene, ray.direction, path, settings.mis);
    }
    const Vec4 u = draw(scatter_block(path.rays));
    const Vec4 light = Traits::has_lights ? draw(light_block(path.rays)) : Vec4(0.0f);
    const Scattering s =
        surface_scattering<Traits>(scene, ray, hit, path, settings, EagerShading{u, light});
    radiance += s.emitted;
    if (!is_black(s.shadow.radiance)) {
      ++sum.shadow_rays;
      if (!intersect_shadow<Traits>(scene, s.shadow)) radiance += s.shadow.radiance;
    }
    if (!s.alive) return radiance;
    ray = s.ray;
  }
}

PixelSum plain_pixel(const SceneData& scene, const Options& options, std::uint32_t x,
                     std::uint32_t y) {
  const Scene view = host_view(scene, options.width, options.height);
  const std::uint32_t pixel = x | y << 16;
  PixelSum sum;
  for (std::uint32_t sample = 0; sample < static_cast<std::uint32_t>(options.spp); ++sample) {
    XorwowState state;
    xorwow_init(xorwow_seed(options.seed, {pixel, sample, 0}), state);
    auto philox = PhiloxSource{options.seed}.open({pixel, sample, 0});
    const auto draw = [&](std::uint32_t block) {
      Vec4 u = philox.draw(block);
      for (int i = 0; i < 4 && options.rng == RngKind::xorwow; ++i) {
        u[i] = static_cast<float>(xorwow_next(state) >> 8) / 16777216.0f;
      }
      return u;
    };
    dispatch_traits(CpuKindsWith<PhiloxSource>{}, scene.traits, [&](auto traits) {
      sum.radiance += glm::dvec3(
          follow_path<decltype(traits)>(view, pixel, path_settings_of(options), draw, sum));
    });
  }
  return sum;
}

void expect_pixel(const Image& image, std::uint32_t x, std::uint32_t y, const PixelSum& sum,
                  int samples) {
  const float* found = image.pixel(static_cast<int>(x), static_cast<int>(y));
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(found[c], static_cast<float>(sum.radiance[c] * (1.0 / samples)))
        << "pixel " << x << ", " << y << ", channel " << c;
  }
}

/// Every scene with what changes its image. Closed scenes are dearer: their paths never escape.
const std::vector<ImageKind> image_kinds = [] {
  std::vector<ImageKind> kinds;
  for (const std::string scene : {"spheres", "rtow", "cornell", "furnace"}) {
    const bool closed = scene == "cornell" || scene == "furnace";
    const auto add = [&](const std::string& name, const Settings& more) {
      Settings settings{{"scene", scene}, {"width", width}, {"height", height}, {"spp", spp}};
      if (closed) settings.emplace_back("max-depth", "9");
      settings.insert(settings.end(), more.begin(), more.end());
      kinds.push_back({scene + "_" + name, settings});
    };
    add("bvh2", {{"accel", "bvh2"}});
    add("xorwow", {{"rng", "xorwow"}, {"seed", "1099511627779"}});
    add("depth_1", {{"max-depth", "1"}});
    add("tiny", {{"width", tiny_width}, {"height", tiny_height}});
    if (scene != "rtow") add("brute", {{"accel", "brute"}});
    if (closed) add("depth_50", {{"width", "31"}, {"height", "17"}, {"max-depth", "50"}});
    if (!closed) add("lens", {{"aperture", "1.5"}, {"focus-distance", "9"}, {"max-depth", "3"}});
  }
  return kinds;
}();

/// While it exists, there are as many threads as asked for, even on a smaller machine.
class ManyThreads {
 private:
  tbb::global_control limit_{tbb::global_control::max_allowed_parallelism, 8};
};

class ModesOf : public testing::TestWithParam<ImageKind> {
 protected:
  Options options(const std::string& mode) const {
    Options result = with(Options(), GetParam().settings);
    apply(result, {{"device", "cpu"}, {"mode", mode}});
    return result;
  }
  bool is_tiny() const { return options("serial").width == std::stoi(tiny_width); }

 private:
  ManyThreads threads_;
};
INSTANTIATE_TEST_SUITE_P(Images, ModesOf, testing::ValuesIn(image_kinds),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(ModesOf, SerialIsALoopOverPixelsAndSamples) {
  const Options serial = options("serial");
  const Rendered rendered = render_options(serial);
  expect_plausible(rendered, serial);
  const SceneData scene = make_scene_for(serial, choose_device(serial.device));
  PathCounts counts;
  for (int y = 0; y < serial.height; ++y) {
    for (int x = 0; x < serial.width; ++x) {
      const auto px = static_cast<std::uint32_t>(x), py = static_cast<std::uint32_t>(y);
      const PixelSum sum = plain_pixel(scene, serial, px, py);
      expect_pixel(rendered.image, px, py, sum, serial.spp);
      if (HasFailure()) return;
      counts.rays += sum.rays, counts.shadow_rays += sum.shadow_rays;
      if (counts.live_paths.size() < sum.live.size()) counts.live_paths.resize(sum.live.size());
      for (std::size_t k = 0; k < sum.live.size(); ++k) counts.live_paths[k] += sum.live[k];
    }
  }
  counts.paths = counts.live_paths[0];
  expect_same_counts(rendered.counts, counts);
}

TEST_P(ModesOf, MegakernelEqualsSerial) {
  const std::vector<Choice> choices{{"threads", {"2", "1", "3", "7"}},
                                    {"work", names_of(Work::persistent)},
                                    {"branching", names_of(Branching::divergent)}};
  expect_all_same(options("megakernel"), variations(choices, 5, 1), options("serial"));
}

TEST_P(ModesOf, WavefrontEqualsSerial) {
  std::vector<Choice> choices{{"threads", {"2", "1", "3", "7"}},
                              {"compaction", names_of(Compaction::atomic)},
                              {"pool-size", {"auto", "1000", "4096", "6525", "6526"}},
                              {"regenerate", {"on", "off"}},
                              {"finish-paths", {"0", "1", "700", "131072"}},
                              {"layout", names_of(PoolLayout::soa)},
                              {"stages", names_of(Stages::split, {Stages::fused})},
                              {"order-surfaces", {"auto", "on"}},
                              {"branching", names_of(Branching::divergent)}};
  // Also about the 32 slots of a block, for one thread and for two.
  if (is_tiny()) choices[2].values = {"7", "1", "31", "32", "33", "64", "65", "455", "auto"};
  expect_all_same(options("wavefront"), variations(choices, 8, 2), options("serial"));
}

TEST_P(ModesOf, FusedStagesEqualSerial) {
  std::vector<Choice> choices{{"threads", {"2", "1", "7"}},
                              {"compaction", names_of(Compaction::atomic)},
                              {"pool-size", {"1000", "auto", "4096", "6525", "6526"}},
                              {"regenerate", {"on", "off"}},
                              {"finish-paths", {"0", "1", "700", "131072"}},
                              {"layout", names_of(PoolLayout::soa)},
                              {"wave-rays", {"1", "2", "3", "50"}}};
  if (is_tiny()) choices[2].values = {"7", "1", "64", "455", "auto"};
  expect_all_same(with(options("wavefront"), {{"stages", "fused"}}), variations(choices, 8, 6),
                  options("serial"));
}

// And where they are not traced in blocks, which pays more.
TEST(Stages, AreFusedWhereRaysAreCheap) {
  const auto stages = [](const Settings& more) {
    Options options = with(Options(), {{"device", "cpu"}, {"width", "16"}, {"height", "8"}});
    apply(options, more);
    return report_of(options).stages;
  };
  for (const char* scene : {"spheres", "cornell"}) {
    const auto of = [&](Settings more) {
      more.insert(more.end(), {{"scene", scene}, {"accel", "brute"}});
      return stages(more);
    };
    SCOPED_TRACE(scene);
    EXPECT_EQ(of({}), brute_block() != nullptr ? "split" : "fused");
    EXPECT_EQ(of({{"stages", "fused"}}), "fused");
    EXPECT_EQ(of({{"stages", "split"}}), "split");
    EXPECT_EQ(of({{"mode", "megakernel"}}), "");
    // What fused stages do not know.
    EXPECT_EQ(of({{"branching", "reduced"}}), "split");
    EXPECT_EQ(of({{"order-surfaces", "on"}}), "split");
  }
  EXPECT_EQ(stages({{"accel", "bvh2"}}), "split");
  EXPECT_EQ(stages({{"scene", "boxes"}}), "split");
  EXPECT_EQ(stages({{"scene", "boxes"}, {"stages", "fused"}}), "fused");
}

/// Three batches of three samples; with 10, the last is shorter than the others.
Options batch_options(const std::string& mode, const std::string& samples = "9") {
  return with(Options(), {{"device", "cpu"},
                          {"mode", mode},
                          {"width", "512"},
                          {"height", "500"},
                          {"spp", samples},
                          {"spheres", "3"},
                          {"max-depth", "3"}});
}

class Batches : public testing::Test {
 private:
  ManyThreads threads_;
};

TEST_F(Batches, DoNotChangeTheImage) {
  const Options serial = batch_options("serial", "10");
  const SceneData scene = make_scene_for(serial, choose_device(serial.device));
  const Rendered expected = render_options(serial);
  expect_plausible(expected, serial);
  TestRandom random;
  for (int i = 0; i < 2000; ++i) {
    const std::uint32_t x = random.below(512), y = random.below(500);
    expect_pixel(expected.image, x, y, plain_pixel(scene, serial, x, y), 10);
  }
  expect_same(render_options(batch_options("megakernel", "10")), expected);
  for (const std::string& compaction : names_of(Compaction::atomic)) {
    SCOPED_TRACE(compaction);
    Options wavefront = with(batch_options("wavefront", "10"), {{"compaction", compaction}});
    expect_same(render_options(wavefront), expected);
  }
}

// A generator's state begins anew in each batch.
TEST_F(Batches, DoNotChangeTheImageOfXorwow) {
  const Settings xorwow{{"rng", "xorwow"}};
  const Options serial = with(batch_options("serial"), xorwow);
  const SceneData scene = make_scene_for(serial, choose_device(serial.device));
  const Rendered expected = render_options(serial);
  TestRandom random;
  for (int i = 0; i < 1000; ++i) {
    const std::uint32_t x = random.below(512), y = random.below(500);
    expect_pixel(expected.image, x, y, plain_pixel(scene, serial, x, y), 9);
  }
  expect_same(render_options(with(batch_options("megakernel"), xorwow)), expected);
  expect_same(render_options(with(batch_options("wavefront"), xorwow)), expected);
}

// Samples of a scene with lamps gather light in the buffer, which is not that of the last batch.
TEST_F(Batches, ASecondRenderIsAsTheFirst) {
  for (const char* scene : {"cornell", "boxes"}) {
    for (const std::string& mode : names_of(Mode::serial)) {
      SCOPED_TRACE(testing::Message() << scene << ", " << mode);
      const Options options = with(Options(), {{"device", "cpu"},
                                               {"mode", mode},
                                               {"scene", scene},
                                               {"width", "24"},
                                               {"height", "16"},
                                               {"spp", "4"},
                                               {"max-depth", "5"}});
      const DeviceInfo device = choose_device(options.device);
      const SceneData made = make_scene_for(options, device);
      const auto renderer = make_renderer(options, made, device);
      const Rendered first = take_image(*renderer);
      expect_plausible(first, options);
      expect_same(take_image(*renderer), first);
    }
  }
}

using Progress = std::vector<std::pair<std::uint64_t, std::uint64_t>>;

/// Notes the progress and stops after so many batches.
RenderHooks stop_after(std::size_t batches, Progress& progress) {
  return {
      [&progress](std::uint64_t done, std::uint64_t total) { progress.emplace_back(done, total); },
      [&progress, batches] { return progress.size() >= batches; }};
}

TEST_F(Batches, AnInterruptionLeavesTheImageOfTheSamplesTaken) {
  constexpr std::uint64_t pixels = 512 * 500, total = 9 * pixels;
  const Options serial = batch_options("serial");
  std::map<int, Rendered> expected;  // by samples: how many a batch has depends on the time
  const auto after = [&](int samples) -> const Rendered& {
    const auto [entry, is_new] = expected.try_emplace(samples);
    if (is_new) entry->second = render_options(with(serial, {{"spp", std::to_string(samples)}}));
    return entry->second;
  };
  for (const std::string& mode : names_of(Mode::serial)) {
    const Options options = batch_options(mode);
    const DeviceInfo device = choose_device(options.device);
    const SceneData scene = make_scene_for(options, device);
    const auto renderer = make_renderer(options, scene, device);
    // The third time, the same renderer renders all, as if nothing had happened.
    for (const std::size_t batches : {1, 2, 1000}) {
      SCOPED_TRACE(testing::Message() << mode << ", stopped after " << batches);
      Progress progress;
      const Rendered stopped = take_image(*renderer, stop_after(batches, progress));
      const int samples = stopped.run.samples_done;
      EXPECT_TRUE(progress.size() == batches || samples == 9) << progress.size();
      EXPECT_EQ(progress.back(), std::pair(static_cast<std::uint64_t>(samples) * pixels, total));
      expect_same(stopped, after(samples));
      if (batches == 1) {
        EXPECT_EQ(samples, 1) << "of unknown duration";
      }
      if (batches == 1000) {
        EXPECT_EQ(samples, 9);
      }
    }
  }
}

// An abandoned batch leaves nothing in the image, and the same renderer renders all afterwards.
TEST_F(Batches, AnAbandonedBatchLeavesTheSamplesBeforeIt) {
  const Options serial = batch_options("serial");
  const Rendered one = render_options(with(serial, {{"spp", "1"}}));
  const Rendered all = render_options(serial);
  for (const std::string& mode : names_of(Mode::serial)) {
    SCOPED_TRACE(mode);
    const Options options = batch_options(mode);
    const DeviceInfo device = choose_device(options.device);
    const SceneData scene = make_scene_for(options, device);
    const auto renderer = make_renderer(options, scene, device);
    std::atomic<bool> is_second = false;
    RenderHooks hooks;
    hooks.progress = [&](std::uint64_t, std::uint64_t) { is_second = true; };
    hooks.cancel = [&] { return is_second.load(); };
    const Rendered cut = take_image(*renderer, hooks);
    EXPECT_EQ(cut.run.samples_done, 1);
    EXPECT_EQ(cut.run.ended_by, RunEnd::interrupted);
    expect_same(cut, one);
    expect_same(take_image(*renderer), all);
  }
}

TEST(BatchPaces, GiveBatchesOfHalfASecond) {
  BatchPace pace(1000);
  EXPECT_EQ(pace.next(64, 10), 64) << "few enough whatever they cost";
  EXPECT_EQ(pace.next(500, 10), 100);
  EXPECT_EQ(pace.next(500, 5000), 1) << "at least one";
  pace.note(1000, 0.01);  // 100,000 paths a second
  EXPECT_EQ(pace.next(1 << 30, 10), 5000);
  EXPECT_EQ(pace.next(7000, 10), 7000) << "little more than half a second";
  pace.note(1000, 0.0);  // says nothing
  EXPECT_EQ(pace.next(1 << 30, 10), 5000);
}

}  // namespace
}  // namespace pt
