// The rules of Metropolis light transport, on targets that are known: small steps of numbers, the
// states that chains visit, the image that they add up to, where they begin.
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "common/error.h"
#include "common/render/metropolis.h"
#include "common/sampling/sampler_source.h"
#include "statistics.h"

namespace pt {
namespace {

TEST(Mutation, StaysOnTheCircleAndHasTheSizesThatItShould) {
  TestRandom random;
  const MutationSize size = mutation_size(0.25f);
  constexpr int cells = 16;
  std::vector<double> octaves(cells), sides(2);
  constexpr int count = 200000;
  for (int i = 0; i < count; ++i) {
    const float x = random.unit(), y = mutate(x, random.unit(), size);
    ASSERT_GE(y, 0.0f);
    ASSERT_LT(y, 1.0f);
    double step = double{y} - x;
    if (step > 0.5) step -= 1;
    if (step < -0.5) step += 1;
    // Uniform in log2 between a sixty-fourth and a quarter.
    ++octaves[cell_of((std::log2(std::abs(step)) + 6) / 4, cells)];
    ++sides[step > 0];
  }
  expect_uniform(octaves, count, "octaves");
  expect_uniform(sides, count, "sides");
}

TEST(Mutation, KeepsUniformNumbersUniformAtTheEnds) {
  TestRandom random;
  const MutationSize size = mutation_size(0.5f);
  std::vector<double> cells(64);
  constexpr int count = 400000;
  for (int i = 0; i < count; ++i) ++cells[cell_of(mutate(random.unit(), random.unit(), size), 64)];
  expect_uniform(cells, count, "mutated numbers");
  for (const float x : {0.0f, one_minus_ulp, 0x1p-24f}) {
    for (const float u : {0.0f, one_minus_ulp, 0.5f, bits_to_float(float_to_bits(0.5f) - 1)}) {
      for (const float largest : {0.5f, 1e-6f, 1e-30f}) {
        const float y = mutate(x, u, mutation_size(largest));
        EXPECT_GE(y, 0.0f) << x << " " << u << " " << largest;
        EXPECT_LT(y, 1.0f) << x << " " << u << " " << largest;
      }
    }
  }
}

TEST(ChainWindow, EveryPixelHasItsShareOfTheSquareAndItsPlaceInIt) {
  const ChainWindow window{3, 7, 5, 2};
  TestRandom random;
  std::vector<double> pixels(10), places(8);
  constexpr int count = 100000;
  for (int i = 0; i < count; ++i) {
    const PixelPoint point = window.point_of({random.unit(), random.unit(), 0.25f, 0.5f});
    const std::uint32_t x = point.pixel & 0xffffu, y = point.pixel >> 16;
    ASSERT_TRUE(x >= 3 && x < 8 && y >= 7 && y < 9);
    ++pixels[window.index_of(point.pixel)];
    ++places[cell_of(point.u.x, 8)];
    EXPECT_EQ(point.u.z, 0.25f);
    EXPECT_EQ(point.u.w, 0.5f);
  }
  expect_uniform(pixels, count, "pixels");
  expect_uniform(places, count, "places in a pixel");
  const PixelPoint last = window.point_of({one_minus_ulp, one_minus_ulp, 0, 0});
  EXPECT_EQ(last.pixel, 7u | 8u << 16);
  EXPECT_LT(last.u.x, 1.0f);
}

/// A path that only draws numbers. Which ones it asks for depends on those that it has drawn.
struct ToyPath {
  double x, y, v;  ///< where on the image, and the last number
  bool is_long;
  std::uint32_t rays;
  float radiance;
};

constexpr std::uint32_t side = 4;  // pixels
constexpr double toy_mean = 0.7;
constexpr std::uint32_t bootstrap_begin = 1u << 30;  // names that no chain began at

/// 0.7 in the mean over all numbers; (0.2 + x) 2 v for short paths, (0.2 + y) 3 v^2 for long ones.
ToyPath follow_toy(SamplerSource::Stream& random) {
  const Vec4 u = random.draw(0);
  const PixelPoint point = pixel_point(random, 0, u);
  const double x = ((point.pixel & 0xffffu) + double{point.u.x}) / side;
  const double y = ((point.pixel >> 16) + double{point.u.y}) / side;
  const bool is_long = random.draw(2).x >= 0.5f;
  const double v = random.draw(is_long ? 4 : 3).y;
  const double f = is_long ? (0.2 + y) * 3 * v * v : (0.2 + x) * 2 * v;
  return {x, y, v, is_long, is_long ? 2u : 1u, static_cast<float>(f)};
}

/// Cells of (x, y, v, length), and the part of the target in each.
constexpr int cells_along = 4;
std::size_t toy_cell(const ToyPath& path) {
  return ((cell_of(path.x, cells_along) * cells_along + cell_of(path.y, cells_along)) *
              cells_along +
          cell_of(path.v, cells_along)) *
             2 +
         path.is_long;
}
std::vector<double> toy_parts() {
  std::vector<double> parts;
  const auto along = [](int i) { return (i + 0.5) / cells_along; };
  const auto edge = [](int i) { return static_cast<double>(i) / cells_along; };
  for (int x = 0; x < cells_along; ++x) {
    for (int y = 0; y < cells_along; ++y) {
      for (int v = 0; v < cells_along; ++v) {
        const double area = 0.5 / (cells_along * cells_along) / toy_mean;
        const double low = edge(v), high = edge(v + 1);
        parts.push_back(area * (0.2 + along(x)) * (high * high - low * low));
        parts.push_back(area * (0.2 + along(y)) * (high * high * high - low * low * low));
      }
    }
  }
  return parts;
}

/// Chains on the toy's paths.
class ToyChains {
 public:
  /// `target`: what a path's radiance is made into.
  ToyChains(
      std::uint32_t count, std::uint32_t blocks, double large, std::uint64_t seed,
      std::function<float(float)> target = [](float f) { return f; })
      : target_(std::move(target)), samples_(count), paths_(count) {
    arrays_.for_each_array(count, count, 0, blocks, side * side,
                           [&]<class T>(T*& pointer, std::uint64_t n) {
                             memory_.emplace_back(n * sizeof(T));
                             pointer = reinterpret_cast<T*>(memory_.back().data());
                           });
    *arrays_.chains = {arrays_.proposals,     arrays_.accepted,  seed, count,
                       mutation_size(0.125f), {0, 0, side, side}};
    step_.weights = {toy_mean, toy_mean, large, 0};
    step_.scale = 0x1p40;
    step_.blocks = blocks;
    start();
  }

