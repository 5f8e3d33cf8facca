// The random numbers: published vectors, independence of order, and sanity of their statistics.
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "common/sampling/random.h"
#include "common/transport/path.h"
#include "statistics.h"

namespace pt {
namespace {

using Words = std::array<std::uint32_t, 4>;

Words philox(const Words& c, std::uint32_t key0, std::uint32_t key1) {
  const Uint4 r = philox4x32_10({c[0], c[1], c[2], c[3]}, key0, key1);
  return {r.x, r.y, r.z, r.w};
}

// Random123's kat_vectors, philox4x32 with 10 rounds.
TEST(Philox, KnownAnswers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, 0, 0), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({~0u, ~0u, ~0u, ~0u}, ~0u, ~0u),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, 0xa4093822, 0x299f31d0),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

/// Marsaglia's five words as a history of one sequence instead of a state that moves.
std::vector<std::uint32_t> marsaglia_xorwow(std::vector<std::uint32_t> v, std::uint32_t d, int n) {
  std::vector<std::uint32_t> output;
  for (int i = 0; i < n; ++i) {
    const std::uint32_t t = v[i] ^ v[i] / 4, last = v.back();
    v.push_back((last ^ last * 16) ^ (t ^ t * 2));
    output.push_back(v.back() + d + 362437u * static_cast<std::uint32_t>(i + 1));
  }
  return output;
}

// The first seed undoes cuRAND's scrambling, which leaves the state of Marsaglia's paper.
TEST(Xorwow, FollowsMarsagliasRecurrence) {
  XorwowState paper;
  xorwow_init(0xf7dcefddaad26b49u, paper);
  EXPECT_EQ(std::vector(paper.x, paper.x + 5),
            (std::vector<std::uint32_t>{123456789, 362436069, 521288629, 88675123, 5783321}));
  EXPECT_EQ(paper.weyl, 6615241u);
  TestRandom random;
  for (int k = 0; k < 100; ++k) {
    XorwowState state = paper;
    if (k > 0) xorwow_init(std::uint64_t{random.bits()} << 32 | random.bits(), state);
    for (const std::uint32_t expected :
         marsaglia_xorwow({state.x, state.x + 5}, state.weyl, 1000)) {
      ASSERT_EQ(xorwow_next(state), expected);
    }
  }
}

// The first numbers of cuRAND 13.0's curand_init(seed, 0, 0).
TEST(Xorwow, KnownAnswersOfCurand) {
  const auto first_four = [](std::uint64_t seed) {
    XorwowState state;
    xorwow_init(seed, state);
    Words words;
    for (std::uint32_t& word : words) word = xorwow_next(state);
    return words;
  };
  EXPECT_EQ(first_four(1), (Words{2898200796, 3111669439, 2179589753, 379598403}));
  EXPECT_EQ(first_four(0x123456789abcdef0), (Words{659909570, 1683698917, 4246992159, 3394647409}));
}

TEST(UnitFloat, IsTheUpper24BitsAndBelowOne) {
  EXPECT_EQ(to_unit_float(0), 0.0f);
  EXPECT_EQ(to_unit_float(255), 0.0f);
  EXPECT_EQ(to_unit_float(256), 0x1p-24f);
  EXPECT_EQ(to_unit_float(0xffffffffu), one_minus_ulp);
  TestRandom random;
  for (int i = 0; i < 1'000'000; ++i) {
    const std::uint32_t bits = random.bits();
    ASSERT_EQ(static_cast<double>(to_unit_float(bits)), std::floor(bits / 256.0) / 16777216.0);
  }
}

PathId path_id(std::uint32_t x, std::uint32_t y, std::uint32_t sample, std::uint32_t place = 0) {
  return {pack_pixel(x, y), sample, place};
}

TEST(PhiloxStream, DependsOnTheNameOfADrawAlone) {
  const PhiloxSource source{42};
  auto forward = source.open(path_id(3, 5, 7));
  std::vector<Vec4> draws;
  for (std::uint32_t block = 0; block < 100; ++block) draws.push_back(forward.draw(block));
  source.close(path_id(3, 5, 7), forward);
  auto elsewhere = source.open(path_id(3, 5, 7, 99));  // another place in the batch
  for (std::uint32_t block = 100; block-- > 0;) EXPECT_EQ(elsewhere.draw(block), draws[block]);

  std::set<std::array<float, 4>> distinct;
  for (const PhiloxSource& s : {source, PhiloxSource{43}, PhiloxSource{42 | 1ull << 32}}) {
    for (const PathId& id :
         {path_id(3, 5, 7), path_id(4, 5, 7), path_id(5, 3, 7), path_id(3, 5, 8)}) {
      for (std::uint32_t rays = 0; rays < 3; ++rays) {
        for (const std::uint32_t block : {scatter_block(rays), light_block(rays)}) {
          const Vec4 u = s.open(id).draw(block);
          distinct.insert({u.x, u.y, u.z, u.w});
        }
      }
    }
  }
  EXPECT_EQ(distinct.size(), 3u * 4 * 6);
}

/// [number of the component]: every draw of a block of pixels, samples and draws, x fastest.
using Series = std::vector<float>;
constexpr int side = 64, samples = 8, blocks = 8;

template <class Open>
Series draw_all(const Open& open) {
  Series u(std::size_t{4} * side * side * samples * blocks);
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      for (std::uint32_t s = 0; s < samples; ++s) {
        auto stream = open(path_id(x, y, s));
        for (std::uint32_t b = 0; b < blocks; ++b) {
          const Vec4 four = stream.draw(b);
          for (std::uint32_t i = 0; i < 4; ++i) {
            u[x + side * (y + side * (s + samples * (b + blocks * i)))] = four[static_cast<int>(i)];
          }
        }
      }
    }
  }
  return u;
}

