// Samplers: a pixel's samples fill grids and elementary intervals as they promise, and remain
// uniform, each alone, over the seeds.
#include <algorithm>
#include <set>

#include "common/options/option_names.h"
#include "common/sampling/sampler_source.h"
#include "statistics.h"

namespace pt {
namespace {

constexpr std::uint32_t pixel = 17u | 5u << 16;

std::vector<Vec4> block_of(SamplerKind kind, std::uint32_t samples, std::uint32_t block,
                           std::uint64_t seed = 3) {
  const SamplerSource source{seed, make_sampler(kind, samples)};
  std::vector<Vec4> values;
  for (std::uint32_t i = 0; i < samples; ++i) {
    values.push_back(source.open({pixel, i, 0}).draw(block));
    for (int c = 0; c < 4; ++c) {
      EXPECT_GE(values.back()[c], 0.0f);
      EXPECT_LT(values.back()[c], 1.0f);
    }
  }
  return values;
}

/// How many different cells of a grid the pair (first, first + 1) of the values lies in.
std::size_t cells_met(const std::vector<Vec4>& values, int first, std::uint32_t columns,
                      std::uint32_t rows) {
  std::set<std::pair<int, int>> cells;
  for (const Vec4& v : values) {
    cells.insert({static_cast<int>(v[first] * static_cast<float>(columns)),
                  static_cast<int>(v[first + 1] * static_cast<float>(rows))});
  }
  return cells.size();
}

TEST(Samplers, IndependentNumbersAreThoseOfPhilox) {
  const SamplerSource source{3, make_sampler(SamplerKind::independent, 16)};
  for (std::uint32_t i = 0; i < 16; ++i) {
    EXPECT_EQ(source.open({pixel, i, 0}).draw(4), PhiloxSource{3}.open({pixel, i, 0}).draw(4));
  }
}

TEST(Samplers, StratifiedSamplesTakeEveryCellOnce) {
  for (const std::uint32_t count : {1u, 4u, 6u, 16u, 49u, 50u, 256u}) {
    const StrataGrid grid = make_strata_grid(count);
    EXPECT_LE(grid.cells(), count);
    EXPECT_LE(grid.columns, grid.rows);
    for (const std::uint32_t block : {0u, 1u, 7u}) {
      auto values = block_of(SamplerKind::stratified, count, block);
      values.resize(grid.cells());  // what is left over lies anywhere
      EXPECT_EQ(cells_met(values, 0, grid.columns, grid.rows), grid.cells()) << count;
      EXPECT_EQ(cells_met(values, 2, grid.columns, grid.rows), grid.cells()) << count;
    }
  }
}

TEST(Samplers, StratifiedSamplesBehindTheLastBeginAnotherGrid) {
  const SamplerSource source{3, make_sampler(SamplerKind::stratified, 16)};
  std::vector<Vec4> second;
  for (std::uint32_t i = 16; i < 32; ++i) second.push_back(source.open({pixel, i, 0}).draw(0));
  EXPECT_EQ(cells_met(second, 0, 4, 4), 16u);
}

// Every box of 2^-a by 2^-b with a + b = 6 has one of 64 points, and of each aligned run of 64.
TEST(Samplers, SobolPointsAreNets) {
  for (const std::uint32_t block : {0u, 1u, 2u, 9u}) {
    const auto values = block_of(SamplerKind::sobol, 256, block);
    for (std::size_t run = 0; run < 256; run += 64) {
      const std::vector<Vec4> net(values.begin() + static_cast<long>(run),
                                  values.begin() + static_cast<long>(run) + 64);
      for (int a = 0; a <= 6; ++a) {
        EXPECT_EQ(cells_met(net, 0, 1u << a, 64u >> a), 64u) << "a = " << a;
        EXPECT_EQ(cells_met(net, 2, 1u << a, 64u >> a), 64u) << "a = " << a;
      }
    }
  }
}

// One pair tells nothing of another one, nor one block of another: over the cells of a grid of
// both, samples of many seeds are uniform.
TEST(Samplers, EachSampleIsUniformAndPairsAreIndependent) {
  for (const auto& [kind, name] : enum_names<SamplerKind>) {
    constexpr int bins = 4, seeds = 20000;
    std::vector<double> counts(bins * bins * bins * bins), across(bins * bins);
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
      auto stream = SamplerSource{seed, make_sampler(kind, 16)}.open({pixel, 5, 0});
      const Vec4 u = stream.draw(0), next = stream.draw(1);
      std::size_t bin = 0;
      for (int c = 0; c < 4; ++c) {
        bin = bin * bins + static_cast<std::size_t>(u[c] * static_cast<float>(bins));
      }
      ++counts[bin];
      ++across[static_cast<std::size_t>(u.x * bins) * bins +
               static_cast<std::size_t>(next.x * bins)];
    }
    const auto chi2 = [](const std::vector<double>& found) {
      const double expected = seeds / static_cast<double>(found.size());
      double sum = 0;
      for (const double n : found) sum += (n - expected) * (n - expected) / expected;
      return sum;
    };
    // Mean dof, standard deviation sqrt(2 dof): five of them above.
    EXPECT_LT(chi2(counts), 255 + 5 * std::sqrt(2 * 255.0)) << name;
    EXPECT_LT(chi2(across), 15 + 6 * std::sqrt(2 * 15.0)) << name;
  }
}

/// How the mean over a pixel's 64 samples of (u - 1/2) (v - 1/2), whose own mean is 0, varies with
/// the seed, by what it is for independent numbers: u of one place in the blocks, v of another.
double relative_variance(SamplerKind kind, std::pair<std::uint32_t, int> u,
                         std::pair<std::uint32_t, int> v) {
  constexpr int seeds = 300;
  double sum2 = 0;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const auto first = block_of(kind, 64, u.first, seed),
               second = block_of(kind, 64, v.first, seed);
    double mean = 0;
    for (std::size_t i = 0; i < 64; ++i) {
      mean += (first[i][u.second] - 0.5) * (second[i][v.second] - 0.5) / 64;
    }
    sum2 += mean * mean / seeds;
  }
  return sum2 * 144 * 64;
}

