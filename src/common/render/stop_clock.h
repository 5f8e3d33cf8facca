// When a render ends that has a limit of time or of error, and how large its batches are until
// then. It always ends between two batches: what it has is the image of so many samples.
#pragma once

#include <cstdint>
#include <optional>

#include "common/render/renderer.h"

namespace pt {

class StopClock {
 public:
  /// Starts to measure. `rule` must live as long.
  explicit StopClock(const StopRule& rule);

  /// The most samples that the next batch may have. For the time: at first as many as there are,
  /// then as many as fit into what is left at the rate so far. For the error: up to the next of
  /// the numbers at which it is estimated, which do not depend on time or device.
  int next(int done) const;
  /// `done` is one of these numbers: 16, and then a quarter more each time.
  bool wants_error(int done) const;
  /// To be called after a batch. RunEnd::samples: continue.
  RunEnd ends(int done, std::optional<double> error) const;
  /// The samples that there will be in all, for a progress bar.
  std::uint64_t expected(std::uint64_t done, std::uint64_t total,
                         std::optional<double> error) const;
  double elapsed_s() const;

 private:
  double now_s() const;

  const StopRule& rule_;
  double begin_s_;
};

}  // namespace pt
