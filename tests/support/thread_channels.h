// Ranks of one process, each a thread: what a channel by MPI does, without MPI.
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "common/mpi/ranks.h"

namespace pt {

struct ThreadHub {
  struct Aborted {};

  explicit ThreadHub(int count) : inboxes(count) {
    for (int rank = 0; rank < count; ++rank) {
      infos.push_back({rank, "host" + std::to_string(rank / 2), rank % 2, 2, 1, 0, {}});
    }
  }
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::deque<Message>> inboxes;
  std::vector<RankInfo> infos;
  int abort_code = 0;
};

class ThreadChannel : public Channel {
 public:
  ThreadChannel(ThreadHub& hub, int rank) : hub_(hub), rank_(rank) {}

  int rank() const override { return rank_; }
  const std::vector<RankInfo>& ranks() const override { return hub_.infos; }
  void send(int to, MessageKind kind, std::shared_ptr<const std::string> bytes) override {
    const std::lock_guard lock(hub_.mutex);
    hub_.inboxes[to].push_back({rank_, kind, *bytes});
    hub_.changed.notify_all();
  }
  void flush(std::uint64_t) override {}
  std::optional<Message> receive(std::chrono::microseconds wait) override {
    std::unique_lock lock(hub_.mutex);
    auto& inbox = hub_.inboxes[rank_];
    hub_.changed.wait_for(lock, wait, [&] { return !inbox.empty() || hub_.abort_code != 0; });
    if (hub_.abort_code != 0) throw ThreadHub::Aborted{};
    if (inbox.empty()) return std::nullopt;
    Message message = std::move(inbox.front());
    inbox.pop_front();
    return message;
  }
  void close(int) override {}
  void abort(int code) override {
    const std::lock_guard lock(hub_.mutex);
    hub_.abort_code = code;
    hub_.changed.notify_all();
    throw ThreadHub::Aborted{};
  }

 private:
  ThreadHub& hub_;
  int rank_;
};

/// What main() does of a rank; returns its exit code.
inline int run_rank(std::unique_ptr<Channel> channel, const std::function<int(Ranks&)>& body,
                    const std::function<void(const std::string& message)>& report) {
  Ranks ranks(std::move(channel));
  try {
    return ranks.finish(body(ranks));
  } catch (const RanksEnd& end) {
    return ranks.finish(end.code);
  } catch (const std::exception& error) {
    return ranks.fail(error.what(), 2, report);
  }
}

struct RankOutcome {
  int code = -1;
  std::string reported;
};

/// Runs `body` on each of `count` ranks.
inline std::vector<RankOutcome> run_ranks(int count, const std::function<int(Ranks&)>& body) {
  ThreadHub hub(count);
  std::vector<RankOutcome> outcomes(count);
  std::vector<std::thread> threads;
  for (int rank = 0; rank < count; ++rank) {
    threads.emplace_back([&, rank] {
      try {
        outcomes[rank].code = run_rank(
            std::make_unique<ThreadChannel>(hub, rank), body,
            [&, rank](const std::string& text) { outcomes[rank].reported += text + "\n"; });
      } catch (const ThreadHub::Aborted&) {
        outcomes[rank].code = hub.abort_code;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  return outcomes;
}

}  // namespace pt
