// The processes of one render, by their ranks. One thread of each process calls Ranks, in the same
// order on all ranks for what is marked as collective. Rank 0 leads: it reports errors, and its
// exit code is that of all.
#pragma once

#include <deque>
#include <utility>

#include "common/distribute/worker.h"
#include "common/mpi/channel.h"

namespace pt {

/// What rank 0 has said is the end, thrown from any call of Ranks on the others. No std::exception,
/// so that nobody takes it for an error that could be mended: main() returns Ranks::finish().
struct RanksEnd {
  int code;
};

/// Something that must be equal on all ranks, and how it is called: {"commit", "8f3a2b"}.
using RankFact = std::pair<std::string, std::string>;

class Ranks {
 public:
  explicit Ranks(std::unique_ptr<Channel> channel = open_channel());
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const { return channel_->rank(); }
  int count() const { return static_cast<int>(infos_.size()); }
  bool is_first() const { return rank() == 0; }
  const RankInfo& own() const { return infos_[rank()]; }
  const RankInfo& info(int rank) const { return infos_[rank]; }

  /// Collective: tells all ranks of this rank's devices (RankInfo::devices).
  void announce(const std::vector<std::string>& devices);
  /// Collective: throws Error on rank 0, by the names of the first rank and fact that differ from
  /// rank 0's, and RanksEnd on the others; so nothing is begun that does not fit.
  void agree(const std::vector<RankFact>& facts);
  /// Collective: rank 0's bytes, of any number, replace those of the others.
  void broadcast(std::string& bytes);
  /// Collective: [rank] what each has given, on rank 0; empty on the others.
  std::vector<std::string> gather(std::string bytes);

  void send(int to, MessageKind kind, std::string bytes = {});
  /// The next message from that rank; does not wait longer than that for it. Throws Error on rank 0
  /// when a rank has failed: "rank 2 (host5): " and why.
  std::optional<Message> receive(int from, std::chrono::microseconds wait = {});

  /// The last call but for another finish(), of all ranks; returns the exit code of the process:
  /// rank 0's `code`. Throws as receive() does.
  int finish(int code);
  /// After an exception: rank 0 reports it with `report` and ends all ranks with `code`; another
  /// rank tells rank 0. Returns the exit code.
  int fail(const std::string& message, int code,
           const std::function<void(const std::string&)>& report);

 private:
  void take(Message&& message);
  Message expect(int from, MessageKind kind);
  void say_goodbye();
  void dismiss();

  std::unique_ptr<Channel> channel_;
  std::vector<RankInfo> infos_;
  std::vector<std::deque<Message>> inbox_;  ///< [from]
  std::optional<int> end_code_;             ///< what rank 0 has said, or said to the others
  std::vector<bool> gone_;                  ///< [rank] has said good-bye
  std::optional<std::string> failure_;      ///< of the first rank that could not go on
  bool is_reported_ = false, is_closed_ = false;
};

// Devices of other ranks as workers of rank 0.

/// On rank 0, after announce(): a worker for each device of each other rank, of
/// Worker::least_paths() as said. `ranks` must outlive them; when they are destroyed the other
/// ranks' serve_units() return.
std::vector<std::unique_ptr<Worker>> remote_workers(Ranks& ranks, std::uint64_t least_paths = 1);

/// On the other ranks: hands rank 0's units to `workers`, as many as devices were announced, and
/// their results back, until rank 0 has no more.
void serve_units(Ranks& ranks, const std::vector<std::unique_ptr<Worker>>& workers);

}  // namespace pt
