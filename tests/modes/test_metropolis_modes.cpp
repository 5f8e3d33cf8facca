// Metropolis light transport on the CPU: one image in all modes, the path tracer's in the mean, and
// what is refused.
#include <gtest/gtest.h>

#include "film_cases.h"

namespace pt {
namespace {

Options mlt_options(const Settings& more) {
  return with(with(Options(), {{"device", "cpu"},
                               {"integrator", "mlt"},
                               {"scene", "cornell"},
                               {"width", "31"},
                               {"height", "19"},
                               {"spp", "20"},
                               {"max-depth", "6"},
                               {"chains", "997"},
                               {"mutation-size", "0.015625"},
                               {"large-step-probability", "0.3"},
                               {"bootstrap", "5000"}}),
              more);
}

Rendered render_mlt(const Settings& more) { return render_options(mlt_options(more)); }

void expect_same_chains(const Rendered& found, const Rendered& expected) {
  expect_same(found, expected);
  const MetropolisStats &a = *found.run.metropolis, &b = *expected.run.metropolis;
  EXPECT_EQ(a.brightness, b.brightness);
  EXPECT_EQ(a.large_acceptance, b.large_acceptance);
  EXPECT_EQ(a.small_acceptance, b.small_acceptance);
}

class MetropolisModes : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Of, MetropolisModes, testing::Values("cornell", "spheres"));

TEST_P(MetropolisModes, EqualSerial) {
  const Settings scene{{"scene", GetParam()}};
  const auto also = [&](Settings more) {
    more.insert(more.end(), scene.begin(), scene.end());
    return more;
  };
  const Rendered serial = render_mlt(also({{"mode", "serial"}}));
  const MetropolisStats& stats = *serial.run.metropolis;
  EXPECT_EQ(stats.chains, 997u);
  EXPECT_EQ(stats.mutations, 12u * 997u);  // 31 x 19 x 20, rounded up to whole iterations
  EXPECT_EQ(serial.counts.paths, 5000u + 13u * 997u);
  EXPECT_EQ(serial.run.samples_done, 20);
  EXPECT_GT(stats.small_acceptance, 0.5);
  EXPECT_LT(stats.small_acceptance, 0.99);
  EXPECT_GT(stats.large_acceptance, 0.05);
  EXPECT_LT(stats.large_acceptance, 0.95);
  EXPECT_NEAR(stats.large_share, 0.3, 0.03);
  expect_same_chains(render_mlt(also({{"mode", "serial"}})), serial);
  for (const std::string& work : names_of(Work::persistent)) {
    expect_same_chains(render_mlt(also({{"mode", "megakernel"}, {"work", work}, {"threads", "3"}})),
                       serial);
  }
  for (const std::string& compaction : names_of(Compaction::atomic)) {
    for (const char* pool : {"auto", "333"}) {
      for (const char* stages : {"split", "fused"}) {
        SCOPED_TRACE(testing::Message() << compaction << " " << pool << " " << stages);
        expect_same_chains(render_mlt(also({{"mode", "wavefront"},
                                            {"compaction", compaction},
                                            {"pool-size", pool},
                                            {"stages", stages},
                                            {"order-surfaces", pool[0] == 'a' ? "on" : "auto"},
                                            {"finish-paths", "100"}})),
                           serial);
      }
    }
  }
  EXPECT_GT(differing_pixels(render_mlt(also({{"seed", "2"}})).image, serial.image), 300u);
  EXPECT_GT(differing_pixels(render_mlt(also({{"chains", "996"}})).image, serial.image), 300u);
}

/// Means over some seeds of 8 x 6 tiles and, last, of the image.
std::vector<MeanEstimate> tile_means(const Settings& settings, int seeds) {
  std::vector<MeanEstimate> tiles(49);
  for (int seed = 1; seed <= seeds; ++seed) {
    Options options = with(Options(), {{"device", "cpu"},
                                       {"mode", "megakernel"},
                                       {"width", "32"},
                                       {"height", "24"},
                                       {"max-depth", "6"},
                                       {"spp", "64"},
                                       {"seed", std::to_string(seed)}});
    const Image image = render_options(with(options, settings)).image;
    std::vector<double> sums(49);
    for (int y = 0; y < 24; ++y) {
      for (int x = 0; x < 32; ++x) {
        const float* p = image.pixel(x, y);
        const double value = double{p[0]} + p[1] + p[2];
        sums[static_cast<std::size_t>(y / 4 * 8 + x / 4)] += value;
        sums[48] += value;
      }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) tiles[i].add(sums[i]);
  }
  return tiles;
}

void expect_same_means(const std::vector<MeanEstimate>& found,
                       const std::vector<MeanEstimate>& expected, double precision) {
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double sigma = std::hypot(found[i].sigma(), expected[i].sigma());
    EXPECT_LE(std::abs(found[i].mean() - expected[i].mean()), 5.5 * sigma)
        << "tile " << i << ": " << found[i].mean() << " and " << expected[i].mean();
  }
  EXPECT_LT(found[48].sigma(), precision * found[48].mean());
}