  /// Weighs for as many bootstrap paths for each mutation, by a brightness that is only expected,
  /// and returns what `paths` of them add to the image: [pixel], in units of `share` / paths.
  std::vector<double> bootstrap(double expected, double share, std::uint32_t paths) {
    step_.weights.expected = expected;
    step_.weights.bootstrap_share = share;
    const SamplerSource source{arrays_.chains->seed, {}, arrays_.chains};
    const Proposal state = arrays_.proposals[0];
    for (std::uint32_t i = 0; i < paths; ++i) {
      arrays_.proposals[0] = bootstrap_path(bootstrap_begin + i);
      SamplerSource::Stream stream = source.open({0, 0, 0});
      const ToyPath path = follow_toy(stream);
      splat_bootstrap(arrays_, step_, arrays_.proposals[0],
                      {Color(target_(path.radiance)), path.rays});
    }
    arrays_.proposals[0] = state;
    std::vector<double> sums;
    for (std::uint32_t pixel = 0; pixel < side * side; ++pixel) sums.push_back(sum(pixel));
    std::fill_n(arrays_.sums, 3 * side * side, SplatSum{0});
    return sums;
  }
  void mutate(int iterations) {
    step_.kind = ChainStep::Kind::mutate;
    for (int i = 0; i < iterations; ++i) turn();
  }
  void finish() {
    step_.kind = ChainStep::Kind::finish;
    take_steps();
  }

  /// The paths at which the chains are, followed once more by the numbers that they have stored.
  std::vector<ToyPath> states() {
    std::vector<ToyPath> states;
    const Chains& chains = *arrays_.chains;
    for (std::uint32_t i = 0; i < chains.count; ++i) states.push_back(current_[i]);
    return states;
  }
  double sum(std::uint32_t pixel) const {
    return static_cast<double>(arrays_.sums[3 * pixel + 1]) / step_.scale;
  }
  ChainTally tally() const {
    ChainSums sums;
    sums.add(arrays_.counts);
    return sums.steps;
  }
  const ChainArrays& arrays() const { return arrays_; }

 private:
  /// Exactly in proportion to the target: by rejection.
  void start() {
    const std::uint32_t count = arrays_.chains->count;
    current_.resize(count);
    const SamplerSource source{arrays_.chains->seed, {}, arrays_.chains};
    TestRandom random(arrays_.chains->seed + 1);
    std::uint32_t name = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      do {
        arrays_.proposals[i] = {name++, bootstrap_iteration, 0, 1};
        SamplerSource::Stream stream = source.open({0, 0, i});
        current_[i] = follow_toy(stream);
      } while (random.uniform(0, 3.6) >= current_[i].radiance);
    }
    step_.kind = ChainStep::Kind::start;
    turn();
  }

