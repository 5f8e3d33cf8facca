#include "common/render/stop_clock.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/platform/steady_seconds.h"

namespace pt {
namespace {

constexpr int first_check = 16;  // fewer samples say little of their variance
constexpr int no_limit = std::numeric_limits<int>::max();

/// The first number above `done` at which the error is estimated.
int next_check(int done) {
  std::int64_t check = first_check;
  while (check <= done) check += std::max<std::int64_t>(check / 4, 1);
  return static_cast<int>(std::min<std::int64_t>(check, no_limit));
}

}  // namespace

StopClock::StopClock(const StopRule& rule) : rule_(rule), begin_s_(now_s()) {}

double StopClock::now_s() const {
  if (rule_.clock) return rule_.clock();
  return steady_seconds();
}

double StopClock::elapsed_s() const { return now_s() - begin_s_; }

int StopClock::next(int done) const {
  int samples = no_limit;
  if (rule_.relative_error > 0) samples = next_check(done) - done;
  if (rule_.seconds > 0) {
    const double elapsed = elapsed_s();
    const double fitting = elapsed > 0 ? done * (rule_.seconds - elapsed) / elapsed : 1.0;
    const double most = std::min(fitting, static_cast<double>(std::max(done, 1)));
    samples = std::min(samples, std::max(1, static_cast<int>(std::min(most, 1e9))));
  }
  return samples;
}

bool StopClock::wants_error(int done) const {
  return rule_.relative_error > 0 && done >= first_check && next_check(done - 1) == done;
}

RunEnd StopClock::ends(int done, std::optional<double> error) const {
  if (rule_.relative_error > 0 && wants_error(done) && error <= rule_.relative_error) {
    return RunEnd::target_error;
  }
  if (rule_.seconds <= 0) return RunEnd::samples;
  // A sample more would end later than the limit by more than this one would be early.
  const double elapsed = elapsed_s();
  const double sample_s = elapsed / std::max(done, 1);
  return elapsed + 0.5 * sample_s >= rule_.seconds ? RunEnd::time_limit : RunEnd::samples;
}

std::uint64_t StopClock::expected(std::uint64_t done, std::uint64_t total,
                                  std::optional<double> error) const {
  double all = static_cast<double>(total);
  const double now = static_cast<double>(done);
  if (rule_.seconds > 0) {
    const double elapsed = elapsed_s();
    if (elapsed > 0) all = std::min(all, now * std::max(1.0, rule_.seconds / elapsed));
  }
  if (rule_.relative_error > 0 && error) {
    const double ratio = *error / rule_.relative_error;
    all = std::min(all, now * std::max(1.0, ratio * ratio));
  }
  return static_cast<std::uint64_t>(all);
}

}  // namespace pt
