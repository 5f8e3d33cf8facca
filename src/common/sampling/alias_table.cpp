#include "common/sampling/alias_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "common/error/error.h"

namespace pt {
namespace {

/// The mean weight, but never above the largest by rounding: so one entry at least is heavy.
double checked_mean(std::span<const float> weights) {
  if (weights.empty() || weights.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(fmt::format("alias table of {} weights: expected 1 to 2^32 - 1", weights.size()));
  }
  double sum = 0, largest = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double weight = weights[i];
    if (!(weight >= 0.0 && weight <= double{std::numeric_limits<float>::max()})) {
      throw Error(fmt::format("alias table: weight {} is {}, expected a finite number >= 0", i,
                              weights[i]));
    }
    sum += weight;
    largest = std::max(largest, weight);
  }
  if (sum == 0) {
    throw Error(fmt::format("alias table: all {} weights are zero, expected a positive one",
                            weights.size()));
  }
  return std::min(sum / static_cast<double>(weights.size()), largest);
}

/// Finds the entries lighter than the mean, or the others, in order.
class Sweep {
 public:
  Sweep(std::span<const float> weights, double mean, bool light)
      : weights_(weights), mean_(mean), light_(light) {
    find();
  }
  bool is_done() const { return at_ == weights_.size(); }
  std::uint32_t index() const { return static_cast<std::uint32_t>(at_); }
  double weight() const { return weights_[at_]; }
  void next() {
    ++at_;
    find();
  }

 private:
  void find() {
    while (at_ < weights_.size() && (weights_[at_] < mean_) != light_) ++at_;
  }

  std::span<const float> weights_;
  double mean_;
  bool light_;
  std::size_t at_ = 0;
};

}  // namespace

// Two sweeps, over light and heavy entries, in place of Vose's work lists (Huebschle-Schneider and
// Sanders 2022, 'Parallel Weighted Random Sampling'): the memory is read in order.
std::vector<AliasEntry> build_alias_table(std::span<const float> weights) {
  const double mean = checked_mean(weights);
  std::vector<AliasEntry> table(weights.size());
  Sweep light(weights, mean, true), heavy(weights, mean, false);
  std::uint32_t giver = heavy.index();
  double left = heavy.weight();  // what the giver has not given away
  heavy.next();
  const auto fill = [&](std::uint32_t index, double own) {
    table[index] = {static_cast<float>(own / mean), giver};
  };
  while (!light.is_done() || !heavy.is_done()) {
    // The last heavy entry gives to all that are left: rounding must not make it stop too early,
    // nor a weight of zero be chosen.
    if (!light.is_done() && (left > mean || heavy.is_done())) {
      fill(light.index(), light.weight());
      left -= mean - light.weight();
      light.next();
    } else {
      const std::uint32_t emptied = giver;
      giver = heavy.index();
      fill(emptied, std::clamp(left, 0.0, mean));
      left += heavy.weight() - mean;
      heavy.next();
    }
  }
  table[giver] = {1.0f, giver};
  return table;
}

}  // namespace pt
