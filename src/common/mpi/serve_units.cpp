#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <map>

#include "common/distribute/unit_message.h"
#include "common/mpi/ranks.h"

namespace pt {
namespace {

/// What has come from a rank, by its devices.
class RemoteRank {
 public:
  RemoteRank(Ranks& ranks, int rank)
      : ranks_(ranks), rank_(rank), results_(info().devices.size()), devices_(results_.size()) {}
  ~RemoteRank() { ranks_.send(rank_, MessageKind::no_units); }

  const RankInfo& info() const { return ranks_.info(rank_); }
  void send(MessageKind kind, std::string bytes) { ranks_.send(rank_, kind, std::move(bytes)); }

  std::optional<UnitResult> next_result(std::uint32_t device) {
    while (const auto message = ranks_.receive(rank_)) sort(*message);
    auto& results = results_.at(device);
    if (results.empty()) return std::nullopt;
    UnitResult result = std::move(results.front());
    results.pop_front();
    return result;
  }
  void describe(std::uint32_t device, RenderReport& report) const {
    const std::string& bytes = devices_.at(device);
    if (bytes.empty()) return;
    ByteReader reader(bytes);
    reader.number<std::uint32_t>();
    read_device(reader, report);
  }

 private:
  void sort(const Message& message) {
    ByteReader reader(message.bytes);
    const auto device = reader.number<std::uint32_t>();
    if (device >= results_.size()) {
      throw Error(fmt::format("a message of device {} of {}: expected one of {}", device,
                              info().name(), results_.size()));
    }
    if (message.kind == MessageKind::device) {
      devices_[device] = message.bytes;
      return;
    }
    results_[device].push_back(read_unit_result(reader));
    reader.expect_end();
  }

  Ranks& ranks_;
  int rank_;
  std::vector<std::deque<UnitResult>> results_;  ///< [device]
  std::vector<std::string> devices_;             ///< [device] what it says of itself
};

class RemoteWorker : public Worker {
 public:
  RemoteWorker(std::shared_ptr<RemoteRank> rank, std::uint32_t device, std::uint64_t least_paths)
      : rank_(std::move(rank)), device_(device), least_paths_(least_paths) {}

  std::string name() const override {
    return fmt::format("{} {}", rank_->info().name(), rank_->info().devices[device_]);
  }
  int capacity() const override { return 2; }
  std::uint64_t least_paths() const override { return least_paths_; }
  void begin(Unit&& unit) override {
    ByteWriter writer;
    writer.number(device_);
    write(writer, unit);
    rank_->send(MessageKind::unit, writer.take());
  }
  std::optional<UnitResult> poll() override { return rank_->next_result(device_); }
  void cancel() override {
    ByteWriter writer;
    writer.number(device_);
    rank_->send(MessageKind::cancel, writer.take());
  }
  void describe(RenderReport& report) override { rank_->describe(device_, report); }

 private:
  std::shared_ptr<RemoteRank> rank_;
  std::uint32_t device_;
  std::uint64_t least_paths_;
};

}  // namespace

std::vector<std::unique_ptr<Worker>> remote_workers(Ranks& ranks, std::uint64_t least_paths) {
  std::vector<std::unique_ptr<Worker>> workers;
  for (int rank = 1; rank < ranks.count(); ++rank) {
    const auto remote = std::make_shared<RemoteRank>(ranks, rank);
    for (std::uint32_t device = 0; device < remote->info().devices.size(); ++device) {
      workers.push_back(std::make_unique<RemoteWorker>(remote, device, least_paths));
    }
  }
  return workers;
}

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// How long to wait before a working device is asked again: a hundredth of the time that it has
/// worked so far. Asking takes a core from rendering, and the device has its next unit already.
std::chrono::microseconds pause_after(Clock::duration busy) {
  return std::clamp(std::chrono::duration_cast<std::chrono::microseconds>(busy / 100), 100us,
                    2000us);
}

/// A worker of this rank.
struct Served {
  Worker* worker;
  int begun = 0;  ///< units that it has
  bool is_described = false;
};

void obey(const Message& message, std::vector<Served>& served) {
  ByteReader reader(message.bytes);
  const auto index = reader.number<std::uint32_t>();
  if (index >= served.size()) {
    throw Error(fmt::format("a message for device {}: expected one of {}", index, served.size()));
  }
  Served& one = served[index];
  if (message.kind == MessageKind::cancel) return one.worker->cancel();
  Unit unit = read_unit(reader);
  reader.expect_end();
  ++one.begun;
  one.worker->begin(std::move(unit));
}

void send_device(Ranks& ranks, std::uint32_t index, Served& served) {
  RenderReport report;
  served.worker->describe(report);
  ByteWriter writer;
  writer.number(index);
  write_device(writer, report);
  ranks.send(0, MessageKind::device, writer.take());
  served.is_described = true;
}

void send_results(Ranks& ranks, std::uint32_t index, Served& served) {
  while (const std::optional<UnitResult> result = served.worker->poll()) {
    --served.begun;
    // What it is comes before a result, so that rank 0 knows it by then; only of a worker that has
    // nothing else to do, which would answer late.
    if (!served.is_described && served.begun == 0 && result->error.empty()) {
      send_device(ranks, index, served);
    }
    ByteWriter writer;
    writer.number(index);
    write(writer, *result);
    ranks.send(0, MessageKind::result, writer.take());
  }
}

}  // namespace

void serve_units(Ranks& ranks, const std::vector<std::unique_ptr<Worker>>& workers) {
  std::vector<Served> served;
  for (const auto& worker : workers) served.push_back({worker.get()});
  for (Clock::time_point active = Clock::now();;) {
    bool is_busy = false;
    for (std::uint32_t i = 0; i < served.size(); ++i) {
      const int begun = served[i].begun;
      if (begun > 0) send_results(ranks, i, served[i]);
      if (served[i].begun < begun) active = Clock::now();
      is_busy |= served[i].begun > 0;
    }
    const auto message = ranks.receive(0, is_busy ? pause_after(Clock::now() - active) : 100ms);
    if (!message) continue;
    active = Clock::now();
    if (message->kind == MessageKind::no_units) return;
    obey(*message, served);
  }
}

}  // namespace pt
