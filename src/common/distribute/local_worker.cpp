#include "common/distribute/local_worker.h"

#include <chrono>
#include <future>

namespace pt {

void ResultBell::ring() {
  const std::lock_guard lock(mutex_);
  has_rung_ = true;
  rung_.notify_all();
}

void ResultBell::wait(double seconds) {
  std::unique_lock lock(mutex_);
  rung_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return has_rung_; });
  has_rung_ = false;
}

LocalWorker::LocalWorker(std::string name, std::uint64_t least_paths, MakeRenderer make,
                         ResultBell& bell)
    : name_(std::move(name)),
      least_paths_(least_paths),
      make_(std::move(make)),
      bell_(bell),
      thread_([this] { run(); }) {}

LocalWorker::~LocalWorker() {
  {
    const std::lock_guard lock(mutex_);
    is_cancelled_ = true;
    ends_ = true;
  }
  has_job_.notify_all();
  thread_.join();
}

// The renderer is destroyed in the thread that made it, too.
void LocalWorker::run() {
  try {
    renderer_ = make_fitting(memory_, make_);
  } catch (...) {
    problem_ = std::current_exception();
  }
  for (;;) {
    std::function<void()> job;
    {
      std::unique_lock lock(mutex_);
      has_job_.wait(lock, [&] { return ends_ || !jobs_.empty(); });
      if (jobs_.empty()) break;
      job = std::move(jobs_.front());
      jobs_.pop_front();
    }
    job();
  }
  renderer_.reset();
}

void LocalWorker::post(std::function<void()> job) {
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
  }
  has_job_.notify_all();
}

void LocalWorker::wait_for(std::function<void()> job) {
  std::promise<void> done;
  post([&] {
    try {
      job();
      done.set_value();
    } catch (...) {
      done.set_exception(std::current_exception());
    }
  });
  done.get_future().get();
}

void LocalWorker::wait_until_ready() {
  wait_for([] {});
  if (problem_) std::rethrow_exception(problem_);
}

/// A render that throws leaves its film as it was.
RenderRun LocalWorker::render_fitting(Film& film, int samples, const std::function<bool()>& stop) {
  RenderHooks hooks;
  hooks.stop = stop;
  hooks.cancel = stop;
  for (;;) {
    try {
      if (renderer_ == nullptr) renderer_ = make_fitting(memory_, make_);
      return renderer_->render(film, samples, hooks);
    } catch (const OutOfMemory& error) {
      renderer_.reset();
      memory_.halve(error);
    }
  }
}

UnitResult LocalWorker::render(Unit unit) {
  const auto start = std::chrono::steady_clock::now();
  UnitResult result{unit.id, std::move(unit.film), {}, 0, "", ""};
  const auto is_cancelled = [this] { return is_cancelled_.load(); };
  if (!is_cancelled()) {
    try {
      if (problem_) std::rethrow_exception(problem_);
      result.run = render_fitting(result.film, unit.samples, is_cancelled);
    } catch (const std::exception& error) {
      result.error = error.what();
    }
  }
  result.warning = memory_.take_warning();
  result.wall_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return result;
}

void LocalWorker::begin(Unit&& unit) {
  {
    const std::lock_guard lock(mutex_);
    ++pending_;
  }
  // A std::function wants copies.
  const auto shared = std::make_shared<Unit>(std::move(unit));
  post([this, shared] {
    UnitResult result = render(std::move(*shared));
    const std::lock_guard lock(mutex_);
    results_.push_back(std::move(result));
    if (--pending_ == 0) is_cancelled_ = false;
    bell_.ring();
  });
}

std::optional<UnitResult> LocalWorker::poll() {
  const std::lock_guard lock(mutex_);
  if (results_.empty()) return std::nullopt;
  UnitResult result = std::move(results_.front());
  results_.pop_front();
  return result;
}

void LocalWorker::cancel() {
  const std::lock_guard lock(mutex_);
  if (pending_ > 0) is_cancelled_ = true;
}

void LocalWorker::describe(RenderReport& report) {
  wait_for([&] {
    if (renderer_) renderer_->describe(report);
  });
}

}  // namespace pt
