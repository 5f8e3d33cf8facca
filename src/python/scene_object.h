// A scene in memory as Python sees it.
#pragma once

#include <nanobind/nanobind.h>

#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "app/render/advise.h"
#include "app/render/render_session.h"
#include "common/error/terminal.h"
#include "common/scene/edit/scene_parameters.h"
#include "python/image_object.h"

namespace pt::python {

/// (keyword, value) as on the command line.
using Words = std::vector<std::pair<std::string, std::string>>;

/// Throws Error for an unknown option.
RenderCommand command_of(const Words& words);

class SceneObject {
 public:
  /// Loads without the interpreter's lock; gives warnings to Python.
  static std::unique_ptr<SceneObject> load(const Words& words);
  explicit SceneObject(SceneData scene)
      : session_(std::make_unique<RenderSession>(std::move(scene))) {
    list_parameters();
  }

  /// The image, the exception that was raised meanwhile (or None), and warnings. The caller takes
  /// the image before it raises and warns, so that it is not lost.
  using Rendered =
      std::tuple<std::unique_ptr<ImageObject>, nanobind::object, std::vector<std::string>>;
  /// As RenderSession::render, interruptible.
  Rendered render(const Words& words, nanobind::object progress, bool on_device);
  std::vector<Decision> plan(const Words& words);
  /// The advice, and the exception that was raised meanwhile (or None).
  using Advised = std::pair<std::optional<Advice>, nanobind::object>;
  Advised advise(const Words& words, double limit_s);

  std::string name() const { return session_->scene().name; }
  const std::vector<SceneParameter>& parameters() const { return parameters_; }
  std::vector<float> get(std::size_t parameter);
  /// The value that it has already does nothing. Throws Error for one that it cannot have.
  void set(std::size_t parameter, std::span<const float> values);
  /// Times in seconds and 4x4 matrices of what moves; none: it stands still.
  using Keys = std::vector<std::pair<double, std::vector<float>>>;
  Keys get_keys(std::size_t parameter);
  void set_keys(std::size_t parameter, const Keys& keys);
  nanobind::dict defaults() const;

 private:
  SceneObject() = default;
  void list_parameters() { parameters_ = scene_parameters(session_->scene()); }
  std::unique_lock<std::mutex> lock();

  std::mutex mutex_;  ///< one render or change at a time
  std::unique_ptr<RenderSession> session_;
  std::vector<SceneParameter> parameters_;
};

/// Collects warnings of any thread, to be given to Python when its lock is held.
class Warnings {
 public:
  RenderSession::Warn collector() {
    return [this](const std::string& message) {
      const std::lock_guard lock(mutex_);
      messages_.push_back(message_line(message));
    };
  }
  std::vector<std::string> take();
  /// Throws python_error where a filter makes them errors.
  void give();

 private:
  std::mutex mutex_;
  std::vector<std::string> messages_;
};

}  // namespace pt::python
