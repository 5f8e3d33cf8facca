// Messages by MPI, from one thread that makes all calls of MPI (MPI_THREAD_FUNNELED): a rank is
// heard whatever else it does, such as loading a scene for minutes. No call waits, and all are
// point-to-point, so that a rank that has failed leaves nobody inside a collective call.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "common/mpi/channel.h"

// Without the classes for C++ that MPI 3 has removed.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <deque>
#include <list>
#include <map>

namespace pt {

class MpiTraffic {
 public:
  /// Starts MPI. Throws Error where it does not connect as many processes as the launcher started.
  MpiTraffic(std::uint64_t chunk_bytes, int processes);

  int rank() const { return rank_; }
  const std::vector<RankInfo>& ranks() const { return ranks_; }

  void send(int to, MessageKind kind, std::shared_ptr<const std::string> bytes);
  /// Sends and receives what can be without waiting. `heard` is called with each sender, `received`
  /// with each message that is complete. False where nothing has moved.
  bool turn(const std::function<void(int from)>& heard,
            const std::function<void(Message&& message)>& received);
  std::uint64_t unsent_bytes() const { return unsent_bytes_; }
  bool has_sent_all() const { return sending_.empty(); }
  bool is_receiving() const { return !receiving_.empty(); }

  /// Once no rank sends any more. Where MPI hangs then, the process ends with `code`.
  void finalize(int code);
  [[noreturn]] void abort(int code);

 private:
  struct Sending {
    std::shared_ptr<const std::string> bytes;  ///< kept until MPI needs it no more
    std::uint64_t size = 0;                    ///< of this part
    MPI_Request request = MPI_REQUEST_NULL;
  };
  struct Receiving {
    std::string bytes;
    int tag = 0;
    MPI_Request request = MPI_REQUEST_NULL;
  };

  void find_ranks();
  bool test_sends();
  bool match_messages(const std::function<void(int)>& heard);

  MPI_Comm comm_ = MPI_COMM_NULL;
  std::uint64_t chunk_bytes_;
  int rank_ = 0;
  std::vector<RankInfo> ranks_;
  std::list<Sending> sending_;
  std::uint64_t unsent_bytes_ = 0;
  std::map<int, std::deque<Receiving>> receiving_;  ///< by sender, in the order of its sends
  std::map<int, std::string> begun_;                ///< by sender: parts of a message
};

}  // namespace pt
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
