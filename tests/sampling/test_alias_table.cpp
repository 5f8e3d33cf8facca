// The alias table: its probabilities, summed exactly, and its samples, counted.
#include <gtest/gtest.h>

#include <limits>

#include "common/sampling/alias_table.h"
#include "statistics.h"
#include "temp_folder.h"

namespace pt {
namespace {

/// What the table gives to each entry: probabilities, in units of 1 / n.
std::vector<double> shares(const std::vector<AliasEntry>& table) {
  std::vector<double> sum(table.size());
  for (std::size_t i = 0; i < table.size(); ++i) {
    sum[i] += double{table[i].threshold};
    sum[table[i].alias] += 1 - double{table[i].threshold};
  }
  return sum;
}

struct Case {
  std::string name;
  std::vector<float> weights;
};

std::vector<Case> cases() {
  TestRandom random;
  std::vector<float> uniform(1000, 3.7f), wide(100'000), sparse(4099, 0.0f), sun(65'536, 1e-3f);
  for (float& w : wide) w = static_cast<float>(random.log_uniform(1e-6, 1e6));
  for (int i = 0; i < 50; ++i) sparse[random.below(4099)] = random.unit() + 0.01f;
  sun[12'345] = 1e6f;
  return {
      {"one", {0.25f}},
      {"two, one of them zero", {0.0f, 5.0f}},
      {"rising", {1, 2, 3, 4, 5, 6, 7}},
      {"falling", {7, 6, 5, 4, 3, 2, 1}},
      {"zeros at both ends", {0, 0, 1, 0, 1e-30f, 0}},
      {"largest floats", {std::numeric_limits<float>::max(), std::numeric_limits<float>::max()}},
      {"smallest floats", {1e-45f, 3e-45f, 0, 1e-44f}},
      {"uniform", uniform},
      {"over twelve decades", wide},
      {"sparse", sparse},
      {"sun", sun}};
}

double sum_of(const std::vector<float>& weights) {
  double sum = 0;
  for (const float w : weights) sum += double{w};
  return sum;
}

TEST(AliasTable, HoldsTheProbabilities) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const std::vector<AliasEntry> table = build_alias_table(c.weights);
    ASSERT_EQ(table.size(), c.weights.size());
    const double mean = sum_of(c.weights) / static_cast<double>(table.size());
    const std::vector<double> share = shares(table);
    for (std::size_t i = 0; i < table.size(); ++i) {
      ASSERT_GE(table[i].threshold, 0.0f);
      ASSERT_LE(table[i].threshold, 1.0f);
      ASSERT_LT(table[i].alias, table.size());
      const double exact = double{c.weights[i]} / mean;
      // Thresholds are rounded to floats; a heavy entry sums many of them.
      ASSERT_NEAR(share[i], exact, 1e-7 * (exact + 1)) << i;
      if (c.weights[i] == 0) {
        ASSERT_EQ(share[i], 0.0) << i;
      } else if (table[i].threshold < 1) {
        ASSERT_NEAR(share[i], exact, 2e-7 * exact) << "a light entry is relatively exact, " << i;
      }
    }
  }
}

TEST(AliasTable, SamplesFollowTheWeights) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const std::vector<AliasEntry> table = build_alias_table(c.weights);
    const auto n = static_cast<std::uint32_t>(table.size());
    constexpr int samples = 400'000;
    for (const bool two : {false, true}) {
      if (!two && n > 4096) continue;
      TestRandom random(two ? 2 : 3);
      std::vector<double> counts(n), expected(n), rest(64);
      for (int i = 0; i < samples; ++i) {
        const float u = random.unit();
        const AliasSample s = two ? sample_alias(table.data(), n, u, random.unit())
                                  : sample_alias(table.data(), n, u);
        ASSERT_LT(s.index, n);
        ASSERT_TRUE(s.u >= 0 && s.u < 1) << s.u;
        ASSERT_GT(c.weights[s.index], 0.0f);
        ++counts[s.index];
        ++rest[cell_of(s.u, 64)];
      }
      const double sum = sum_of(c.weights);
      for (std::size_t i = 0; i < n; ++i) expected[i] = samples * double{c.weights[i]} / sum;
      expect_counts(counts, expected, c.name);
      expect_uniform(rest, samples, c.name + ", what is left of u");
    }
  }
}

TEST(AliasTable, WhatIsLeftOfUIsIndependentOfTheIndex) {
  const std::vector<float> weights = {1, 10, 0, 4, 2.5f};
  const std::vector<AliasEntry> table = build_alias_table(weights);
  constexpr int cells = 16, samples = 500'000;
  std::vector<double> counts(5 * cells), expected(5 * cells);
  TestRandom random(4);
  for (int i = 0; i < samples; ++i) {
    const AliasSample s = sample_alias(table.data(), 5, random.unit());
    ++counts[s.index * cells + cell_of(s.u, cells)];
  }
  for (std::size_t i = 0; i < expected.size(); ++i)
    expected[i] = samples * double{weights[i / cells]} / 17.5 / cells;
  expect_counts(counts, expected, "index and rest");
}

// A 4K map has 2^23 texels and more: one float of 24 bits could not choose among them evenly.
TEST(AliasTable, TwoFloatsReachEveryEntryOfALargeTable) {
  const std::uint32_t n = 6'000'001;
  const std::vector<AliasEntry> table = build_alias_table(std::vector<float>(n, 1.0f));
  std::vector<double> counts(97);
  TestRandom random(5);
  constexpr int samples = 1'000'000;
  for (int i = 0; i < samples; ++i)
    ++counts[sample_alias(table.data(), n, random.unit(), random.unit()).index % 97];
  expect_uniform(counts, samples, "6 million entries");
  const float last = one_minus_ulp;
  EXPECT_EQ(sample_alias(table.data(), n, last, last).index, n - 1);
  EXPECT_EQ(sample_alias(table.data(), n, 0.0f, 0.0f).index, 0u);
}

TEST(AliasTable, Errors) {
  const float infinity = std::numeric_limits<float>::infinity();
  const auto build = [](std::vector<float> weights) { return build_alias_table(weights); };
  expect_error([&] { build({}); }, "alias table of 0 weights");
  expect_error([&] { build({0, 0, 0}); }, "all 3 weights are zero");
  expect_error([&] { build({1, -2}); }, "weight 1 is -2");
  expect_error([&] { build({1, 2, infinity}); }, "weight 2 is inf");
  expect_error([&] { build({std::nanf("")}); }, "weight 0 is nan");
}

}  // namespace
}  // namespace pt
