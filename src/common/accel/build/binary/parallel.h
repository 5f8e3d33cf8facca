// Work shared by threads, with results that do not depend on them.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace pt {

/// Calls both functions, for the two halves of a subtree: at the same time where these are large
/// enough to pay for tasks.
template <class First, class Second>
void invoke_both(bool in_parallel, const First& first, const Second& second) {
  if (in_parallel) {
    tbb::parallel_invoke(first, second);
  } else {
    first(), second();
  }
}

namespace partition_detail {

/// Runs of elements that lie on the wrong side.
struct Runs {
  std::vector<std::size_t> begin, before;  // by run: the first one's index, how many come earlier
  std::size_t total = 0;

  void add(std::size_t first, std::size_t last) {
    if (first >= last) return;
    begin.push_back(first), before.push_back(total);
    total += last - first;
  }
};

/// Steps through the elements of runs.
class Cursor {
 public:
  Cursor(const Runs& runs, std::size_t i) : runs_(runs), i_(i) {
    run_ = static_cast<std::size_t>(std::upper_bound(runs.before.begin(), runs.before.end(), i) -
                                    runs.before.begin() - 1);
  }
  std::size_t next() {
    if (run_ + 1 < runs_.before.size() && i_ == runs_.before[run_ + 1]) ++run_;
    return runs_.begin[run_] + (i_++ - runs_.before[run_]);
  }

 private:
  const Runs& runs_;
  std::size_t i_, run_;
};

}  // namespace partition_detail

/// Reorders `values` so that those that `goes_left` says of come first, and returns their number.
/// Fixed blocks are partitioned on their own; then the elements on the wrong side of the
/// result's border are exchanged.
template <class T, class GoesLeft>
std::size_t parallel_partition(std::span<T> values, GoesLeft goes_left) {
  constexpr std::size_t block = 1 << 14;
  const std::size_t blocks = (values.size() + block - 1) / block;
  const auto end_of = [&](std::size_t b) { return std::min((b + 1) * block, values.size()); };
  std::vector<std::size_t> middle(blocks);
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    T* const data = values.data();
    middle[b] = static_cast<std::size_t>(
        std::partition(data + b * block, data + end_of(b), goes_left) - data);
  });
  std::size_t left = 0;
  for (std::size_t b = 0; b < blocks; ++b) left += middle[b] - b * block;
  partition_detail::Runs right_ones, left_ones;  // in the left part, in the right part
  for (std::size_t b = 0; b < blocks; ++b) {
    right_ones.add(middle[b], std::min(end_of(b), left));
    left_ones.add(std::max(b * block, left), middle[b]);
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, right_ones.total, block), [&](auto part) {
    partition_detail::Cursor right_one(right_ones, part.begin()), left_one(left_ones, part.begin());
    for (std::size_t i = part.begin(); i < part.end(); ++i) {
      std::swap(values[right_one.next()], values[left_one.next()]);
    }
  });
  return left;
}

}  // namespace pt
