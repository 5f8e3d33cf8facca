#include "common/mpi/heartbeats.h"

#include <algorithm>

namespace pt {

Heartbeats::Heartbeats(int rank, int count, double timeout_s, double now)
    : peers_(count),
      timeout_(timeout_s),
      interval_(std::min(1.0, timeout_s / 4)),
      last_turn_(now),
      last_sent_(now) {
  for (int peer = 0; peer < count; ++peer) {
    const bool has_contact = peer != rank && (rank == 0 || peer == 0);
    peers_[peer] = {now, has_contact, has_contact};
  }
  // If rank 0 falls silent, one rank tells it before the others would.
  if (rank > 1) timeout_ += interval_ * std::min(rank - 1, 8) / 4;
}

std::vector<int> Heartbeats::due(double now) {
  // Whoever has slept himself, because all were suspended, has heard nobody meanwhile.
  if (now - last_turn_ > timeout_ / 2) {
    for (Peer& peer : peers_) peer.heard = now;
  }
  last_turn_ = now;
  std::vector<int> ranks;
  if (now - last_sent_ < interval_) return ranks;
  last_sent_ = now;
  for (std::size_t peer = 0; peer < peers_.size(); ++peer) {
    if (peers_[peer].listens) ranks.push_back(static_cast<int>(peer));
  }
  return ranks;
}

std::optional<int> Heartbeats::lost(double now) const {
  for (std::size_t peer = 0; peer < peers_.size(); ++peer) {
    if (peers_[peer].sends && now - peers_[peer].heard > timeout_) return static_cast<int>(peer);
  }
  return std::nullopt;
}

}  // namespace pt