// Welch's t-test for each tile, and for the whole image. With 16 seeds |t| > 5.5 comes once in
// 10^5.
TEST(Metropolis, AgreesWithThePathTracer) {
  for (const char* scene : {"cornell", "spheres"}) {
    SCOPED_TRACE(scene);
    const Settings of{{"scene", scene}};
    const auto expected = tile_means({{"scene", scene}, {"spp", "128"}}, 16);
    const Settings mlt{
        {"scene", scene}, {"integrator", "mlt"}, {"chains", "512"}, {"bootstrap", "20000"}};
    expect_same_means(tile_means(mlt, 16), expected, 0.02);
  }
}

// Without asking lights most paths are black; filters, lenses and roulette are the path tracer's.
TEST(Metropolis, AgreesWhateverThePathsAre) {
  const Settings choices{{"scene", "cornell"}, {"nee", "off"},       {"rr", "3"},
                         {"filter", "tent:1"}, {"aperture", "0.05"}, {"focus-distance", "3"}};
  Settings mlt = choices;
  mlt.insert(mlt.end(), {{"integrator", "mlt"},
                         {"chains", "300"},
                         {"bootstrap", "20000"},
                         {"large-step-probability", "0.1"},
                         {"mutation-size", "0.1"}});
  expect_same_means(tile_means(mlt, 16), tile_means(choices, 16), 0.03);
}

TEST(Metropolis, OneChainAndOneBootstrapPathAreEnough) {
  const Rendered one = render_mlt({{"chains", "1"}, {"spp", "2"}});
  EXPECT_EQ(one.run.metropolis->mutations, 31u * 19u * 2u);
  for (const float value : one.image.rgb) EXPECT_TRUE(std::isfinite(value) && value >= 0);
  // Counts the bootstraps that find light at all.
  int rendered = 0;
  for (int seed = 1; seed <= 10; ++seed) {
    const Settings settings{
        {"device", "cpu"},  {"integrator", "mlt"}, {"scene", "cornell"},
        {"width", "16"},    {"height", "16"},      {"spp", "2"},
        {"bootstrap", "1"}, {"max-depth", "6"},    {"seed", std::to_string(seed)}};
    const std::string refusal = refusal_of(settings);
    if (refusal == "no error") {
      ++rendered;
    } else {
      EXPECT_NE(refusal.find("1 bootstrap paths found no light"), std::string::npos) << refusal;
    }
  }
  EXPECT_GE(rendered, 1);
}

TEST(Metropolis, MoreChainsThanMutationsTakeOneStep) {
  const Rendered many = render_mlt({{"chains", "5000"}, {"spp", "1"}});
  EXPECT_EQ(many.run.metropolis->mutations, 5000u);
  EXPECT_EQ(many.run.samples_done, 1);
}

TEST(Metropolis, ChoosesItsChains) {
  const Rendered few = render_mlt({{"chains", "auto"}, {"spp", "2"}});
  EXPECT_EQ(few.run.metropolis->chains, 31u * 19u * 2u / 4u);
  EXPECT_EQ(render_mlt({{"chains", "auto"}, {"spp", "200"}}).run.metropolis->chains, 8192u);
}

TEST(Metropolis, FindsNoLightWhereThereIsNone) {
  // One ray of a path, and no lamp in this part of the image.
  const std::string refusal = refusal_of({{"device", "cpu"},
                                          {"integrator", "mlt"},
                                          {"scene", "cornell"},
                                          {"max-depth", "1"},
                                          {"crop", "0,280,60,300"}});
  EXPECT_NE(refusal.find("131072 bootstrap paths found no light"), std::string::npos) << refusal;
}

