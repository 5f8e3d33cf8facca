// Shows a render at work in a viewer, and never keeps it waiting: --display.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "app/display/connection.h"
#include "common/image/image.h"

namespace pt {

/// When the next image is taken from a render that must not lose more than a fiftieth of its time
/// by that, shorter batches included.
class DisplayPace {
 public:
  static constexpr double least_s = 0.25;  ///< between two images
  static constexpr double share = 0.015;   ///< of the time that showing may take

  bool is_due(double now_s) const { return now_s >= due_s_; }
  /// An image was taken, which kept the render from `begin_s` to `end_s`; `others_s`: what the last
  /// one took of the time of all processors, beside the render.
  void note(double begin_s, double end_s, double others_s);

 private:
  double due_s_ = 0;
};

class Display {
 public:
  using Warn = std::function<void(const std::string&)>;

  /// Connects. A viewer that is not there is a warning, and nothing is shown.
  Display(const DisplayAddress& address, std::string name, Warn warn);
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  /// As RenderHooks::watch: takes the image if one is due and the last one was sent, and sends what
  /// changed in a thread of its own.
  void watch(const std::function<Image()>& image);
  /// Sends the final image, which is taken if somebody sees it; waits for the viewer, but not long.
  void finish(const std::function<Image()>& image);

 private:
  void run();
  void send(const Image& image);
  void give_up(const std::string& why);

  const std::string address_text_, name_;
  const Warn warn_;
  DisplayPace pace_;
  std::unique_ptr<Connection> connection_;  ///< null: nobody sees it

  Image shown_;  ///< of the thread
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Image> next_;  ///< to be sent
  bool is_sending_ = false, ends_ = false;
  double send_s_ = 0;    ///< that the last image took
  std::string problem_;  ///< of sending
  std::thread thread_;
};

}  // namespace pt
