// On a GPU all modes give the same image, bit for bit, and trace the same rays, whatever the
// options that say how. CPU and GPU round differently, so between them the image is only close.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iostream>
#include <optional>
#include <thread>

#include "common/accel/build/build_triangle_tree.h"
#include "common/device/cuda/create_world.h"
#include "common/error/error.h"
#include "common/image/compare/compare.h"
#include "cuda_test.h"
#include "mode_cases.h"

namespace pt {
namespace {

// Small enough for compute-sanitizer, odd, and no multiple of a block.
constexpr const char *width = "67", *height = "41", *spp = "5";
// For pools of a few slots, which need a wave for each of their rays.
constexpr const char *tiny_width = "13", *tiny_height = "7";
// For the comparison with the CPU.
constexpr int compared_width = 200, compared_height = 100, compared_spp = 16;

/// Every scene with what changes its image.
const std::vector<ImageKind> image_kinds = [] {
  std::vector<ImageKind> kinds;
  for (const std::string scene : {"spheres", "rtow", "cornell", "furnace"}) {
    const auto add = [&](const std::string& name, const Settings& more) {
      Settings settings{{"scene", scene}, {"width", width}, {"height", height}, {"spp", spp}};
      settings.insert(settings.end(), more.begin(), more.end());
      kinds.push_back({scene + "_" + name, settings});
    };
    add("brute", {{"accel", "brute"}});
    add("bvh2", {{"accel", "bvh2"}});
    if (scene == "spheres" || scene == "rtow") {  // which have no lamps
      add("brute_xorwow", {{"accel", "brute"}, {"rng", "xorwow"}, {"seed", "1099511627779"}});
    }
    add("depth_1", {{"max-depth", "1"}});
    add("depth_3", {{"max-depth", "3"}});
    add("tiny", {{"width", tiny_width}, {"height", tiny_height}, {"max-depth", "5"}});
  }
  return kinds;
}();

const std::vector<Choice> shared_choices{{"scene-memory", names_of(SceneMemory::automatic)},
                                         {"branching", names_of(Branching::divergent)}};

/// With the paper's toggles, each of them alone, where brute force scans: CUDA has no others.
std::vector<Settings> with_toggles(std::vector<Choice> choices, int combinations,
                                   std::uint64_t seed, const Options& options) {
  choices.insert(choices.end(), shared_choices.begin(), shared_choices.end());
  std::vector<Settings> all = variations(choices, combinations, seed);
  for (Settings& settings : all) {
    std::string& branching = settings[settings.size() - 1].second;
    std::string& memory = settings[settings.size() - 2].second;
    if (!has_plan(with(options, settings))) memory = "auto";
    if (!has_plan(with(options, settings))) branching = "divergent";
  }
  return planned(options, all);
}

class GpuModesOf : public CudaTest, public testing::WithParamInterface<ImageKind> {
 protected:
  Options options(const std::string& mode) const { return cuda_options(mode, GetParam().settings); }
  bool is_tiny() const { return options("megakernel").width == std::stoi(tiny_width); }
};
INSTANTIATE_TEST_SUITE_P(Cuda, GpuModesOf, testing::ValuesIn(image_kinds),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(GpuModesOf, MegakernelDoesNotDependOnHow) {
  const Options usual = options("megakernel");
  const std::vector<Choice> choices = {
      {"block", {"16x16", "4x4", "8x8", "32x32", "5x3", "1024x1", "1x1024", "64x1", "1x1"}},
      {"work", names_of(Work::persistent)}};
  expect_all_same(usual, with_toggles(choices, 12, 3, usual), usual);
}

TEST_P(GpuModesOf, WavefrontEqualsMegakernel) {
  std::vector<Choice> choices = {
      {"compaction", names_of(Compaction::atomic)},
      {"schedule", names_of(Schedule::graph, {Schedule::automatic})},
      {"regenerate", {"on", "off"}},
      {"pool-size", {"auto", "1000", "4097", "13734", "13735", "13736", "1M"}},
      {"finish-paths", {"0", "1", "700", "131072"}},
      {"stage-block",
       {"256", "1", "2", "16", "33", "1024",
        "generate=32,intersect=64,shade_miss=96,shade_surface=128,shadow=160,finish=192,"
        "accumulate=224"}},
      {"layout", names_of(PoolLayout::soa)},
      {"order-surfaces", {"auto", "on"}},
      {"stages", names_of(Stages::split, {Stages::fused})}};
  if (is_tiny()) {
    choices[3].values = {"7", "1", "64", "455", "auto"};
    choices[5].values = {"256", "16", "33", "1024"};
  }
  const Options usual = options("wavefront");
  expect_all_same(usual, with_toggles(choices, 24, 4, usual), options("megakernel"));
}

TEST_P(GpuModesOf, FusedStagesEqualMegakernel) {
  std::vector<Choice> choices = {
      {"compaction", names_of(Compaction::atomic)},
      {"schedule", names_of(Schedule::graph, {Schedule::automatic})},
      {"regenerate", {"on", "off"}},
      {"pool-size", {"auto", "1000", "4097", "13734", "13735", "13736", "1M"}},
      {"finish-paths", {"0", "1", "700", "131072"}},
      {"stage-block", {"256", "1", "33", "1024", "generate=32,bounce=96,finish=192"}},
      {"layout", names_of(PoolLayout::sectors)},
      {"wave-rays", {"1", "2", "3", "50"}},
      {"scene-memory", names_of(SceneMemory::automatic)}};
  if (is_tiny()) {
    choices[3].values = {"7", "1", "64", "455", "auto"};
    choices[5].values = {"256", "16", "33", "1024"};
  }
  const Options fused = with(options("wavefront"), {{"stages", "fused"}});
  expect_all_same(fused, planned(fused, variations(choices, 24, 6)), options("megakernel"));
}

/// Scenes with triangles, in each structure.
const std::vector<ImageKind> triangle_kinds = [] {
  std::vector<ImageKind> kinds;
  for (const std::string scene : {"boxes", "statue:3K", "terrain:3K", "instances:20"}) {
    for (const std::string& accel : structures(AccelKind::bvh2, {AccelKind::brute})) {
      const std::string name = scene.substr(0, scene.find(':'));
      Settings settings{{"scene", scene}, {"width", width},   {"height", height},
                        {"spp", spp},     {"max-depth", "6"}, {"accel", accel}};
      kinds.push_back({name + "_" + accel, settings});
      settings.emplace_back("builder", "");
      for (const std::string& builder : names_where(TreeBuilder::hploc, is_device_builder)) {
        settings.back().second = builder;
        kinds.push_back({name + "_" + accel + "_" + builder, settings});
        std::ranges::replace(kinds.back().name, '-', '_');
      }
    }
  }
  kinds.push_back({"roulette",
                   {{"scene", "boxes"},
                    {"width", width},
                    {"height", height},
                    {"spp", spp},
                    {"accel", "cwbvh"},
                    {"rr", "3"}}});
  const Settings boxes{{"scene", "boxes"}, {"width", width},   {"height", height},
                       {"spp", spp},       {"accel", "cwbvh"}, {"max-depth", "6"}};
  const std::vector<Choice> ways{{"light-selection", names_besides(LightSelection::automatic)},
                                 {"mis", names_besides(MisHeuristic::power)},
                                 {"sampling", names_besides(DirectionSampling::bsdf)},
                                 {"sampler", names_besides(SamplerKind::independent)},
                                 {"filter", names_besides(FilterKind::box)}};
  for (const Choice& way : ways) {
    for (const std::string& value : way.values) {
      std::string name = way.option + "_" + value;
      std::ranges::replace(name, '-', '_');
      kinds.push_back({name, boxes});
      kinds.back().settings.emplace_back(way.option, value);
    }
  }
  kinds.push_back({"forest",
                   {{"scene", "instances:3K"},
                    {"width", width},
                    {"height", height},
                    {"spp", spp},
                    {"accel", "cwbvh"},
                    {"max-depth", "8"}}});
  kinds.push_back({"no_light_sampling",
                   {{"scene", "boxes"},
                    {"width", width},
                    {"height", height},
                    {"spp", spp},
                    {"accel", "cwbvh"},
                    {"nee", "off"},
                    {"max-depth", "6"}}});
  return kinds;
}();

class GpuTrianglesOf : public CudaTest, public testing::WithParamInterface<ImageKind> {
 protected:
  Options options(const std::string& mode) const { return cuda_options(mode, GetParam().settings); }
  /// By the megakernel, whose loop walks wide trees of triangles alone.
  Options reference() const {
    const Options megakernel = options("megakernel");
    return has_plan(megakernel) ? megakernel : with(megakernel, {{"accel", "bvh2"}});
  }
};
INSTANTIATE_TEST_SUITE_P(Cuda, GpuTrianglesOf, testing::ValuesIn(triangle_kinds),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(GpuTrianglesOf, WavefrontEqualsMegakernel) {
  const std::vector<Choice> choices = {
      {"compaction", names_of(Compaction::atomic)},
      {"schedule", names_of(Schedule::graph, {Schedule::automatic})},
      {"regenerate", {"on", "off"}},
      {"order-surfaces", {"auto", "on", "off"}},
      {"persistent", {"on", "off"}},
      {"pool-size", {"auto", "1000", "4097", "1M"}},
      {"finish-paths", {"0", "700", "131072"}},
      {"stage-block", {"256", "33", "512"}},
      {"layout", names_of(PoolLayout::soa)}};
  const Options usual = options("wavefront");
  expect_all_same(usual, planned(usual, variations(choices, 6, 5)), reference());
}

TEST_P(GpuTrianglesOf, FusedStagesEqualMegakernel) {
  const std::vector<Choice> choices = {
      {"compaction", names_of(Compaction::atomic)},
      {"schedule", names_of(Schedule::graph, {Schedule::automatic})},
      {"pool-size", {"auto", "1000", "4097"}},
      {"wave-rays", {"1", "2"}},
      {"finish-paths", {"0", "700"}},
      {"layout", names_of(PoolLayout::sectors)}};
  const Options fused = with(options("wavefront"), {{"stages", "fused"}});
  expect_all_same(fused, planned(fused, variations(choices, 4, 7)), reference());
}

// The structure and its builder are a matter of speed alone.
TEST_P(GpuTrianglesOf, StructureDoesNotChangeTheImage) {
  Options other = options("wavefront");
  const Rendered expected = render_options(other);
  other.builder = TreeBuilder::sah;
  other.accel = AccelKind::bvh2;
  expect_same(render_options(other), expected);
}

/// How far CPU and GPU may be apart: rounding errors grow at every bounce on a sphere until a path
/// takes another way. Bounds are some times what contraction (-ffp-contract=fast -mfma) changes on
/// a CPU: 0.18, 0.54, 0.005 and 0.005 % of the pixels, and at most 2.3e-4 of the rays.
struct Closeness {
  std::string name;
  Settings settings;
  double pixels;  ///< largest fraction of pixels past 1e-3
  double rays;    ///< largest relative difference of the number of rays
};

void PrintTo(const Closeness& closeness, std::ostream* out) { *out << closeness.name; }

const Closeness closeness_cases[] = {
    {"spheres", {{"scene", "spheres"}}, 0.01, 2e-4},
    {"spheres_xorwow", {{"scene", "spheres"}, {"rng", "xorwow"}}, 0.01, 3e-4},
    {"spheres_bvh2", {{"scene", "spheres"}, {"accel", "bvh2"}}, 0.01, 2e-4},
    {"rtow", {{"scene", "rtow"}}, 0.03, 1e-3},
    {"cornell", {{"scene", "cornell"}}, 0.002, 4e-4},
    {"furnace", {{"scene", "furnace"}}, 0.002, 2e-4},
};

class CpuEquality : public CudaTest, public testing::WithParamInterface<Closeness> {};
INSTANTIATE_TEST_SUITE_P(Cuda, CpuEquality, testing::ValuesIn(closeness_cases),
                         [](const auto& closeness) { return closeness.param.name; });

double mean_of(const Image& image) {
  double sum = 0;
  for (const float value : image.rgb) sum += value;
  return sum / static_cast<double>(image.rgb.size());
}

TEST_P(CpuEquality, HoldsUpToRounding) {
  Options options = cuda_options("megakernel", GetParam().settings);
  options.width = compared_width, options.height = compared_height, options.spp = compared_spp;
  const Rendered gpu = render_options(options);
  const Rendered cpu = render_options(with(options, {{"device", "cpu"}}));
  const ImageDifference difference = compare_images(gpu.image, cpu.image, 1e-3);
  const auto pixels = static_cast<double>(compared_width * compared_height);
  const double mean_difference = std::abs(mean_of(gpu.image) - mean_of(cpu.image));
  const auto relative = [](std::uint64_t a, std::uint64_t b) {
    const double x = static_cast<double>(a), y = static_cast<double>(b);
    return x == y ? 0.0 : std::abs(x - y) / y;
  };
  const double rays = relative(gpu.counts.rays, cpu.counts.rays);
  const double shadow_rays = relative(gpu.counts.shadow_rays, cpu.counts.shadow_rays);
  std::cout << "CPU against GPU, " << GetParam().name << ": " << difference.pixels_past_tolerance
            << " of " << pixels << " pixels differ by more than 1e-3, "
            << difference.differing_pixels << " at all; means by " << mean_difference
            << ", rays by " << rays << ", shadow rays by " << shadow_rays << " (relative)\n";
  EXPECT_LE(static_cast<double>(difference.pixels_past_tolerance), GetParam().pixels * pixels);
  EXPECT_LE(mean_difference, 1e-4);
  EXPECT_LE(rays, GetParam().rays);
  EXPECT_LE(shadow_rays, GetParam().rays);
  EXPECT_EQ(gpu.counts.paths, cpu.counts.paths);
  EXPECT_EQ(gpu.counts.nonfinite_samples, 0u);
}

class CudaCreateWorld : public CudaTest {};

struct World {
  std::vector<Sphere> spheres;
  std::vector<MaterialDescription> materials;

  World(const SphereWorldCreator& create, SphereWorldKind kind, std::uint32_t count,
        std::uint32_t capacity)
      : spheres(capacity), materials(capacity) {
    SphereWorld world{spheres.data(), materials.data(), capacity};
    create(world, kind, count);
    spheres.resize(world.count), materials.resize(world.count);
  }
};

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST_F(CudaCreateWorld, EqualsTheHostsBitForBit) {
  const SphereWorldCreator on_device = create_world_on(choose_device({}).choice.index);
  const auto expect_equal = [&](SphereWorldKind kind, std::uint32_t count, std::uint32_t capacity) {
    SCOPED_TRACE(testing::Message() << count << " spheres, room for " << capacity);
    const World host(create_sphere_world, kind, count, capacity);
    const World device(on_device, kind, count, capacity);
    ASSERT_EQ(device.spheres.size(), host.spheres.size());
    for (std::size_t i = 0; i < host.spheres.size(); ++i) {
      const Sphere &a = device.spheres[i], &b = host.spheres[i];
      ASSERT_EQ(a.center, b.center) << i;
      ASSERT_EQ(a.radius_squared, b.radius_squared) << i;
    }
    EXPECT_TRUE(same_bytes(device.spheres, host.spheres));
    ASSERT_EQ(device.materials.size(), host.materials.size());
    for (std::size_t i = 0; i < host.materials.size(); ++i) {  // not by byte: there are gaps
      const MaterialDescription &a = device.materials[i], &b = host.materials[i];
      ASSERT_EQ(a.kind, b.kind) << i;
      for (int p = 0; p < parameters_max; ++p) ASSERT_EQ(a.color(p), b.color(p)) << i;
    }
  };
  for (const std::uint32_t count : {0u, 1u, 2u, 50u, 1000u, 20000u}) {
    const SphereWorldKind kind = SphereWorldKind::spheres;
    expect_equal(kind, count, sphere_world_capacity(kind, count));
  }
  expect_equal(SphereWorldKind::rtow, 0, sphere_world_capacity(SphereWorldKind::rtow, 0));
  expect_equal(SphereWorldKind::spheres, 50, 10);  // more than fit
}

TEST_F(CudaCreateWorld, GivesTheSameImage) {
  for (const char* scene : {"spheres", "rtow"}) {
    const Options host = cuda_options(
        "megakernel", {{"scene", scene}, {"width", width}, {"height", height}, {"spp", spp}});
    expect_same(render_options(with(host, {{"create-world", "device"}})), render_options(host));
  }
  EXPECT_THROW(render_options(
                   cuda_options("megakernel", {{"scene", "cornell"}, {"create-world", "device"}})),
               Error);
}

class CudaRefusal : public CudaTest {};

/// `parts`: of the message, where | separates alternatives.
void expect_refused(const Options& options, const std::vector<std::string>& parts) {
  SCOPED_TRACE(command_of(options));
  try {
    render_options(options);
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    const std::string message = error.what();
    for (const std::string& part : parts) {
      const std::size_t bar = part.find('|');
      const bool found =
          message.find(part.substr(0, bar)) != std::string::npos ||
          (bar != std::string::npos && message.find(part.substr(bar + 1)) != std::string::npos);
      EXPECT_TRUE(found) << "'" << message << "' does not say " << part;
    }
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST_F(CudaRefusal, BlocksOfTooManyThreads) {
  for (const BlockSize block :
       {BlockSize{64, 64}, {1025, 1}, {1, 1025}, {33, 32}, {32768, 65536}}) {
    Options options = cuda_options("megakernel");
    options.block = block;
    expect_refused(options, {"--block", "1,024|1024"});
  }
}

TEST_F(CudaRefusal, TogglesTogether) {
  const struct {
    Settings settings;
    std::vector<std::string> says;
  } cases[] = {
      {{{"rng", "xorwow"}, {"branching", "reduced"}}, {"--rng xorwow", "--branching reduced"}},
      {{{"rng", "xorwow"}, {"scene-memory", "shared"}}, {"--rng xorwow", "--scene-memory shared"}},
      {{{"branching", "reduced"}, {"scene-memory", "constant"}},
       {"--branching reduced", "--scene-memory constant"}},
      {{{"branching", "reduced"}, {"accel", "bvh2"}}, {"--branching reduced", "--accel bvh2"}},
  };
  for (const std::string& mode : names_of(Mode::megakernel, {Mode::serial})) {
    for (const auto& c : cases) expect_refused(cuda_options(mode, c.settings), c.says);
  }
}

TEST_F(CudaRefusal, SpheresThatDoNotFit) {
  for (const std::string& mode : names_of(Mode::megakernel, {Mode::serial})) {
    Options options = cuda_options(mode, {{"spheres", "5000"}, {"accel", "brute"}});
    options.scene_memory = SceneMemory::constant;
    expect_refused(options, {"--scene-memory constant", "5001|5,001", "1024|1,024"});
    options.spheres = 100'000;
    options.scene_memory = SceneMemory::shared;
    expect_refused(options, {"--scene-memory shared", "100001|100,001"});
  }
}

TEST_F(CudaRefusal, WhatDoesNotFitIntoMemory) {
  // 260 GiB and more: the scene has lights.
  Options pool = cuda_options("wavefront", {{"scene", "cornell"}});
  pool.pool_size = 0x7fffffff;
  expect_refused(pool,
                 {"not enough device memory", "--pool-size", "2147483647|2,147,483,647", "MiB"});
  Options image = cuda_options("megakernel");
  image.width = image.height = 65535;
  expect_refused(image, {"65535|65,535"});
  // Whoever is refused leaves the device as it was.
  const Options usual = cuda_options("wavefront", {{"width", width}, {"height", height}});
  expect_plausible(render_options(usual), usual);
}

class CudaModes : public CudaTest {};

// More than 48 KiB of shared memory have to be asked for.
TEST_F(CudaModes, ManySpheresInSharedMemory) {
  const Settings settings{{"spheres", "10000"},
                          {"accel", "brute"},
                          {"width", tiny_width},
                          {"height", tiny_height},
                          {"spp", spp}};
  const Options global = cuda_options("megakernel", settings);
  const Rendered expected = render_options(with(global, {{"scene-memory", "global"}}));
  for (const std::string& mode : names_of(Mode::megakernel, {Mode::serial})) {
    for (const char* memory : {"shared", "auto"}) {
      SCOPED_TRACE(std::string(mode) + ", " + memory);
      expect_same(render_options(with(cuda_options(mode, settings), {{"scene-memory", memory}})),
                  expected);
    }
  }
}

// Warps that fetch paths again in the middle of a request: the image has more of them than all
// resident warps fetch at first.
TEST_F(CudaModes, PersistentWarpsTakeEveryPath) {
  cudaDeviceProp device{};
  check_cuda(cudaGetDeviceProperties(&device, choose_device({}).choice.index),
             "cudaGetDeviceProperties");
  constexpr int fetched = 128, side = 256;
  const int warps = device.multiProcessorCount * device.maxThreadsPerMultiProcessor / 32;
  Options options =
      cuda_options("megakernel", {{"scene", "cornell"}, {"width", "256"}, {"height", "256"}});
  options.spp = 3 * warps * fetched / (side * side) + 1;
  expect_all_same(options, variations({{"work", {"persistent", "sample"}}}, 0, 0),
                  with(options, {{"work", "pixel"}}));
}

TEST_F(CudaModes, RenderingAgainGivesTheSame) {
  const Settings image{{"scene", "cornell"}, {"width", width}, {"height", height}, {"spp", spp}};
  std::vector<Options> all{cuda_options("megakernel", image)};
  for (const std::string& compaction : names_of(Compaction::atomic)) {
    for (const std::string& schedule : names_of(Schedule::graph, {Schedule::automatic})) {
      for (const char* pool : {"auto", "1000"}) {
        all.push_back(
            with(cuda_options("wavefront", image),
                 {{"compaction", compaction}, {"schedule", schedule}, {"pool-size", pool}}));
        all.push_back(with(all.back(), {{"stages", "split"}}));
      }
    }
  }
  std::optional<Rendered> expected;
  for (Options options : all) {
    for (const char* rng : {"philox", "xorwow"}) {
      Options varied = with(options, {{"rng", rng}});
      if (varied.rng != RngKind::philox) varied.scene = "spheres";  // which has no lamps
      SCOPED_TRACE(command_of(varied));
      const DeviceInfo device = choose_device(varied.device);
      const SceneData scene = make_scene_for(varied, device);
      const auto renderer = make_renderer(varied, scene, device);
      const Rendered first = take_image(*renderer);
      for (int i = 0; i < 2; ++i) expect_same(take_image(*renderer), first);
      if (varied.rng != RngKind::philox) continue;
      if (!expected) expected = first;
      expect_same(first, *expected);
    }
  }
}

/// Leaves the device so little memory that an image takes several batches. Not for
/// compute-sanitizer, which needs memory of its own.
class CudaBatches : public CudaTest {
 protected:
  static constexpr std::uint64_t left_bytes = std::uint64_t{1} << 30;

  void fill_memory() {
    std::size_t free = 0, total = 0;
    check_cuda(cudaMemGetInfo(&free, &total), "cudaMemGetInfo");
    if (free > left_bytes) filling_.emplace(free - left_bytes);
  }
  void free_memory() { filling_.reset(); }

  /// 42 million paths: the half of what is left holds 33 million samples.
  static Options options(const Settings& settings, const std::string& mode) {
    Options result = cuda_options(
        mode, {{"width", "512"}, {"height", "512"}, {"spp", "160"}, {"max-depth", "4"}});
    apply(result, settings);
    return result;
  }

  const std::vector<std::pair<std::string, Settings>> kinds_{
      {"megakernel", {}},
      {"megakernel", {{"work", "pixel"}}},
      {"megakernel", {{"work", "sample"}}},
      {"wavefront", {}},
      {"wavefront", {{"schedule", "host"}}},
      {"wavefront", {{"compaction", "cub"}}},
      {"wavefront", {{"compaction", "none"}, {"schedule", "host"}}},
      {"wavefront", {{"stages", "split"}}},
  };

 private:
  std::optional<DeviceArray<char>> filling_;
};

struct Progress {
  std::vector<std::uint64_t> done;

  /// Stops after so many batches.
  RenderHooks hooks(std::size_t batches_max = ~std::size_t{0}) {
    return {[this](std::uint64_t now, std::uint64_t) { done.push_back(now); },
            [this, batches_max] { return done.size() >= batches_max; }};
  }
};

TEST_F(CudaBatches, SeveralEqualOne) {
  Progress one;
  const Rendered expected = render_options(options({}, "megakernel"), one.hooks());
  ASSERT_LE(one.done.size(), 2u) << "not one batch, and one before it to know the pace";
  expect_plausible(expected, options({}, "megakernel"));
  fill_memory();
  for (const auto& [mode, settings] : kinds_) {
    const Options varied = options(settings, mode);
    SCOPED_TRACE(command_of(varied));
    Progress several;
    expect_same(render_options(varied, several.hooks()), expected);
    EXPECT_GE(several.done.size(), 2u) << "not several batches";
    EXPECT_NE(several.done, one.done) << "the same batches";
    EXPECT_TRUE(std::is_sorted(several.done.begin(), several.done.end()));
    EXPECT_EQ(several.done.back(), expected.counts.paths);
  }
}

TEST_F(CudaBatches, AnInterruptionLeavesTheImageOfTheSamplesTaken) {
  for (const auto& [mode, settings] : kinds_) {
    const Options varied = options(settings, mode);
    SCOPED_TRACE(command_of(varied));
    fill_memory();
    Progress progress;
    const Rendered stopped = render_options(varied, progress.hooks(1));
    free_memory();
    const int samples = stopped.run.samples_done;
    EXPECT_GT(samples, 0);
    EXPECT_LT(samples, varied.spp);
    EXPECT_EQ(progress.done, (std::vector<std::uint64_t>{std::uint64_t{512} * 512 *
                                                         static_cast<std::uint64_t>(samples)}));
    expect_same(stopped, render_options(with(varied, {{"spp", std::to_string(samples)}})));
  }
}

// Each render records a graph of its waves while others are set up.
TEST_F(CudaModes, ThreadsRenderOnOneGpu) {
  const Options options = with(Options(), {{"scene", "cornell"},
                                           {"width", "16"},
                                           {"height", "8"},
                                           {"spp", "1"},
                                           {"mode", "wavefront"},
                                           {"schedule", "graph"},
                                           {"device", "cuda:0"}});
  const Rendered expected = render_options(options);
  constexpr int renders = 40;
  std::vector<std::vector<Rendered>> found(3);
  std::vector<std::thread> threads;
  for (std::vector<Rendered>& own : found) {
    threads.emplace_back([&] {
      for (int i = 0; i < renders; ++i) own.push_back(render_options(options));
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<Rendered>& own : found) {
    ASSERT_EQ(own.size(), renders);
    for (const Rendered& rendered : own) expect_same(rendered, expected);
  }
}

}  // namespace
}  // namespace pt
