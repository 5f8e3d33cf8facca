// What test_mpirun.py starts by mpirun: ranks with fake workers. Usage: ranks_program SCENARIO
// [NUMBER...]; rank 0 prints what it found.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <ctime>

#include "common/error/error.h"
#include "common/mpi/ranks.h"
#include "fake_worker.h"
#include "thread_channels.h"

namespace pt {
namespace {

using Workers = std::vector<std::unique_ptr<Worker>>;
using Clock = std::chrono::steady_clock;

volatile sig_atomic_t signalled = 0;

double ms_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

void sleep_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

/// An image of which all ranks make units; `work` is called at each unit of a rank.
int render(Ranks& ranks, int devices, int failing_rank, const std::function<void(int unit)>& work,
           const std::function<bool()>& stop = {}) {
  Workers workers;
  std::vector<std::string> names;
  for (int i = 0; i < devices; ++i) {
    names.push_back("cpu:" + std::to_string(i));
    const int fails_at = ranks.rank() == failing_rank ? 5 : -1;
    workers.push_back(std::make_unique<FakeWorker>(names.back(), fails_at, work));
  }
  ranks.announce(names);
  if (!ranks.is_first()) return serve_units(ranks, workers), 0;
  for (auto& worker : remote_workers(ranks)) workers.push_back(std::move(worker));
  FakeGroup group({3, 2, 64, 200}, 1, 2, 4);
  group.run(workers, stop);
  RenderReport report;
  workers.back()->describe(report);
  fmt::print("{} units, {}, {} errors, {} workers, the last one {}: {}\n", group.results,
             group.is_right() ? "right" : "not right", group.errors.size(), workers.size(),
             workers.back()->name(), report.device_name);
  return 0;
}

int exception_on(Ranks& ranks, int rank) {
  return render(ranks, 1, -1, [&, rank](int unit) {
    sleep_ms(1);
    if (unit == 3 && ranks.rank() == rank) throw Error("planted");
  });
}

int signal_on(Ranks& ranks, int rank, int signal) {
  return render(ranks, 1, -1, [&, rank, signal](int unit) {
    sleep_ms(5);
    if (unit == 3 && ranks.rank() == rank) ::kill(::getpid(), signal);
  });
}

/// All of them stop for some seconds, as a batch system may want.
int suspend(Ranks& ranks, int seconds) {
  ranks.gather("");
  sleep_ms(200);  // so that this is on its way
  const auto command = fmt::format("(sleep {}; kill -CONT {}) &", seconds, ::getpid());
  if (std::system(command.c_str()) == 0) ::kill(::getpid(), SIGSTOP);
  return render(ranks, 1, -1, {});
}

int interrupt(Ranks& ranks) {
  if (ranks.is_first()) {
    for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) {
      ::signal(signal, [](int number) { signalled = number; });
    }
    fmt::print(stderr, "ready\n");
  }
  render(
      ranks, 1, -1, [](int) { sleep_ms(20); }, [] { return signalled != 0; });
  return 128 + signalled;
}

int mismatch(Ranks& ranks, int rank) {
  const bool is_other = ranks.rank() == rank;
  ranks.agree({{"commit", "abc"}, {"options", is_other ? "spp 4\nwidth 9" : "spp 4\nwidth 8"}});
  fmt::print("agreed\n");
  return 0;
}

int broadcast(Ranks& ranks, std::uint64_t size) {
  const auto value = [](std::uint64_t i) {
    return static_cast<char>((i * 0x9e3779b97f4a7c15) >> 56);
  };
  std::string bytes;
  if (ranks.is_first()) {
    bytes.resize(size);
    for (std::uint64_t i = 0; i < size; ++i) bytes[i] = value(i);
  }
  ranks.gather("");
  const auto begin = Clock::now();
  ranks.broadcast(bytes);
  const double ms = ms_since(begin);
  bool is_right = bytes.size() == size;
  for (std::uint64_t i = 0; i < bytes.size(); ++i) is_right &= bytes[i] == value(i);
  const auto all = ranks.gather(is_right ? "right" : "not right");
  if (ranks.is_first()) {
    fmt::print("{} of {} right, {:.2f} GB/s\n", std::ranges::count(all, "right"), ranks.count(),
               static_cast<double>(size) / ms / 1e6);
  }
  return 0;
}

/// Units of no work, one at a time: from begin() to their result.
int ping(Ranks& ranks, int count, std::uint32_t pixels, int pause_us) {
  Workers workers;
  if (!ranks.is_first()) workers.push_back(std::make_unique<FakeWorker>("cpu"));
  ranks.announce(std::vector<std::string>(workers.size(), "cpu"));
  if (!ranks.is_first()) return serve_units(ranks, workers), 0;
  workers = remote_workers(ranks);
  std::vector<double> times;
  for (int i = 0; i < count; ++i) {
    Unit unit;
    unit.film.window = {0, 0, pixels, 1};
    unit.film.parts = {unit.film.window};
    unit.film.reset({}, pixels);
    std::this_thread::sleep_for(std::chrono::microseconds(pause_us));
    const auto begin = Clock::now();
    workers[0]->begin(std::move(unit));
    while (!workers[0]->poll()) std::this_thread::sleep_for(std::chrono::microseconds(20));
    times.push_back(ms_since(begin));
  }
  std::ranges::sort(times);
  fmt::print("round trip of {} pixels: median {:.3f} ms, 90 % {:.3f} ms, longest {:.3f} ms\n",
             pixels, times[count / 2], times[count * 9 / 10], times.back());
  return 0;
}

/// As long as loading a large scene takes.
int quiet(Ranks& ranks, int ms) {
  const std::clock_t begin = std::clock();
  sleep_ms(ms);
  const auto cpu_ms = static_cast<double>(std::clock() - begin) * 1e3 / CLOCKS_PER_SEC;
  if (ranks.is_first()) fmt::print("{:.1f} % of a core\n", 100 * cpu_ms / ms);
  return render(ranks, 1, -1, {});
}

int run(Ranks& ranks, const std::vector<std::string>& arguments) {
  const auto number = [&](std::size_t i) { return std::stoll(arguments.at(i)); };
  const std::string& scenario = arguments.at(0);
  if (scenario == "units") {
    return render(ranks, static_cast<int>(number(1)), static_cast<int>(number(2)), {});
  }
  if (scenario == "exception") return exception_on(ranks, static_cast<int>(number(1)));
  if (scenario == "kill") return signal_on(ranks, static_cast<int>(number(1)), SIGKILL);
  if (scenario == "hang") return signal_on(ranks, static_cast<int>(number(1)), SIGSTOP);
  if (scenario == "suspend") return suspend(ranks, static_cast<int>(number(1)));
  if (scenario == "interrupt") return interrupt(ranks);
  if (scenario == "mismatch") return mismatch(ranks, static_cast<int>(number(1)));
  if (scenario == "broadcast") return broadcast(ranks, static_cast<std::uint64_t>(number(1)));
  if (scenario == "ping") {
    return ping(ranks, static_cast<int>(number(1)), static_cast<std::uint32_t>(number(2)),
                static_cast<int>(number(3)));
  }
  if (scenario == "quiet") return quiet(ranks, static_cast<int>(number(1)));
  if (scenario == "code") return ranks.is_first() ? static_cast<int>(number(1)) : 0;
  if (scenario == "where") {
    const RankInfo& own = ranks.own();
    const auto all = ranks.gather(
        fmt::format("{} of {}, {}/{}", own.name(), ranks.count(), own.local_rank, own.local_ranks));
    for (const std::string& text : all) fmt::print("{}\n", text);
    return 0;
  }
  throw Error("expected a scenario, not " + scenario);
}

}  // namespace
}  // namespace pt

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  try {
    auto channel = pt::open_channel();
    const auto body = [&](pt::Ranks& ranks) {
      const int code = pt::run(ranks, arguments);
      std::fflush(stdout);
      return code;
    };
    return pt::run_rank(std::move(channel), body, [](const std::string& message) {
      fmt::print(stderr, "ptexp: error: {}\n", message);
    });
  } catch (const std::exception& error) {
    fmt::print(stderr, "ptexp: error: {}\n", error.what());
    return 2;
  }
}
