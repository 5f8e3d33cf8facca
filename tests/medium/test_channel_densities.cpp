// Which channel samples a path's events, and what they then weigh.
#include <gtest/gtest.h>

#include "common/medium/distance_sampling.h"
#include "statistics.h"

namespace pt {
namespace {

TEST(ChannelDensities, BeginAlike) {
  const ChannelDensities densities;
  EXPECT_EQ(densities.all(), Color(1.0f));
  EXPECT_EQ(densities.choose(0.0f), 0);
  EXPECT_EQ(densities.choose(0.34f), 1);
  EXPECT_EQ(densities.choose(one_minus_ulp), 2);
}

TEST(ChannelDensities, AreChosenInProportion) {
  for (const auto& [red, green] :
       {std::pair{1.0f, 1.0f}, {0.0f, 3.0f}, {0.25f, 0.0f}, {0.6f, 1.9f}}) {
    const ChannelDensities densities{red, green};
    constexpr int samples = 30'000;
    std::vector<double> counts(3);
    for (int i = 0; i < samples; ++i) {
      ++counts[static_cast<std::size_t>(
          densities.choose((static_cast<float>(i) + 0.5f) / samples))];
    }
    const double expected[] = {double{red}, double{green}, 3 - double{red} - double{green}};
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(counts[c], samples * expected[c] / 3, 1);
  }
}

// After some events they are the products of the events' densities, over their mean: the channel is
// then chosen with the probability that the path so far was sampled by it (Bayes).
TEST(ChannelDensities, AreThoseOfAllEvents) {
  TestRandom random(51);
  for (int round = 0; round < 200; ++round) {
    ChannelDensities densities;
    glm::dvec3 product(1);
    const auto missing = static_cast<int>(random.below(6));  // a channel that meets nothing
    for (int event = 0; event < 5; ++event) {
      glm::dvec3 density, value;
      for (int c = 0; c < 3; ++c) {
        density[c] = c == missing ? 0 : random.log_uniform(0.5, 2);
        value[c] = random.uniform(0, 2);
      }
      const Color found = densities.weigh(Color(value), Color(density));
      const glm::dvec3 before = product * 3.0 / (product.x + product.y + product.z);
      product *= density;
      const double mean_density = glm::dot(before, density) / 3;
      const glm::dvec3 expected = product * 3.0 / (product.x + product.y + product.z);
      for (int c = 0; c < 3; ++c) {
        ASSERT_NEAR(found[c], value[c] / mean_density, 1e-5);
        ASSERT_NEAR(densities.all()[c], expected[c], 1e-5);
      }
      ASSERT_NEAR(mean(densities.all()), 1, 1e-6);
    }
  }
}

// Rounding may move the densities, but a weight is one over that with which the event was chosen:
// so nothing is biased, whatever a path has met.
TEST(ChannelDensities, AnEventWeighsByTheProbabilityThatItHad) {
  TestRandom random(52);
  ChannelDensities densities;
  for (int event = 0; event < 10'000; ++event) {
    glm::dvec3 density;
    for (int c = 0; c < 3; ++c)
      density[c] = random.below(9) == 0 ? 0 : random.log_uniform(0.01, 99);
    const Color before = densities.all();
    const double probability = glm::dot(glm::dvec3(before), density) / 3;
    const Color found = densities.weigh(Color(1.0f), Color(density));
    if (!(probability > 0)) {
      EXPECT_EQ(found, Color(0.0f));
      densities = {};
      continue;
    }
    EXPECT_NEAR(double{found.x} * probability, 1, 1e-5);
    EXPECT_NEAR(mean(densities.all()), 1, 1e-5);
  }
}

TEST(ChannelDensities, FollowTheChannelThatIsLeft) {
  ChannelDensities densities;
  // Where red alone gets through, it is three times as bright, and red from then on.
  EXPECT_EQ(densities.weigh({1, 0, 0}, {1, 0, 0}), Color(3, 0, 0));
  EXPECT_EQ(densities.all(), Color(3, 0, 0));
  EXPECT_EQ(densities.choose(one_minus_ulp), 0);
  EXPECT_EQ(densities.weigh({1, 1, 1}, {0.5f, 7, 9}), Color(2.0f));
  EXPECT_EQ(densities.weigh({1, 1, 1}, {0, 7, 9}), Color(0.0f));
}

TEST(ChannelDensities, KnowGrey) {
  EXPECT_TRUE(is_grey(Color(0.3f)));
  EXPECT_FALSE(is_grey({0.3f, 0.3f, 0.31f}));
  EXPECT_FALSE(is_grey({0.2f, 0.3f, 0.3f}));
  EXPECT_EQ(channel({1, 2, 3}, 0), 1);
  EXPECT_EQ(channel({1, 2, 3}, 1), 2);
  EXPECT_EQ(channel({1, 2, 3}, 2), 3);
}

}  // namespace
}  // namespace pt
