// Random numbers whose source is chosen when the kernel runs.
#pragma once

#include "common/sampling/random.h"

namespace pt {

/// Philox or a stored state, by a branch that all threads take alike: for a kernel whose time
/// matters less than a second copy of its code.
template <class State>
struct AnySource {
  PhiloxSource philox;
  XorwowSource<State> xorwow;  ///< its `states` are null where Philox draws

  explicit AnySource(const PhiloxSource& source) : philox(source), xorwow{nullptr} {}
  explicit AnySource(const XorwowSource<State>& source) : philox{0}, xorwow(source) {}

  PT_HD bool is_stored() const { return xorwow.states != nullptr; }

  struct Stream {
    bool is_stored;
    typename PhiloxSource::Stream philox;
    typename XorwowSource<State>::Stream xorwow;

    PT_HD Vec4 draw(std::uint32_t block) {
      return is_stored ? xorwow.draw(block) : philox.draw(block);
    }
  };

  PT_HD Stream open(const PathId& id) const {
    Stream stream;
    stream.is_stored = is_stored();
    if (stream.is_stored) {
      stream.xorwow = xorwow.open(id);
    } else {
      stream.philox = philox.open(id);
    }
    return stream;
  }
  PT_HD void close(const PathId& id, const Stream& stream) const {
    if (stream.is_stored) xorwow.close(id, stream.xorwow);
  }
};

}  // namespace pt
