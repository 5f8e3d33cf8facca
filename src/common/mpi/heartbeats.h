// Which ranks have fallen silent. Times are seconds of a steady clock, so that tests can choose
// them.
#pragma once

#include <optional>
#include <vector>

namespace pt {

class Heartbeats {
 public:
  /// Rank 0 watches all others, which watch rank 0.
  Heartbeats(int rank, int count, double timeout_s, double now);

  void heard(int from, double now) { peers_[from].heard = now; }
  /// After its last message.
  void stop_watching(int peer) { peers_[peer].sends = false; }
  /// After our last one.
  void stop_sending(int peer) { peers_[peer].listens = false; }

  /// To be called at each turn of the loop: the ranks to which a heartbeat is due now.
  std::vector<int> due(double now);
  /// A rank that has been silent for too long.
  std::optional<int> lost(double now) const;

 private:
  struct Peer {
    double heard = 0;
    bool sends = false, listens = false;
  };
  std::vector<Peer> peers_;
  double timeout_, interval_, last_turn_, last_sent_;
};

}  // namespace pt
