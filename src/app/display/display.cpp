#include "app/display/display.h"

#include <algorithm>
#include <chrono>

#include "app/options/option_values.h"
#include "common/error/error.h"
#include "common/platform/steady_seconds.h"

namespace pt {
namespace {

constexpr double connect_s = 2, last_image_s = 2;

}  // namespace

void DisplayPace::note(double begin_s, double end_s, double others_s) {
  due_s_ = end_s + std::max(least_s, (end_s - begin_s + others_s) / share);
}

Display::Display(const DisplayAddress& address, std::string name, Warn warn)
    : address_text_(display_text(address)), name_(std::move(name)), warn_(std::move(warn)) {
  try {
    connection_ = std::make_unique<Connection>(address, connect_s);
    thread_ = std::thread([this] { run(); });
  } catch (const std::exception& error) {  // of the network, or no thread
    connection_.reset();
    if (warn_)
      warn_("--display " + address_text_ + ": " + error.what() + "; the render is not shown");
  }
}

Display::~Display() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  connection_->end();
  thread_.join();
}

void Display::watch(const std::function<Image()>& image) {
  const double begin_s = steady_seconds();
  if (!connection_ || !pace_.is_due(begin_s)) return;
  double others_s = 0;
  std::string problem;
  {
    const std::lock_guard lock(mutex_);
    if (next_ || is_sending_) return;
    others_s = send_s_ / std::max(1u, std::thread::hardware_concurrency());
    problem = problem_;
  }
  if (!problem.empty()) return give_up(problem);
  Image taken = image();
  pace_.note(begin_s, steady_seconds(), others_s);
  {
    const std::lock_guard lock(mutex_);
    next_ = std::move(taken);
  }
  changed_.notify_all();
}

void Display::finish(const std::function<Image()>& image) {
  if (!connection_) return;
  const auto is_idle = [this] { return (!next_ && !is_sending_) || !problem_.empty(); };
  const auto limit = std::chrono::duration<double>(last_image_s);
  std::unique_lock lock(mutex_);
  bool is_sent = changed_.wait_for(lock, limit, is_idle);
  if (is_sent && problem_.empty()) {
    next_ = image();
    changed_.notify_all();
    is_sent = changed_.wait_for(lock, limit, is_idle);
  }
  const std::string problem = is_sent ? problem_ : "does not take what is sent to it";
  lock.unlock();
  if (!problem.empty()) give_up(problem);
}

void Display::give_up(const std::string& why) {
  connection_->end();
  thread_.join();
  connection_.reset();
  if (warn_) warn_("--display " + address_text_ + ": " + why + "; no more is shown");
}

void Display::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return next_ || ends_; });
    if (ends_) return;
    const Image image = std::move(*next_);
    next_.reset();
    is_sending_ = true;
    lock.unlock();
    const double begin_s = steady_seconds();
    std::string problem;
    try {
      send(image);
    } catch (const std::exception& error) {  // of the network, or no memory
      problem = error.what();
    }
    lock.lock();
    is_sending_ = false;
    send_s_ = steady_seconds() - begin_s;
    problem_ = problem;
    changed_.notify_all();
    if (!problem.empty()) return;
  }
}

void Display::send(const Image& image) {
  const bool is_first = shown_.rgb.size() != image.rgb.size();
  if (is_first) {
    const bool is_part = image.place.width > 0;
    connection_->send(tev::create_image(name_, is_part ? image.place.width : image.width,
                                        is_part ? image.place.height : image.height));
    shown_ = {};
  }
  for (const CropWindow& part : tev::changed_parts(shown_, image))
    connection_->send(tev::update_image(name_, image, part));
  shown_ = image;
}

}  // namespace pt