// Numbers of two pairs that were shuffled alike would go along with each other within a pixel,
// though each sample by itself was uniform over the seeds: then the mean varies as that of few
// samples. Sobol's shuffle keeps runs of 2^m together, so that of n samples n / 2 are independent
// in their first bits: up to twice the variance.
TEST(Samplers, PairsAreShuffledApart) {
  for (const auto& [kind, name] : enum_names<SamplerKind>) {
    if (kind == SamplerKind::independent) continue;
    SCOPED_TRACE(name);
    for (const int a : {0, 1}) {
      for (const int b : {2, 3}) {
        EXPECT_NEAR(relative_variance(kind, {2, a}, {2, b}), 1.3, 0.8) << a << b;
      }
    }
    EXPECT_NEAR(relative_variance(kind, {2, 0}, {3, 0}), 1.3, 0.8);
    EXPECT_NEAR(relative_variance(kind, {2, 2}, {4, 2}), 1.3, 0.8);
    EXPECT_LT(relative_variance(kind, {2, 0}, {2, 1}), 0.2) << "a pair";
  }
}

// A sample and the one that many later meet in a cell of 16 as often as any two.
TEST(Samplers, RoundsOfStrataDoNotRepeat) {
  constexpr int seeds = 400;
  for (const int pair : {0, 2}) {
    int equal = 0;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
      const SamplerSource source{seed, make_sampler(SamplerKind::stratified, 16)};
      const auto cell = [&](std::uint32_t sample) {
        const Vec4 u = source.open({pixel, sample, 0}).draw(1);
        return static_cast<int>(4 * u[pair]) * 4 + static_cast<int>(4 * u[pair + 1]);
      };
      for (std::uint32_t i = 0; i < 16; ++i) equal += cell(i) == cell(16 + i);
    }
    EXPECT_NEAR(equal, seeds, 5 * std::sqrt(seeds)) << "pair " << pair;
  }
}

// The integral of x y over the unit square, 1/4: strata divide the variance of n numbers by about
// n, Owen's nets by more.
TEST(Samplers, IntegrateWithLessVariance) {
  const auto variance = [](SamplerKind kind) {
    double sum2 = 0;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
      double mean = 0;
      for (const Vec4& u : block_of(kind, 64, 2, seed)) mean += double{u.x} * u.y / 64;
      sum2 += (mean - 0.25) * (mean - 0.25) / 400;
    }
    return sum2;
  };
  const double independent = variance(SamplerKind::independent);
  EXPECT_NEAR(independent, 7.0 / 144 / 64, 0.3 * 7.0 / 144 / 64);
  EXPECT_LT(variance(SamplerKind::stratified), independent / 20);
  EXPECT_LT(variance(SamplerKind::sobol), independent / 100);
}

}  // namespace
}  // namespace pt
