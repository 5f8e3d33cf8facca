#include "app/render/checkpoint_keeper.h"

#include <memory>

#include "common/error/host_memory.h"
#include "common/platform/steady_seconds.h"

namespace pt {

CheckpointKeeper::CheckpointKeeper(float interval_s, Save save, Warn warn)
    : interval_s_(interval_s),
      save_(std::move(save)),
      warn_(std::move(warn)),
      saved_s_(steady_seconds()) {}

CheckpointKeeper::~CheckpointKeeper() { wait(); }

void CheckpointKeeper::wait() {
  if (thread_.joinable()) thread_.join();
}

void CheckpointKeeper::film_grew(const ImageFilm& film) {
  if (steady_seconds() - saved_s_ < interval_s_ || is_saving_) return;
  wait();
  is_saving_ = true;
  try {
    const auto copy = std::make_shared<const ImageFilm>(film);
    thread_ = std::thread([this, copy] { try_to_save(*copy); });
  } catch (const std::exception&) {  // no memory for a copy, or no thread: the render waits
    try_to_save(film);
  }
  saved_s_ = steady_seconds();
}

void CheckpointKeeper::try_to_save(const ImageFilm& film) {
  std::string problem;
  try {
    save_(film);
  } catch (const std::exception& error) {
    problem = message_of(error);
  }
  if (!problem.empty() && problem != problem_) warn_(problem);
  problem_ = problem;
  is_saving_ = false;
}

void CheckpointKeeper::finish(const ImageFilm& film) {
  wait();
  save_(film);
}

}  // namespace pt
