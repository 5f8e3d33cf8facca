// The two halves of a subtree, side by side where they are large enough to pay for tasks.
#pragma once

#include <tbb/parallel_invoke.h>

namespace pt {

/// Calls both functions, at the same time or one after the other.
template <class First, class Second>
void invoke_both(bool in_parallel, const First& first, const Second& second) {
  if (in_parallel) {
    tbb::parallel_invoke(first, second);
  } else {
    first(), second();
  }
}

}  // namespace pt
