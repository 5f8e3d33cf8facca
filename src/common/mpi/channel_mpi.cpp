#include "common/mpi/channel_mpi.h"

#include <fmt/format.h>
#include <sys/prctl.h>

#include <algorithm>
#include <csignal>
#include <utility>

#include "common/error/terminal.h"

namespace pt {
namespace {

/// mpirun and srun hand signals to all ranks: rank 0 decides what becomes of the others.
void ignore_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) std::signal(signal, SIG_IGN);
}

}  // namespace

MpiChannel::MpiChannel(ChannelSettings settings, int processes)
    : settings_(std::move(settings)), thread_([this, processes] { run(processes); }) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return is_open_ || problem_; });
  if (problem_) {
    lock.unlock();
    thread_.join();
    std::rethrow_exception(problem_);
  }
  if (rank_ != 0) ignore_signals();
}

MpiChannel::~MpiChannel() {
  if (thread_.joinable()) abort(2);  // nobody has said good-bye
}

void MpiChannel::send(int to, MessageKind kind, std::shared_ptr<const std::string> bytes) {
  const std::lock_guard lock(mutex_);
  unsent_bytes_ += bytes->size();
  outbox_.push_back({to, kind, std::move(bytes)});
  wake_.notify_one();
}

void MpiChannel::flush(std::uint64_t unsent_bytes) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return unsent_bytes_ <= unsent_bytes; });
}

std::optional<Message> MpiChannel::receive(std::chrono::microseconds wait) {
  std::unique_lock lock(mutex_);
  if (!changed_.wait_for(lock, wait, [&] { return !inbox_.empty(); })) return std::nullopt;
  Message message = std::move(inbox_.front());
  inbox_.pop_front();
  return message;
}

void MpiChannel::close(int code) {
  {
    const std::lock_guard lock(mutex_);
    is_closing_ = true, end_code_ = code;
    wake_.notify_one();
  }
  thread_.join();
}

void MpiChannel::abort(int code) {
  {
    const std::lock_guard lock(mutex_);
    abort_code_ = code != 0 ? code : 1;
    wake_.notify_one();
  }
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

std::string mpi_version() {
  char text[MPI_MAX_LIBRARY_VERSION_STRING];
  int length = 0;
  MPI_Get_library_version(text, &length);  // may be called before MPI_Init
  const std::string all(text, static_cast<std::size_t>(length));
  return all.substr(0, all.find_first_of(",\n"));
}

std::string mpi_built_with() {
#if defined(OMPI_MAJOR_VERSION)
  return fmt::format("Open MPI {}.{}.{}", OMPI_MAJOR_VERSION, OMPI_MINOR_VERSION,
                     OMPI_RELEASE_VERSION);
#elif defined(MPICH_VERSION)
  return "MPICH " MPICH_VERSION;
#else
  return fmt::format("an MPI of standard {}.{}", MPI_VERSION, MPI_SUBVERSION);
#endif
}

std::unique_ptr<Channel> open_mpi_channel(ChannelSettings settings, int processes) {
  return std::make_unique<MpiChannel>(std::move(settings), processes);
}

namespace {

using namespace std::chrono_literals;

double seconds(std::chrono::steady_clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

/// Whether its sender sends nothing after it, heartbeats included.
bool is_last_message(MessageKind kind) {
  return kind == MessageKind::goodbye || kind == MessageKind::closing;
}

}  // namespace

void MpiChannel::end_all(MpiTraffic& traffic, int code, const std::string& message) {
  if (!message.empty()) print_error(message);
  if (settings_.before_abort) settings_.before_abort();
  traffic.abort(code);
}

/// False at the end.
bool MpiChannel::take_orders(MpiTraffic& traffic, Heartbeats& heartbeats) {
  std::unique_lock lock(mutex_);
  const std::vector<Outgoing> orders = std::exchange(outbox_, {});
  const bool is_closing = is_closing_;
  const int abort_code = abort_code_;
  lock.unlock();
  for (const Outgoing& order : orders) {
    traffic.send(order.to, order.kind, order.bytes);
    if (is_last_message(order.kind)) heartbeats.stop_sending(order.to);
  }
  if (abort_code != 0) end_all(traffic, abort_code, "");
  return !is_closing || !traffic.has_sent_all();
}

/// Does not burn a core: sleeps for a hundredth of the time that nothing came, which is what a
/// message that comes then may wait. While a message is on its way MPI wants to be called, though.
void MpiChannel::rest(const MpiTraffic& traffic, Clock::duration idle) {
  const bool is_moving = !traffic.has_sent_all() || traffic.is_receiving();
  if (idle < (is_moving ? 100ms : 50us)) return std::this_thread::yield();
  const auto pause = is_moving ? 20us : std::clamp<Clock::duration>(idle / 100, 20us, 1ms);
  std::unique_lock lock(mutex_);
  wake_.wait_for(lock, pause, [&] { return !outbox_.empty() || is_closing_ || abort_code_ != 0; });
}

void MpiChannel::talk(MpiTraffic& traffic, Heartbeats& heartbeats) {
  const auto empty = std::make_shared<const std::string>();
  for (Clock::time_point active = Clock::now(); take_orders(traffic, heartbeats);) {
    const Clock::time_point now = Clock::now();
    const bool moved = traffic.turn([&](int from) { heartbeats.heard(from, seconds(now)); },
                                    [&](Message&& message) {
                                      if (is_last_message(message.kind))
                                        heartbeats.stop_watching(message.from);
                                      const std::lock_guard lock(mutex_);
                                      inbox_.push_back(std::move(message));
                                      changed_.notify_all();
                                    });
    for (const int to : heartbeats.due(seconds(now))) {
      traffic.send(to, MessageKind::heartbeat, empty);
    }
    if (const auto lost = heartbeats.lost(seconds(now))) {
      end_all(traffic, 2,
              fmt::format("{} has been silent for {} s (PTEXP_MPI_TIMEOUT): all ranks end",
                          ranks_[*lost].name(), settings_.timeout_s));
    }
    if (moved) {
      active = now;
      const std::lock_guard lock(mutex_);
      unsent_bytes_ = traffic.unsent_bytes();
      for (const Outgoing& order : outbox_) unsent_bytes_ += order.bytes->size();
      changed_.notify_all();
    } else {
      rest(traffic, now - active);
    }
  }
}

void MpiChannel::run(int processes) {
  ::prctl(PR_SET_TIMERSLACK, 1000UL);  // nanoseconds: for short sleeps
  std::optional<MpiTraffic> traffic;
  try {
    traffic.emplace(settings_.chunk_bytes, processes);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    problem_ = std::current_exception();
    changed_.notify_all();
    return;
  }
  rank_ = traffic->rank(), ranks_ = traffic->ranks();
  {
    const std::lock_guard lock(mutex_);
    is_open_ = true;
    changed_.notify_all();
  }
  Heartbeats heartbeats(rank_, static_cast<int>(ranks_.size()), settings_.timeout_s,
                        seconds(Clock::now()));
  try {
    talk(*traffic, heartbeats);
  } catch (const std::exception& error) {  // no memory for a message
    end_all(*traffic, 2, fmt::format("{}: {}", ranks_[rank_].name(), error.what()));
  }
  int code = 0;
  {
    const std::lock_guard lock(mutex_);
    code = end_code_;
  }
  traffic->finalize(code);
}

}  // namespace pt