  void turn() {
    const SamplerSource source{arrays_.chains->seed, {}, arrays_.chains};
    for (std::uint32_t i = 0; i < paths_.size(); ++i) {
      SamplerSource::Stream stream = source.open({0, 0, i});
      paths_[i] = follow_toy(stream);
      samples_[i] = {Color(target_(paths_[i].radiance)), paths_[i].rays};
    }
    take_steps();
  }

  void take_steps() {
    for (std::uint32_t i = 0; i < arrays_.chains->count; ++i) {
      if (step_.kind == ChainStep::Kind::finish) {
        finish_chain(arrays_, step_, i);
        continue;
      }
      const ChainTally& steps = arrays_.counts[i % ChainCounts::copies].steps;
      const std::uint64_t before = steps.large_accepted + steps.small_accepted;
      step_chain(arrays_, step_, i, samples_[i]);
      if (steps.large_accepted + steps.small_accepted > before) current_[i] = paths_[i];
    }
  }

  std::function<float(float)> target_;
  std::vector<std::vector<char>> memory_;
  std::vector<Sample> samples_;
  std::vector<ToyPath> paths_, current_;
  ChainArrays arrays_;
  ChainStep step_;
};

std::vector<double> cells_of(const std::vector<ToyPath>& states) {
  std::vector<double> counts(toy_parts().size());
  for (const ToyPath& path : states) ++counts[toy_cell(path)];
  return counts;
}

/// The chi-square statistic by its degrees of freedom.
double reduced_chi_square(const std::vector<double>& counts) {
  double total = 0, chi2 = 0;
  for (const double count : counts) total += count;
  const std::vector<double> parts = toy_parts();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double mean = total * parts[i];
    chi2 += (counts[i] - mean) * (counts[i] - mean) / mean;
  }
  return chi2 / (static_cast<double>(parts.size()) - 1);
}

struct ToyCase {
  double large;
  std::uint32_t blocks;
};

const ToyCase toy_cases[] = {{0.3, 6},    // all that a long path asks for
                             {0.3, 4},    // a long path's last numbers are fresh each time
                             {0.3, 1},    // so are all but those of the camera
                             {0.01, 6}};  // nearly nothing but small steps

// Many chains that begin in the target's distribution must stay in it, and do not depend on each
// other.
TEST(MarkovChains, StayInTheTargetsDistribution) {
  for (const ToyCase& toy : toy_cases) {
    ToyChains chains(40000, toy.blocks, toy.large, 5);
    std::vector<double> expected = toy_parts();
    for (double& part : expected) part *= 40000;
    expect_counts(cells_of(chains.states()), expected, "at the start");
    chains.mutate(25);
    expect_counts(cells_of(chains.states()), expected,
                  "after 25 steps, large " + std::to_string(toy.large) + ", blocks " +
                      std::to_string(toy.blocks));
  }
}

// What a chain of another target would visit is told from it: so the test above sees a rule that
// accepts too much or too little.
TEST(MarkovChains, OfAnotherTargetAreTold) {
  ToyChains milder(40000, 6, 0.3, 5, [](float f) { return std::pow(f, 0.8f); });
  milder.mutate(25);
  EXPECT_GT(reduced_chi_square(cells_of(milder.states())), 4);
  ToyChains all(40000, 6, 0.3, 5, [](float f) { return f > 0 ? 1.0f : 0.0f; });
  all.mutate(25);
  EXPECT_GT(reduced_chi_square(cells_of(all.states())), 50);
  ToyChains right(40000, 6, 0.3, 5);
  right.mutate(25);
  EXPECT_LT(reduced_chi_square(cells_of(right.states())), 1.5);
}

// One chain alone, long enough: every 50th state hardly knows the one before.
TEST(MarkovChains, OneVisitsStatesInProportionToTheTarget) {
  ToyChains chain(1, 6, 0.3, 11);
  constexpr int count = 8000;
  std::vector<double> counts(toy_parts().size()), expected = toy_parts();
  for (int i = 0; i < count; ++i) {
    chain.mutate(50);
    ++counts[toy_cell(chain.states()[0])];
  }
  for (double& part : expected) part *= count;
  expect_counts(counts, expected, "one chain");
}

