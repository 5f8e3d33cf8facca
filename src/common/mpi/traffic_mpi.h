// The calls of MPI, all from one thread (MPI_THREAD_FUNNELED), none of which waits: point-to-point
// messages alone, so that a rank that has failed leaves nobody inside a collective call.
#pragma once

// Without the classes for C++ that MPI 3 has removed.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <deque>
#include <list>
#include <map>

#include "common/mpi/channel.h"

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
