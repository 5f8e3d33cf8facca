#include "common/mpi/serve_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "common/distribute/unit_message.h"

namespace pt {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Of a device that works: a hundredth of the time that it has worked so far. A core that computes
/// should seldom be asked for; the device has its next unit already.
std::chrono::microseconds pause_after(Clock::duration busy) {
  return std::clamp(std::chrono::duration_cast<std::chrono::microseconds>(busy / 100), 100us,
                    2000us);
}

/// Of this rank.
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