TEST(MarkovChains, AddUpToTheImage) {
  for (const ToyCase& toy : toy_cases) {
    std::vector<MeanEstimate> pixels(side * side);
    constexpr std::uint32_t chains_each = 200;
    constexpr int steps = 40;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      ToyChains chains(chains_each, toy.blocks, toy.large, 100 * seed + 7);
      chains.mutate(steps);
      chains.finish();
      for (std::uint32_t i = 0; i < pixels.size(); ++i) {
        pixels[i].add(side * side * chains.sum(i) / (chains_each * steps));
      }
    }
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
      const double x = (i % side + 0.5) / side, y = (i / side + 0.5) / side;
      const double expected = 0.5 * (0.2 + x) + 0.5 * (0.2 + y);
      EXPECT_NEAR(pixels[i].mean(), expected, 5 * pixels[i].sigma()) << "pixel " << i;
      EXPECT_LT(pixels[i].sigma(), 0.04 * expected);
    }
  }
}

// Whatever brightness the weights expected, and however many bootstrap paths there were.
TEST(MarkovChains, AddUpToTheImageWithTheirBootstrap) {
  for (const double expected : {0.2, 0.7, 3.0}) {
    std::vector<MeanEstimate> pixels(side * side), of_bootstrap(side * side);
    constexpr std::uint32_t chains_each = 200, paths = 4000;
    constexpr int steps = 40;
    constexpr double share = 0.5;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      ToyChains chains(chains_each, 6, 0.3, 100 * seed + 7);
      const std::vector<double> bootstrap = chains.bootstrap(expected, share, paths);
      chains.mutate(steps);
      chains.finish();
      for (std::uint32_t i = 0; i < pixels.size(); ++i) {
        const double part = side * side * bootstrap[i] * share / paths;
        of_bootstrap[i].add(part);
        pixels[i].add(part + side * side * chains.sum(i) / (chains_each * steps));
      }
    }
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
      const double x = (i % side + 0.5) / side, y = (i / side + 0.5) / side;
      const double mean = 0.5 * (0.2 + x) + 0.5 * (0.2 + y);
      EXPECT_NEAR(pixels[i].mean(), mean, 5 * pixels[i].sigma()) << expected << " pixel " << i;
      EXPECT_LT(pixels[i].sigma(), 0.04 * mean);
      EXPECT_GT(of_bootstrap[i].mean(), 0.05 * mean);
    }
  }
}

// Sums may be taken at any time: what was not yet added then is not added later.
TEST(MarkovChains, AddUpToTheSameInParts) {
  ToyChains whole(500, 6, 0.3, 3), parts(500, 6, 0.3, 3);
  whole.mutate(40);
  for (const int steps : {1, 14, 25}) {
    parts.mutate(steps);
    parts.finish();
  }
  whole.finish();
  for (std::uint32_t i = 0; i < side * side; ++i) {
    EXPECT_NEAR(parts.sum(i), whole.sum(i), 1e-9 * whole.sum(i)) << i;
  }
}

TEST(MarkovChains, TakeLargeStepsAsOftenAsTheyShould) {
  ToyChains chains(10000, 6, 0.3, 3);
  chains.mutate(20);
  const ChainTally& t = chains.tally();
  EXPECT_EQ(t.large + t.small, 200000u);
  expect_counts({static_cast<double>(t.large), static_cast<double>(t.small)}, {60000, 140000},
                "large and small");
  EXPECT_GT(t.small_accepted, 0.8 * static_cast<double>(t.small));
  EXPECT_LT(t.large_accepted, 0.7 * static_cast<double>(t.large));
  EXPECT_GT(t.large_accepted, 0.2 * static_cast<double>(t.large));
}

// Black and broken proposals are never accepted; the state stays and counts for each of them.
TEST(MarkovChains, StayWhereEverythingElseIsBlack) {
  for (const float other : {0.0f, std::numeric_limits<float>::quiet_NaN(), HUGE_VALF}) {
    bool first = true;
    ToyChains chain(1, 6, 0.5, 3, [&](float f) { return std::exchange(first, false) ? f : other; });
    const ToyPath begin = chain.states()[0];
    chain.mutate(1000);
    chain.finish();
    EXPECT_EQ(chain.tally().large_accepted + chain.tally().small_accepted, 0u);
    const auto pixel = static_cast<std::uint32_t>(begin.y * side) * side +
                       static_cast<std::uint32_t>(begin.x * side);
    const double each = begin.radiance / (begin.radiance / toy_mean + 0.5);
    for (std::uint32_t i = 0; i < side * side; ++i) {
      EXPECT_NEAR(chain.sum(i), i == pixel ? 1000 * each : 0.0, 1e-3) << i;
    }
  }
}