void expect_sane(const Series& u, const std::string& name) {
  const auto n = static_cast<double>(u.size());
  double mean = 0, variance = 0;
  std::vector<double> histogram(256);
  for (const float x : u) mean += x / n, ++histogram[cell_of(x, 256)];
  for (const float x : u) variance += (x - 0.5) * (x - 0.5) / n;
  EXPECT_NEAR(mean, 0.5, 5 * std::sqrt(1 / (12 * n))) << name;
  EXPECT_NEAR(variance, 1.0 / 12, 5 * std::sqrt(1 / (180 * n))) << name;
  expect_uniform(histogram, n, name);
  // Neighbours at these distances: pixel in x, in y, sample, block, component; then far ones.
  for (const std::size_t lag : {1, side, side * side, side * side * samples,
                                side * side * samples * blocks, side + 1, 7 * side + 3}) {
    double correlation = 0;
    std::vector<double> pairs(32 * 32);
    const auto count = static_cast<double>(u.size() - lag);
    for (std::size_t i = 0; i + lag < u.size(); ++i) {
      correlation += (u[i] - 0.5) * (u[i + lag] - 0.5) * 12 / count;
      ++pairs[32 * cell_of(u[i], 32) + cell_of(u[i + lag], 32)];
    }
    EXPECT_LE(std::abs(correlation), 5 / std::sqrt(count)) << name << ", lag " << lag;
    expect_uniform(pairs, count, name + ", pairs at lag " + std::to_string(lag));
  }
}

TEST(RandomSources, StatisticsAreSane) {
  const PhiloxSource philox{1};
  const Series first = draw_all([&](const PathId& id) { return philox.open(id); });
  expect_sane(first, "philox");
  const auto open_xorwow = [](const PathId& id) {
    XorwowSource<XorwowState>::Stream stream;
    xorwow_init(xorwow_seed(1, id), stream.state);
    return stream;
  };
  expect_sane(draw_all(open_xorwow), "xorwow");
  const Series second = draw_all([](const PathId& id) { return PhiloxSource{2}.open(id); });
  double correlation = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    correlation += (first[i] - 0.5) * (second[i] - 0.5) * 12 / static_cast<double>(first.size());
  }
  EXPECT_LE(std::abs(correlation), 5 / std::sqrt(static_cast<double>(first.size()))) << "seeds";
}

TEST(XorwowSeed, NoTwoPathsShareOne) {
  std::vector<std::uint64_t> seeds;
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{1} << 32}) {
    for (std::uint32_t s = 0; s < 8; ++s) {
      for (std::uint32_t i = 0; i < 256 * 256; ++i) {
        seeds.push_back(xorwow_seed(seed, path_id(i % 256, i / 256, s)));
      }
    }
  }
  std::sort(seeds.begin(), seeds.end());
  EXPECT_EQ(std::adjacent_find(seeds.begin(), seeds.end()), seeds.end());
}

TEST(XorwowSource, KeepsTheStateBetweenDraws) {
  std::vector<XorwowState> states(3);
  for (std::size_t i = 0; i < 3; ++i) xorwow_init(i, states[i]);
  XorwowState reference = states[2];
  const XorwowSource<XorwowState> source{states.data()};
  for (int turn = 0; turn < 3; ++turn) {
    auto stream = source.open(path_id(0, 0, 0, 2));
    const Vec4 u = stream.draw(17);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(u[i], to_unit_float(xorwow_next(reference)));
    source.close(path_id(0, 0, 0, 2), stream);
  }
}

}  // namespace
}  // namespace pt
