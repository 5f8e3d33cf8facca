// A device of this process: a renderer that lives in a thread of its own.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "common/distribute/worker.h"
#include "common/render/memory_share.h"
#include "common/render/renderer.h"

namespace pt {

/// Wakes whoever waits for results.
class ResultBell {
 public:
  void ring();
  /// Until it rings or has rung since the last wait, or for so long.
  void wait(double seconds);

 private:
  std::mutex mutex_;
  std::condition_variable rung_;
  bool has_rung_ = false;
};

class LocalWorker : public Worker {
 public:
  /// A renderer that takes its device's free memory / 2^halvings
  /// (ExecutionSettings::memory_halvings).
  using MakeRenderer = std::function<std::unique_ptr<Renderer>(int halvings)>;

  /// Begins to make the renderer, in the thread in which it will be used; where its device runs out
  /// of memory, then or in a render, it is made again with less, and the next result has a warning.
  /// `bell` rings at each result and must live longer.
  LocalWorker(std::string name, std::uint64_t least_paths, MakeRenderer make, ResultBell& bell);
  ~LocalWorker() override;
  LocalWorker(const LocalWorker&) = delete;
  LocalWorker& operator=(const LocalWorker&) = delete;

  /// Waits until the renderer is made. Throws what making it threw.
  void wait_until_ready();

  std::string name() const override { return name_; }
  int capacity() const override { return 2; }  // goes on while a film is put into the image
  std::uint64_t least_paths() const override { return least_paths_; }
  void begin(Unit&& unit) override;
  std::optional<UnitResult> poll() override;
  void cancel() override;
  void describe(RenderReport& report) override;

 private:
  void run();
  RenderRun render_fitting(Film& film, int samples, const std::function<bool()>& stop);
  UnitResult render(Unit unit);
  /// In the worker's thread, after what it has to do already.
  void post(std::function<void()> job);
  void wait_for(std::function<void()> job);

  const std::string name_;
  const std::uint64_t least_paths_;
  const MakeRenderer make_;
  ResultBell& bell_;
  std::unique_ptr<Renderer> renderer_;  ///< of the thread
  MemoryShare memory_;
  std::exception_ptr problem_;  ///< of making it
  std::atomic<bool> is_cancelled_{false};

  std::mutex mutex_;
  std::condition_variable has_job_;
  std::deque<std::function<void()>> jobs_;
  std::deque<UnitResult> results_;
  int pending_ = 0;  ///< units that have begun and have no result yet
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace pt
