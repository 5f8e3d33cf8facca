// Files of a scene that other threads decode before the loader asks for them, so that a loader
// walks its description in order and meshes and pictures still come from all cores.
#pragma once

#include <tbb/task_group.h>

#include <any>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "common/scene/load/files/scene_files.h"

namespace pt {

/// While one exists, loaders in its thread may announce what they will read. What was announced and
/// is never asked for costs time only.
class ReadAhead {
 public:
  /// So many files at most are decoded or being decoded while the loader has not come to them.
  static constexpr std::size_t most_untaken = 32;

  ReadAhead();
  ~ReadAhead();  ///< what has not begun is not read
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  /// Announces that take() will be asked for `key`, once for each announcement. `read` is called in
  /// any thread. Does nothing where no ReadAhead exists.
  static void announce(std::string key, std::function<std::any()> read);
  static bool is_announced(const std::string& key);

  /// What `read` returns or throws: the result of the announced call with this key if another
  /// thread has begun it, else that of a call here and now. A loader sees no difference.
  template <class Read>
  static auto take(const std::string& key, const Read& read) -> decltype(read()) {
    const std::shared_ptr<File> file = claim(key);
    if (!file) return read();
    if (file->problem) std::rethrow_exception(file->problem);
    return std::any_cast<decltype(read())>(std::move(file->value));
  }

 private:
  struct File {
    std::function<std::any()> read;
    enum class State { waiting, running, decoded, taken } state = State::waiting;
    std::any value;
    std::exception_ptr problem;
    SceneFiles::Hashes hashes;
  };

  /// The file, decoded; null where the caller is to read it.
  static std::shared_ptr<File> claim(const std::string& key);
  std::shared_ptr<File> wait_for(const std::string& key);
  void decode_later();
  bool decode_next();

  ReadAhead* const outer_;  ///< of this thread, before
  const bool has_threads_;
  std::mutex mutex_;  ///< of all that follow
  std::condition_variable decoded_;
  std::multimap<std::string, std::shared_ptr<File>> announced_;
  std::deque<std::shared_ptr<File>> waiting_;  ///< some of which were taken
  std::size_t untaken_ = 0;                    ///< running or decoded, and not taken
  tbb::task_group threads_;
};

}  // namespace pt