TEST(Metropolis, RendersAWindowThatIsBlackButForALamp) {
  const Rendered lamp = render_mlt({{"max-depth", "1"}, {"spp", "50"}, {"bootstrap", "200K"}});
  const Image path = render_options(with(mlt_options({{"max-depth", "1"}}),
                                         {{"integrator", "path"}, {"spp", "200"}}))
                         .image;
  double sum = 0, expected = 0;
  for (std::size_t i = 0; i < path.rgb.size(); ++i) {
    sum += lamp.image.rgb[i], expected += path.rgb[i];
    if (path.rgb[i] == 0) {
      EXPECT_LT(lamp.image.rgb[i], 0.5f);  // a corner of a pixel may have escaped all samples
    }
  }
  EXPECT_NEAR(sum, expected, 0.06 * expected);
}

TEST(Metropolis, ACropIsAnImageOfItsOwn) {
  const Rendered crop = render_mlt({{"crop", "5,4,20,16"}, {"spp", "400"}});
  EXPECT_EQ(crop.image.width, 15);
  EXPECT_EQ(crop.image.height, 12);
  const Image whole =
      render_options(with(mlt_options({}), {{"integrator", "path"}, {"spp", "400"}})).image;
  double sum = 0, expected = 0;
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 15; ++x) {
      sum += crop.image.pixel(x, y)[1], expected += whole.pixel(x + 5, y + 4)[1];
    }
  }
  EXPECT_NEAR(sum, expected, 0.05 * expected);
}

TEST(Metropolis, StopsWhereItIsAskedTo) {
  RenderHooks hooks;
  int calls = 0;
  std::uint64_t total = 0;
  hooks.progress = [&](std::uint64_t, std::uint64_t all) { total = all; };
  hooks.stop = [&] { return ++calls == 1; };
  const Rendered stopped = render_options(mlt_options({{"spp", "2000"}}), hooks);
  EXPECT_EQ(stopped.run.ended_by, RunEnd::interrupted);
  EXPECT_GT(stopped.run.samples_done, 0);
  EXPECT_LT(stopped.run.samples_done, 2000);
  EXPECT_GE(total, 31u * 19u * 2000u);
  const Rendered less = render_mlt({{"spp", std::to_string(stopped.run.samples_done)}});
  double sum = 0, expected = 0;
  for (const float v : stopped.image.rgb) sum += v;
  for (const float v : less.image.rgb) expected += v;
  EXPECT_NEAR(sum, expected, 0.05 * expected);
}

TEST(Metropolis, AFilmIsRenderedOnceAndMerged) {
  const Options options = mlt_options({});
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  const auto renderer = make_renderer(options, scene, device);
  Film left, right, all = blank_film(31, 19);
  left.window = {0, 0, 16, 19}, right.window = {16, 0, 15, 19};
  renderer->render(left, 20, {});
  renderer->render(right, 20, {});
  EXPECT_EQ(left.next_sample, 20u);
  merge(all, left);
  merge(all, right);
  EXPECT_TRUE(all.is_complete());
  EXPECT_THROW(renderer->render(left, 20, {}), Error);
  const Rendered path = render_options(with(options, {{"integrator", "path"}, {"spp", "100"}}));
  double sum = 0, expected = 0;
  for (const FilmPixel& pixel : all.pixels)
    sum += pixel.sum[1] / static_cast<double>(pixel.samples);
  for (std::size_t i = 1; i < path.image.rgb.size(); i += 3) expected += path.image.rgb[i];
  EXPECT_NEAR(sum, expected, 0.1 * expected);
}

TEST(Metropolis, RefusesWhatChainsCannotDo) {
  const auto refusal = [](const std::string& option, const std::string& value) {
    return refusal_of({{"device", "cpu"}, {"integrator", "mlt"}, {option, value}});
  };
  for (const auto& [option, value] : Settings{{"sampler", "sobol"},
                                              {"target-error", "0.1"},
                                              {"aov", "albedo"},
                                              {"filter", "mitchell"},
                                              {"counters", "on"}}) {
    const std::string text = refusal(option, value);
    EXPECT_NE(text.find("--" + option), std::string::npos) << text;
    EXPECT_NE(text.find("--integrator mlt"), std::string::npos) << text;
  }
  EXPECT_NE(refusal("rng", "xorwow").find("--integrator"), std::string::npos);
  EXPECT_NE(refusal("chains", "100M").find("not enough memory"), std::string::npos);
}

}  // namespace
}  // namespace pt
