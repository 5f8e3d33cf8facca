#include "common/scene/load/files/read_ahead.h"

#include <tbb/task_arena.h>

namespace pt {
namespace {

thread_local ReadAhead* of_thread = nullptr;

/// Work for one loader is not done in the name of another, or of the same one: tbb's threads, the
/// loader's as well, take any work while they wait.
class WithoutLoader {
 public:
  WithoutLoader() : outer_(std::exchange(of_thread, nullptr)) {}
  ~WithoutLoader() { of_thread = outer_; }
  WithoutLoader(const WithoutLoader&) = delete;
  WithoutLoader& operator=(const WithoutLoader&) = delete;

 private:
  ReadAhead* const outer_;
};

}  // namespace

ReadAhead::ReadAhead()
    : outer_(of_thread), has_threads_(tbb::this_task_arena::max_concurrency() > 1) {
  of_thread = this;
}

ReadAhead::~ReadAhead() {
  of_thread = outer_;
  {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
  }
  threads_.wait();
}

void ReadAhead::announce(std::string key, std::function<std::any()> read) {
  if (of_thread == nullptr || !of_thread->has_threads_) return;
  const auto file = std::make_shared<File>();
  file->read = std::move(read);
  {
    const std::lock_guard lock(of_thread->mutex_);
    of_thread->announced_.emplace(std::move(key), file);
    of_thread->waiting_.push_back(file);
  }
  of_thread->decode_later();
}

bool ReadAhead::is_announced(const std::string& key) {
  if (of_thread == nullptr) return false;
  const std::lock_guard lock(of_thread->mutex_);
  return of_thread->announced_.contains(key);
}

void ReadAhead::decode_later() {
  threads_.run([this] { decode_next(); });
}

std::shared_ptr<ReadAhead::File> ReadAhead::claim(const std::string& key) {
  return of_thread == nullptr ? nullptr : of_thread->wait_for(key);
}

std::shared_ptr<ReadAhead::File> ReadAhead::wait_for(const std::string& key) {
  std::unique_lock lock(mutex_);
  const auto found = announced_.find(key);
  if (found == announced_.end()) return nullptr;
  const std::shared_ptr<File> file = found->second;
  announced_.erase(found);
  if (file->state == File::State::waiting) {
    file->state = File::State::taken;
    return nullptr;
  }
  while (file->state != File::State::decoded) {
    lock.unlock();
    const bool has_helped = decode_next();
    lock.lock();
    if (!has_helped) decoded_.wait(lock, [&] { return file->state == File::State::decoded; });
  }
  --untaken_;
  lock.unlock();
  decode_later();
  SceneFiles::note(file->hashes);
  return file;
}

/// False where there is no file to decode, or enough are decoded.
bool ReadAhead::decode_next() {
  std::unique_lock lock(mutex_);
  while (!waiting_.empty() && waiting_.front()->state == File::State::taken) waiting_.pop_front();
  if (waiting_.empty() || untaken_ == most_untaken) return false;
  const std::shared_ptr<File> file = waiting_.front();
  waiting_.pop_front();
  file->state = File::State::running;
  ++untaken_;
  lock.unlock();
  const SceneFiles files;
  std::any value;
  std::exception_ptr problem;
  try {
    const WithoutLoader without;
    value = file->read();
  } catch (...) {
    problem = std::current_exception();
  }
  lock.lock();
  file->value = std::move(value);
  file->problem = problem;
  file->hashes = files.hashes();
  file->state = File::State::decoded;
  lock.unlock();
  decoded_.notify_all();
  return true;
}

}  // namespace pt
