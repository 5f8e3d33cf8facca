// A channel by MPI. A thread of its own makes all calls of MPI, so that a rank is heard whatever
// else it does: loading a scene for minutes is not silence.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "common/mpi/heartbeats.h"
#include "common/mpi/traffic_mpi.h"

namespace pt {

class MpiChannel : public Channel {
 public:
  MpiChannel(ChannelSettings settings, int processes);
  ~MpiChannel() override;

  int rank() const override { return rank_; }
  const std::vector<RankInfo>& ranks() const override { return ranks_; }
  void send(int to, MessageKind kind, std::shared_ptr<const std::string> bytes) override;
  void flush(std::uint64_t unsent_bytes) override;
  std::optional<Message> receive(std::chrono::microseconds wait) override;
  void close(int code) override;
  [[noreturn]] void abort(int code) override;

 private:
  using Clock = std::chrono::steady_clock;
  struct Outgoing {
    int to;
    MessageKind kind;
    std::shared_ptr<const std::string> bytes;
  };

  // The thread's:
  void run(int processes);
  bool take_orders(MpiTraffic& traffic, Heartbeats& heartbeats);
  void talk(MpiTraffic& traffic, Heartbeats& heartbeats);
  void rest(const MpiTraffic& traffic, Clock::duration idle);
  [[noreturn]] void end_all(MpiTraffic& traffic, int code, const std::string& message);

  ChannelSettings settings_;
  int rank_ = 0;
  std::vector<RankInfo> ranks_;
  std::mutex mutex_;  ///< for all below
  std::condition_variable changed_, wake_;
  std::exception_ptr problem_;
  bool is_open_ = false, is_closing_ = false;
  int abort_code_ = 0, end_code_ = 2;
  std::uint64_t unsent_bytes_ = 0;
  std::vector<Outgoing> outbox_;
  std::deque<Message> inbox_;
  std::thread thread_;
};

}  // namespace pt