/// Where so many chains begin among bootstrap paths of these targets.
struct Begun {
  ChainStarts starts;
  std::vector<std::uint32_t> paths;
};
Begun begin_chains(std::vector<float> targets, std::uint32_t chains, double u) {
  const auto count = static_cast<std::uint32_t>(targets.size());
  std::vector<TargetSum> groups(Bootstrap::group_count(count));
  Bootstrap bootstrap{targets.data(), groups.data(), nullptr};
  for (std::uint32_t g = 0; g < groups.size(); ++g) groups[g] = sum_group(bootstrap, g, count);
  Begun begun{choose_starts(groups, count, chains, u), {}};
  bootstrap.below = begun.starts.below.data();
  for (std::uint32_t i = 0; i < chains; ++i) {
    begun.paths.push_back(start_of(bootstrap, begun.starts.positions, i));
  }
  return begun;
}

TEST(ChainStarts, AreInProportionToTheTarget) {
  for (const double u : {0.0, 0.3, 0.999}) {
    const Begun begun = begin_chains({0, 1, 0, 2, 5, 0}, 8, u);
    std::vector<int> counts(6);
    for (const std::uint32_t path : begun.paths) ++counts[path];
    EXPECT_EQ(counts, (std::vector<int>{0, 1, 0, 2, 5, 0})) << u;
    EXPECT_DOUBLE_EQ(begun.starts.brightness, 8.0 / 6);
    EXPECT_NEAR(begun.starts.brightness_error, std::sqrt((30 - 64.0 / 6) / 5 / 6), 1e-12);
  }
  std::vector<double> counts(3);
  for (int i = 0; i < 1000; ++i) ++counts[begin_chains({1, 3, 1}, 1, (i + 0.5) / 1000).paths[0]];
  EXPECT_EQ(counts, (std::vector<double>{200, 600, 200}));
}

// Many groups of paths, some without light, and targets whose sums are rounded: each path has the
// chains that one walk over all of them in double precision gives it.
TEST(ChainStarts, AreThoseOfOneWalkOverAllPaths) {
  TestRandom random;
  for (const std::uint32_t count : {255u, 256u, 257u, 5000u}) {
    std::vector<float> targets(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const bool is_dark = i / 256 % 3 == 1 || i + 300 > count || random.unit() < 0.7f;
      if (!is_dark) targets[i] = std::pow(random.unit() + 1e-3f, -3.0f);
    }
    if (count < 1000) targets[count / 2] = 1;
    for (const double u : {0.0, 0.37, std::nextafter(1.0, 0.0)}) {
      const std::uint32_t chains = 3000;
      const Begun begun = begin_chains(targets, chains, u);
      double sum = 0;
      for (const float target : targets) sum += target;
      std::vector<double> found(count);
      for (const std::uint32_t path : begun.paths) ++found[path];
      std::uint32_t last = 0;
      for (const std::uint32_t path : begun.paths) {
        EXPECT_GE(path, last);
        last = path;
      }
      for (std::uint32_t i = 0; i < count; ++i) {
        const double share = chains * targets[i] / sum;
        EXPECT_LT(std::abs(found[i] - share), 1 + 1e-9) << count << " " << i;
        if (targets[i] == 0) {
          EXPECT_EQ(found[i], 0) << count << " " << i;
        }
      }
    }
  }
}

// Beside 2^53 each target of 1 is lost, while their sum is not: the walk ends at the last of them.
TEST(ChainStarts, HaveLightWhereRoundingEndsTheWalk) {
  std::vector<float> targets(512);
  targets[0] = 0x1p53f;
  for (std::uint32_t i = 256; i < 384; ++i) targets[i] = 1;
  EXPECT_EQ(begin_chains(targets, 1, std::nextafter(1.0, 0.0)).paths[0], 383u);
}

TEST(ChainStarts, OfOnePathAndOfNone) {
  const Begun one = begin_chains({2}, 3, 0.5);
  EXPECT_EQ(one.paths, (std::vector<std::uint32_t>{0, 0, 0}));
  EXPECT_EQ(one.starts.brightness, 2);
  EXPECT_EQ(one.starts.brightness_error, 0);
  EXPECT_THROW(begin_chains({0, 0}, 3, 0.5), Error);
}

}  // namespace
}  // namespace pt
