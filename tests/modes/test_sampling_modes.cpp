// However lights, directions and numbers are chosen, all modes give one image, bit for bit; and the
// choice changes an image's noise alone.
#include <algorithm>

#include "common/scene/prepare/prepare_scene.h"
#include "mode_cases.h"
#include "scene/lit_room.h"

namespace pt {
namespace {

Rendered render_room(const Settings& settings) {
  const Options options = with(Options(), settings);
  SceneData scene = lit_room();
  prepare_scene(scene, options);
  return take_image(*make_renderer(options, scene, choose_device(options.device)));
}

Settings joined(Settings settings, const Settings& more) {
  settings.insert(settings.end(), more.begin(), more.end());
  return settings;
}

struct Choices {
  std::string name;
  Settings settings;
  int noisy = 3;  ///< tiles that cannot tell, as where the ball of glass gathers the sun
};

void PrintTo(const Choices& choices, std::ostream* out) { *out << choices.name; }

class SamplingModesOf : public testing::TestWithParam<Choices> {
 protected:
  static Settings settings(const Settings& more) {
    return joined(
        joined({{"device", "cpu"}, {"width", "32"}, {"height", "24"}, {"max-depth", "7"}}, more),
        GetParam().settings);
  }
};
/// Whatever the options' tables have, but what is usual.
std::vector<Choices> all_choices() {
  std::vector<Choices> all;
  const auto add = [&](const std::string& option, const std::vector<std::string>& values) {
    for (const std::string& value : values) {
      std::string name = option + "_" + value;
      std::ranges::replace(name, '-', '_');
      all.push_back({name, {{option, value}}});
    }
  };
  add("light-selection", names_besides(LightSelection::automatic));
  add("mis", names_besides(MisHeuristic::power));
  add("sampling", names_besides(DirectionSampling::bsdf));
  add("sampler", names_besides(SamplerKind::independent));
  for (Choices& choices : all) {
    if (choices.name == "sampling_uniform") choices.settings.emplace_back("mis", "balance");
  }
  return all;
}
INSTANTIATE_TEST_SUITE_P(Of, SamplingModesOf, testing::ValuesIn(all_choices()),
                         [](const auto& choices) { return choices.param.name; });

TEST_P(SamplingModesOf, EqualSerial) {
  const Settings few = settings({{"spp", "3"}});
  const Rendered serial = render_room(joined(few, {{"mode", "serial"}}));
  expect_same(render_room(joined(few, {{"mode", "megakernel"}})), serial);
  for (const std::string& compaction : names_of(Compaction::atomic)) {
    for (const char* finish : {"0", "100"}) {
      SCOPED_TRACE(testing::Message() << compaction << ", finish-paths " << finish);
      expect_same(render_room(joined(few, {{"mode", "wavefront"},
                                           {"compaction", compaction},
                                           {"pool-size", "333"},
                                           {"finish-paths", finish}})),
                  serial);
    }
  }
}

/// The lit room with small lamps all over, one kind of which shines down, the other up.
SceneData room_of_many_lamps(int lamps) {
  SceneData scene = lit_room();
  const std::uint32_t glow =
      scene.add_material(make_diffuse(Color(0.2f), Color(30 / static_cast<float>(lamps))));
  TestRandom random(3);
  for (int i = 0; i < lamps; ++i) {
    const Vec3 place(7 * random.unit() - 3.5f, 0.3f + 4 * random.unit(), 7 * random.unit() - 3.5f);
    const float up = i % 2 == 0 ? 0.6f : -0.6f;
    scene.meshes.push_back(parallelogram({}, place, {0.6f, 0, 0}, {0, 0.1f, up}, glow));
  }
  return scene;
}

// What a path has to remember of a surface, so as to know how likely a lamp was that it meets: with
// few lamps nearly every surface chooses alike, and a forgotten one changes little.
TEST(SamplingModes, ManyLampsByTreeEqualSerial) {
  const auto render = [](const Settings& more) {
    const Options options = with(with(Options(), {{"device", "cpu"},
                                                  {"width", "32"},
                                                  {"height", "24"},
                                                  {"max-depth", "5"},
                                                  {"spp", "4"},
                                                  {"light-selection", "tree"}}),
                                 more);
    SceneData scene = room_of_many_lamps(40);
    prepare_scene(scene, options);
    return take_image(*make_renderer(options, scene, choose_device(options.device)));
  };
  const Rendered serial = render({{"mode", "serial"}});
  expect_same(render({{"mode", "megakernel"}}), serial);
  for (const char* stages : {"split", "fused"}) {
    for (const std::string& layout : names_of(PoolLayout::soa)) {
      for (const char* finish : {"0", "100"}) {
        SCOPED_TRACE(testing::Message() << stages << ' ' << layout << " finish " << finish);
        expect_same(render({{"mode", "wavefront"},
                            {"stages", stages},
                            {"layout", layout},
                            {"pool-size", "333"},
                            {"finish-paths", finish}}),
                    serial);
      }
    }
  }
}

/// Means over some seeds of 8 x 6 tiles.
std::vector<MeanEstimate> tile_means(const Settings& settings, int first_seed, int seeds) {
  std::vector<MeanEstimate> tiles(48);
  for (int seed = first_seed; seed < first_seed + seeds; ++seed) {
    const Image image =
        render_room(joined(settings, {{"spp", "64"}, {"seed", std::to_string(seed)}})).image;
    std::vector<double> sums(48);
    for (int y = 0; y < 24; ++y) {
      for (int x = 0; x < 32; ++x) {
        const float* p = image.pixel(x, y);
        sums[static_cast<std::size_t>(y / 4 * 8 + x / 4)] += double{p[0]} + p[1] + p[2];
      }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) tiles[i].add(sums[i]);
  }
  return tiles;
}

// Welch's t-test for each tile (Jung et al. 2020, 'Detecting Bias in Monte Carlo Renderers using
// Welch's t-test'): with 16 seeds |t| > 5.5 comes once in 10^5, so of 48 tiles once in 2,000 runs,
// and the seeds are fixed.
TEST_P(SamplingModesOf, ConvergeToOneImage) {
  const auto found = tile_means(settings({{"mode", "megakernel"}}), 1, 16);
  static const auto expected = tile_means({{"device", "cpu"},
                                           {"width", "32"},
                                           {"height", "24"},
                                           {"max-depth", "7"},
                                           {"mode", "megakernel"},
                                           {"light-selection", "power"},
                                           {"rr", "3"}},
                                          101, 16);
  int noisy = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double t =
        (found[i].mean() - expected[i].mean()) / std::hypot(found[i].sigma(), expected[i].sigma());
    EXPECT_LT(std::abs(t), 5.5) << "tile " << i << ": " << found[i].mean() << " and "
                                << expected[i].mean();
    noisy += found[i].sigma() > 0.04 * found[i].mean();
  }
  EXPECT_LE(noisy, GetParam().noisy);
}

}  // namespace
}  // namespace pt
