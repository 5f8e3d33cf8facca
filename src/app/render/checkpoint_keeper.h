// Saves the film of a render from time to time while it goes on.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "common/film/image_film.h"

namespace pt {

class CheckpointKeeper {
 public:
  using Save = std::function<void(const ImageFilm&)>;  ///< may throw Error
  using Warn = std::function<void(const std::string&)>;

  /// `save` writes the file. It is called in a thread of its own, and by finish().
  CheckpointKeeper(float interval_s, Save save, Warn warn);
  ~CheckpointKeeper();
  CheckpointKeeper(const CheckpointKeeper&) = delete;
  CheckpointKeeper& operator=(const CheckpointKeeper&) = delete;

  /// Saves a copy of the film if the last one is older than the interval. A failure is a warning:
  /// the render goes on and saving is tried again after the interval. The same warning is given
  /// once, until a film is saved.
  void film_grew(const ImageFilm& film);
  /// Saves this film. Throws what `save` throws.
  void finish(const ImageFilm& film);
  /// Waits until no film is being saved.
  void wait();

 private:
  void try_to_save(const ImageFilm& film);

  const double interval_s_;
  const Save save_;
  const Warn warn_;
  double saved_s_;
  std::string problem_;  ///< of the last film; used by the thread that saves
  std::atomic<bool> is_saving_{false};
  std::thread thread_;
};

}  // namespace pt
