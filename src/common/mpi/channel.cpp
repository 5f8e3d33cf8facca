#include "common/mpi/channel.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "common/error/error.h"

namespace pt {
namespace {

/// The channel of a process that is alone.
class LoneChannel : public Channel {
 public:
  LoneChannel() {
    char host[256] = "localhost";
    ::gethostname(host, sizeof host - 1);
    ranks_[0].host = host;
  }
  int rank() const override { return 0; }
  const std::vector<RankInfo>& ranks() const override { return ranks_; }
  void send(int, MessageKind, std::shared_ptr<const std::string>) override {}
  void flush(std::uint64_t) override {}
  std::optional<Message> receive(std::chrono::microseconds) override { return std::nullopt; }
  void close(int) override {}
  void abort(int code) override { std::_Exit(code); }

 private:
  std::vector<RankInfo> ranks_{1};
};

int number_in(const char* text, int otherwise) {
  return text == nullptr ? otherwise : std::max(std::atoi(text), 1);
}

}  // namespace

std::string RankInfo::name() const { return fmt::format("rank {} ({})", rank, host); }

int launched_processes(const std::function<const char*(const char*)>& variable) {
  const char* off = variable("PTEXP_LAUNCHER");
  if (off != nullptr && std::string_view(off) == "off") return 0;
  // Open MPI's mpirun; that of MPICH, Intel and Cray.
  for (const char* size : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    if (const char* text = variable(size)) return number_in(text, 1);
  }
  // Slurm's batch scripts are steps of one task, and no PMI serves them.
  const bool has_pmi = variable("PMI_RANK") || variable("PMIX_RANK");
  const char* tasks = variable("SLURM_STEP_NUM_TASKS");
  const int steps = variable("SLURM_PROCID") && variable("SLURM_STEP_ID") ? number_in(tasks, 1) : 0;
  return has_pmi || steps > 1 ? std::max(steps, 1) : 0;
}

ChannelSettings channel_settings() {
  ChannelSettings settings;
  const auto read = [](const char* name, auto& value) {
    const char* text = std::getenv(name);
    if (text == nullptr) return;
    char* end = nullptr;
    const double number = std::strtod(text, &end);
    if (end == text || *end != '\0' || !(number > 0 && number < 1e9)) {
      throw Error(fmt::format("{}={}: expected a number above 0", name, text));
    }
    value = static_cast<std::remove_reference_t<decltype(value)>>(number);
  };
  read("PTEXP_MPI_TIMEOUT", settings.timeout_s);
  read("PTEXP_MPI_CHUNK", settings.chunk_bytes);
  settings.chunk_bytes = std::max<std::uint64_t>(settings.chunk_bytes, 1);
  return settings;
}

std::unique_ptr<Channel> open_channel(ChannelSettings settings) {
  const int processes = launched_processes([](const char* name) { return std::getenv(name); });
  // One process, as in an interactive step of Slurm, needs no MPI, whose start there may fail.
  if (processes <= 1) return std::make_unique<LoneChannel>();
  return open_mpi_channel(std::move(settings), processes);
}

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
