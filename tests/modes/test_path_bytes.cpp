// --path-bytes: what a path carries more leaves the image as it is, in all modes, as long as each
// path has its own records and all of them; a sample whose records are wrong is not a number.
#include <gtest/gtest.h>

#include "common/transport/extra_state.h"
#include "mode_cases.h"
#include "wavefront/stages.h"

namespace pt {
namespace {

PathState traced_path(std::uint32_t index, std::uint32_t rays) {
  PathState path;
  path.index = index, path.rays = static_cast<std::uint16_t>(rays);
  return path;
}

TEST(ExtraState, IsWholeAfterEachRay) {
  std::vector<ExtraRecord> records(3 * 5);
  const ExtraState state = ExtraState::by_place(records.data(), 5);
  for (std::uint32_t place = 0; place < 3; ++place) state.begin(place, 70 + place);
  for (std::uint32_t rays = 1; rays < 300; ++rays) {
    for (std::uint32_t place = 0; place < 3; ++place) {
      ASSERT_TRUE(state.is_whole(place, traced_path(70 + place, rays))) << rays;
      EXPECT_FALSE(state.is_whole(place, traced_path(70 + place, rays + 1)))
          << "a change is missing";
      EXPECT_FALSE(state.is_whole(place, traced_path(71 + place, rays))) << "another path's";
      state.step(place);
    }
  }
}

TEST(ExtraState, EachWordIsLookedAt) {
  std::vector<ExtraRecord> records(16);
  const ExtraState state = ExtraState::by_place(records.data(), 16);
  state.begin(0, 5), state.step(0), state.step(0);
  for (ExtraRecord& record : records) {
    for (std::uint32_t& word : record.words) {
      word ^= 0x80000000u;
      EXPECT_FALSE(state.is_whole(0, traced_path(5, 3)));
      word ^= 0x80000000u;
    }
  }
  EXPECT_TRUE(state.is_whole(0, traced_path(5, 3)));
}

// What CUDA keeps in registers is what others keep in memory.
TEST(ExtraState, RegistersAreTheSame) {
  PathSettings settings;
  ExtraRegisters<8> registers(settings);
  registers.begin(9);
  for (std::uint32_t rays = 1; rays < 40; ++rays) {
    ASSERT_TRUE(registers.is_whole(traced_path(9, rays)));
    EXPECT_FALSE(registers.is_whole(traced_path(9, rays + 1)));
    EXPECT_FALSE(registers.is_whole(traced_path(8, rays)));
    registers.step();
  }
}

// The sample of the one path whose record is wrong, and no other.
TEST(PathBytes, ABrokenRecordIsSeenInTheImage) {
  const Options options = with(Options(), {{"device", "cpu"}, {"width", "8"}, {"height", "4"}});
  const SceneData data = make_scene_for(options, choose_device(options.device));
  const Scene scene = host_view(data, options.width, options.height);
  constexpr std::uint32_t n = 32, broken = 11;
  PathPool pool;
  pool.slot_count = n;
  PathPool::Fields fields;
  fields.extra_records = 3;
  std::vector<std::vector<PathRecord>> arrays;
  pool.allocate_arrays(fields, [&]<class T>(T*, std::uint64_t count) {
    arrays.emplace_back(count * sizeof(T) / sizeof(PathRecord) + 1);
    return reinterpret_cast<T*>(arrays.back().data());
  });
  std::vector<Sample> samples(n);
  std::vector<std::uint32_t> queue(n);
  WaveCounters counters{};
  counters.generate = counters.intersect = n;
  const SampleBuffer buffer(samples.data(), Window{0, 0, 8, 4}, 0, 1);
  const GeneratePaths<PhiloxSource> generate{
      {pool, buffer, PhiloxSource{1}, &counters, queue.data(), {}, {}}, false};
  const ShadeMiss<Lighting::sky, true> miss{pool, buffer, PathSettings(), false};
  for (std::uint32_t slot = 0; slot < n; ++slot) generate(scene, slot, slot);
  pool.extra.at(broken, 2)->words[3] += 1;
  for (std::uint32_t slot = 0; slot < n; ++slot) miss(scene, slot, slot);
  for (std::uint32_t i = 0; i < n; ++i) EXPECT_EQ(is_finite(samples[i].radiance), i != broken) << i;
}

std::vector<ImageKind> path_bytes_kinds() {
  const Settings usual{
      {"device", "cpu"}, {"width", "37"}, {"height", "23"}, {"spp", "3"}, {"max-depth", "7"}};
  std::vector<ImageKind> kinds;
  for (const auto& [name, more] : std::vector<std::pair<std::string, Settings>>{
           {"spheres", {{"scene", "spheres"}}},
           {"cornell", {{"scene", "cornell"}}},
           {"boxes", {{"scene", "boxes"}}},
           {"instances", {{"scene", "instances:300"}}},
           {"media", {{"scene", "cloud:20"}}},
           {"light_tree", {{"scene", "boxes"}, {"light-selection", "tree"}}}}) {
    kinds.push_back({name, usual});
    kinds.back().settings.insert(kinds.back().settings.end(), more.begin(), more.end());
  }
  return kinds;
}

class PathBytesOf : public testing::TestWithParam<ImageKind> {};
INSTANTIATE_TEST_SUITE_P(Images, PathBytesOf, testing::ValuesIn(path_bytes_kinds()),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(PathBytesOf, LeaveTheImageAsItIs) {
  const Options usual = with(Options(), GetParam().settings);
  const Rendered expected = render_options(with(usual, {{"mode", "serial"}}));
  expect_plausible(expected, usual);
  const std::vector<Settings> ways{
      {{"mode", "serial"}},
      {{"mode", "megakernel"}},
      {{"mode", "wavefront"}},
      {{"mode", "wavefront"}, {"finish-paths", "0"}, {"layout", "soa"}},
      {{"mode", "wavefront"}, {"finish-paths", "50"}, {"layout", "aos"}, {"pool-size", "200"}},
      {{"mode", "wavefront"}, {"finish-paths", "0"}, {"compaction", "cub"}, {"pool-size", "64"}},
      {{"mode", "wavefront"}, {"finish-paths", "0"}, {"compaction", "none"}, {"layout", "aos"}},
      {{"mode", "wavefront"}, {"stages", "fused"}, {"finish-paths", "0"}},
      {{"mode", "wavefront"}, {"stages", "fused"}, {"pool-size", "100"}, {"wave-rays", "3"}}};
  for (const char* bytes : {"16", "64", "256"}) {
    for (const Settings& way : ways) {
      const Options options = with(with(usual, way), {{"path-bytes", bytes}});
      SCOPED_TRACE(command_of(options));
      expect_same(render_options(options), expected);
    }
  }
}

TEST(PathBytes, AreInThePlanAndInTheMemory) {
  const Options options = with(Options(), {{"device", "cpu"},
                                           {"scene", "boxes"},
                                           {"mode", "wavefront"},
                                           {"width", "8"},
                                           {"height", "8"},
                                           {"path-bytes", "48"}});
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  const auto memory_of = [&](const Options& o) {
    RenderReport report;
    make_renderer(o, scene, device)->describe(report);
    std::uint64_t bytes = 0;
    for (const BufferSize& buffer : report.memory)
      if (buffer.name == "path pool and queues") bytes = buffer.size_bytes;
    return bytes;
  };
  const std::uint64_t slots =
      std::min<std::uint64_t>(64 * options.spp, 1024 * device.properties.threads);
  EXPECT_EQ(memory_of(options) - memory_of(with(options, {{"path-bytes", "0"}})), 64 * slots)
      << "with layout sectors in pairs";
  const ExecutionPlan plan = plan_execution(options, scene.properties, device.properties);
  EXPECT_NE(plan_text(plan.decisions).find("--path-bytes"), std::string::npos);
}

TEST(PathBytes, AreRefusedWhereTheyMakeNoSense) {
  const auto refusal = [](const Settings& more) {
    Settings settings{{"device", "cpu"}, {"width", "8"}, {"height", "8"}};
    settings.insert(settings.end(), more.begin(), more.end());
    return refusal_of(settings);
  };
  EXPECT_NE(refusal({{"path-bytes", "24"}}).find("--path-bytes 24: expected a multiple of 16"),
            std::string::npos);
  EXPECT_NE(refusal({{"path-bytes", "272"}}).find("--path-bytes 272"), std::string::npos);
  EXPECT_NE(refusal({{"path-bytes", "16"}, {"integrator", "mlt"}}).find("expected path"),
            std::string::npos);
}

}  // namespace
}  // namespace pt
