// The primitives below a node, as long as they are few enough for a leaf.
#pragma once

#include <algorithm>
#include <array>

#include "common/accel/nodes.h"

namespace pt {

/// A set of at most leaf_size_max primitives, each once however often spatial splits repeat it.
class LeafMembers {
 public:
  void add(std::uint32_t primitive) {
    if (size_ > leaf_size_max || std::find(begin(), end(), primitive) != end()) return;
    if (size_ < leaf_size_max) ids_[size_] = primitive;
    ++size_;  // beyond leaf_size_max: too many
  }
  void add(const LeafMembers& others) {
    if (others.size_ > leaf_size_max) size_ = leaf_size_max + 1;
    for (const std::uint32_t primitive : others) add(primitive);
  }
  /// More than leaf_size_max: the members are not known.
  std::uint32_t size() const { return size_; }
  const std::uint32_t* begin() const { return ids_.data(); }
  const std::uint32_t* end() const { return ids_.data() + std::min(size_, leaf_size_max); }

 private:
  std::uint32_t size_ = 0;
  std::array<std::uint32_t, leaf_size_max> ids_;
};

}  // namespace pt
