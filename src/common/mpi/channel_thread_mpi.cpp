#include <fmt/format.h>
#include <sys/prctl.h>

#include <algorithm>
#include <utility>

#include "common/error/terminal.h"
#include "common/mpi/channel_mpi.h"

namespace pt {
namespace {

using namespace std::chrono_literals;

double seconds(std::chrono::steady_clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

/// Of its sender: no heartbeat follows.
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
