// --display: shows a render at work in a viewer, without delaying it.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "app/display/tev.h"
#include "common/image/image.h"

namespace pt {

/// Decides when to take the next image, so that the render loses at most a fiftieth of its time,
/// shorter batches included.
class DisplayPace {
 public:
  static constexpr double least_s = 0.25;  ///< between two images
  static constexpr double share = 0.015;   ///< of the time that showing may take

  bool is_due(double now_s) const { return now_s >= due_s_; }
  /// Taking an image has delayed the render from `begin_s` to `end_s`. `others_s`: time of all
  /// processors that sending the last one took.
  void note(double begin_s, double end_s, double others_s);

 private:
  double due_s_ = 0;
};

class Display {
 public:
  using Warn = std::function<void(const std::string&)>;

  /// Connects. Warns if there is no viewer, and then shows nothing.
  Display(const DisplayAddress& address, std::string name, Warn warn);
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  /// For RenderHooks::watch: takes an image if one is due and the last one was sent. A thread sends
  /// what has changed.
  void watch(const std::function<Image()>& image);
  /// Sends the final image if a viewer is connected; waits a short time for it.
  void finish(const std::function<Image()>& image);

 private:
  void run();
  void send(const Image& image);
  void give_up(const std::string& why);

  const std::string address_text_, name_;
  const Warn warn_;
  DisplayPace pace_;
  std::unique_ptr<Connection> connection_;  ///< null: no viewer

  Image shown_;  ///< by the thread
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Image> next_;  ///< to be sent
  bool is_sending_ = false, ends_ = false;
  double send_s_ = 0;    ///< that the last image took
  std::string problem_;  ///< of sending
  std::thread thread_;
};

}  // namespace pt
