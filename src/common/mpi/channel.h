// Messages between the processes ("ranks") of one render. What is sent arrives once and, from one
// rank to another, in order. By MPI (channel_mpi.cpp), within a process for tests, or none at all.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pt {

enum class MessageKind {
  heartbeat,   ///< of the channel itself: its sender lives
  collective,  ///< of gather() and broadcast()
  unit,        ///< rank 0 to a worker: take these samples
  cancel,      ///< rank 0 to a worker
  no_units,    ///< rank 0: serve_units() returns
  device,      ///< from a worker: what it is (device_message.cpp)
  result,      ///< from a worker: what became of a unit
  failure,     ///< to rank 0: this rank cannot go on
  end,         ///< rank 0: the exit code of all
  goodbye,     ///< the last message to rank 0
  closing,     ///< the last message from rank 0: all have said good-bye
};

struct Message {
  int from = 0;
  MessageKind kind{};
  std::string bytes;
};

struct RankInfo {
  int rank = 0;
  std::string host;
  int local_rank = 0, local_ranks = 1;  ///< among those of the same machine
  int threads = 1;                      ///< its share of that machine's processors
  int idle_processors = 0;              ///< of the machine: where its launcher has bound no rank
  std::vector<std::string> devices;     ///< once all have announced them

  /// "rank 3 (host7)"
  std::string name() const;
};

class Channel {
 public:
  virtual ~Channel() = default;

  /// The rank of this process.
  virtual int rank() const = 0;
  virtual const std::vector<RankInfo>& ranks() const = 0;
  /// Does not wait.
  virtual void send(int to, MessageKind kind, std::shared_ptr<const std::string> bytes) = 0;
  /// Waits until no more than so many bytes are still to be sent.
  virtual void flush(std::uint64_t unsent_bytes) = 0;
  /// The next message, if one comes within that time.
  virtual std::optional<Message> receive(std::chrono::microseconds wait) = 0;
  /// After the last message: all ranks do this together. Where MPI does not come to an end, the
  /// process ends with `code`.
  virtual void close(int code) = 0;
  /// Ends all ranks at once.
  [[noreturn]] virtual void abort(int code) = 0;
};

struct ChannelSettings {
  double timeout_s = 60;                  ///< a rank that is silent for so long is lost
  std::uint64_t chunk_bytes = 64u << 20;  ///< of messages that go in several: MPI counts by int
  std::function<void()> before_abort;     ///< removes unfinished files; may be empty
};

/// As the environment says: PTEXP_MPI_TIMEOUT (seconds), PTEXP_MPI_CHUNK (bytes). Throws Error.
ChannelSettings channel_settings();

/// Connects the processes that a launcher (mpirun, srun) has started together; without one, the
/// channel of this process alone, which costs nothing and cannot fail.
std::unique_ptr<Channel> open_channel(ChannelSettings settings = channel_settings());

/// The processes that a launcher has started; 0: there is no launcher. `variable` is getenv.
int launched_processes(const std::function<const char*(const char*)>& variable);

/// Which MPI is loaded, a line; "off": the program was built without.
std::string mpi_version();

/// Which MPI's headers the program was built with, e.g. "Open MPI 4.1.4"; "off": none.
std::string mpi_built_with();

/// By MPI, or an Error in a build without it.
std::unique_ptr<Channel> open_mpi_channel(ChannelSettings settings, int processes);

/// Which ranks have fallen silent. Times are seconds of a steady clock, so that tests can choose
/// them.
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
