// Parallel reinsertion with the kernels' threads one after the other, in any order.
#pragma once

#include <functional>

#include "accel/serial_hploc.h"
#include "common/accel/build_cuda/reinsertion.h"

namespace pt {

/// Calls run(thread) for all threads 0..count of a kernel.
using ThreadOrder =
    std::function<void(std::uint32_t count, const std::function<void(std::uint32_t)>& run)>;

inline void run_forward(std::uint32_t count, const std::function<void(std::uint32_t)>& run) {
  for (std::uint32_t i = 0; i < count; ++i) run(i);
}

class SerialReinsertion {
 public:
  /// Changes `tree`, of at least two primitives.
  SerialReinsertion(HostBuildTree& tree, ThreadOrder order)
      : tree_(tree),
        order_(std::move(order)),
        parents_(2 * tree.primitives.size(), device_build::no_node),
        locks_(2 * tree.primitives.size()),
        arrivals_(tree.primitives.size()) {
    job_.count = tree.count();
    job_.primitives = tree.primitives.data(), job_.nodes = tree.nodes.data();
    job_.root = &tree.root;
    job_.parents = parents_.data(), job_.locks = locks_.data(), job_.arrivals = arrivals_.data();
    moves_.resize(job_.candidates());
    job_.moves = moves_.data();
    order_(job_.count, [&](std::uint32_t node) { device_build::link_children(job_, node); });
  }

  void run() {
    for (int i = 0; i < device_build::reinsertion_passes; ++i) pass(i);
  }

  /// Returns the number of moves made.
  std::size_t pass(int number) {
    return pass(number, [&](std::uint32_t i) { device_build::find_move(job_, i); });
  }

  /// The same, but `find(i)` chooses the moves.
  std::size_t pass(int number, const std::function<void(std::uint32_t)>& find) {
    using namespace device_build;
    job_.first = static_cast<std::uint32_t>(number) % reinsertion_stride;
    std::fill(locks_.begin(), locks_.end(), 0);
    const std::uint32_t threads = job_.candidates();
    order_(threads, find);
    order_(threads, [&](std::uint32_t i) {
      lock_links(job_, i,
                 [](std::uint64_t* lock, std::uint64_t key) { *lock = std::max(*lock, key); });
    });
    order_(threads, [&](std::uint32_t i) { claim_links(job_, i); });
    order_(threads, [&](std::uint32_t i) { break_cycles(job_, i); });
    order_(threads, [&](std::uint32_t i) { apply_move(job_, i); });
    refit();
    return static_cast<std::size_t>(
        std::count_if(moves_.begin(), moves_.begin() + threads,
                      [](const Move& move) { return move.to != no_node; }));
  }

  void refit() {
    order_(job_.count, [&](std::uint32_t i) { device_build::refit_upwards(job_, i, Host{tree_}); });
  }

  const device_build::ReinsertionJob& job() const { return job_; }

 private:
  struct Host {
    HostBuildTree& tree;
    bool arrives_second(std::uint32_t* arrivals) const { return ((*arrivals ^= 1u) & 1u) == 0; }
    BuildNode load(TreeRef ref) const { return tree[ref]; }
    void finish(std::uint32_t index, const BuildNode& node, const Bounds&, const Bounds&) const {
      tree.nodes[index] = node;
    }
  };

  HostBuildTree& tree_;
  ThreadOrder order_;
  std::vector<std::uint32_t> parents_;
  std::vector<std::uint64_t> locks_;
  std::vector<std::uint32_t> arrivals_;
  std::vector<device_build::Move> moves_;
  device_build::ReinsertionJob job_;
};

}  // namespace pt
