// A worker whose samples are numbers that anyone can compute again, so that no renderer is needed.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <map>
#include <thread>

#include "common/distribute/worker.h"
#include "common/film/image_film.h"

namespace pt {

/// The "radiance" of a sample; sums of it depend on the order of the samples.
inline double fake_sample(std::uint32_t x, std::uint32_t y, std::uint32_t sample, int channel) {
  return 1.0 / (1.0 + x * 7 + y * 13 + sample * 3 + channel) + x;
}

/// Continues the film as a renderer would.
inline void take_fake_samples(Film& film, const FilmPlan& plan, int samples) {
  const Window& w = film.window;
  if (film.is_empty()) film.reset(plan, w.pixel_count());
  film.parts = {w};
  for (int s = 0; s < samples; ++s, ++film.next_sample) {
    for (std::uint64_t i = 0; i < w.pixel_count(); ++i) {
      const auto x = static_cast<std::uint32_t>(w.x + i % w.width);
      const auto y = static_cast<std::uint32_t>(w.y + i / w.width);
      FilmPixel& pixel = film.pixels[i];
      for (int c = 0; c < 3; ++c) pixel.sum[c] += fake_sample(x, y, film.next_sample, c);
      ++pixel.samples;
      ++film.tally.lengths[(x + y) % path_length_bins];
      film.tally.rays += x + 1;
    }
  }
}

/// Works at poll(), a unit for each call. `fails_at`: the unit of which it makes an error;
/// `work`: called for each unit.
class FakeWorker : public Worker {
 public:
  explicit FakeWorker(std::string name, int fails_at = -1, std::function<void(int unit)> work = {})
      : name_(std::move(name)), fails_at_(fails_at), work_(std::move(work)) {}

  std::string name() const override { return name_; }
  int capacity() const override { return 2; }
  std::uint64_t least_paths() const override { return 1; }
  void begin(Unit&& unit) override { units_.push_back(std::move(unit)); }
  std::optional<UnitResult> poll() override {
    if (units_.empty()) return std::nullopt;
    Unit unit = std::move(units_.front());
    units_.pop_front();
    UnitResult result;
    result.id = unit.id;
    if (work_) work_(count_);
    if (count_++ == fails_at_ || is_broken_) {
      is_broken_ = true;
      result.error = "the device is gone";
      return result;
    }
    const int samples = is_cancelled_ ? 0 : unit.samples;
    if (samples > 0) take_fake_samples(unit.film, {}, samples);
    result.film = std::move(unit.film);
    result.run.samples_done = samples;
    result.run.kernel_ms = static_cast<double>(unit.id) + 0.5;
    result.run.ended_by = is_cancelled_ ? RunEnd::interrupted : RunEnd::samples;
    return result;
  }
  void cancel() override { is_cancelled_ = true; }
  void describe(RenderReport& report) override {
    report.device_name = "device of " + name_;
    report.memory = {{"pool", 12345}};
  }

 private:
  std::string name_;
  int fails_at_;
  std::function<void(int)> work_;
  int count_ = 0;
  bool is_broken_ = false, is_cancelled_ = false;
  std::deque<Unit> units_;
};

/// What the group will do, in short: an image in units, each `rounds` times continued by
/// `samples`, by whoever has room. Those of broken workers go to others.
class FakeGroup {
 public:
  FakeGroup(const Window& window, std::uint32_t rows, int samples, int rounds)
      : image(window, {}), samples_(samples), rounds_(rounds) {
    for (std::uint32_t y = 0; y < window.height; y += rows) {
      open_.push_back({window.x, window.y + y, window.width, std::min(rows, window.height - y)});
    }
    left_ = open_.size() * rounds;
  }

  /// `stop` ends it with what there is by then.
  void run(std::vector<std::unique_ptr<Worker>>& workers, const std::function<bool()>& stop = {}) {
    std::vector<std::map<std::uint64_t, Window>> taken(workers.size());
    std::vector<bool> broken(workers.size());
    bool is_stopped = false;
    const auto is_waiting = [&] {
      return std::ranges::any_of(taken, [](const auto& units) { return !units.empty(); });
    };
    while (is_stopped ? is_waiting() : left_ > 0) {
      bool moved = false;
      if (!is_stopped && stop && stop()) {
        is_stopped = true;
        open_.clear();
        for (auto& worker : workers) worker->cancel();
      }
      for (std::size_t i = 0; i < workers.size(); ++i) {
        Worker& worker = *workers[i];
        while (const auto result = worker.poll()) {
          moved = true;
          end(*result, taken[i], broken, i);
        }
        while (!is_stopped && !broken[i] && !open_.empty() &&
               static_cast<int>(taken[i].size()) < worker.capacity()) {
          taken[i][next_id_] = open_.front();
          worker.begin({next_id_++, image.take(open_.front()), samples_});
          open_.pop_front();
        }
      }
      if (std::ranges::count(broken, false) == 0) throw Error("no device is left");
      if (!moved) std::this_thread::sleep_for(std::chrono::microseconds(20));
    }
  }

  /// Whether the image is that of one worker.
  bool is_right() const {
    Film whole;
    whole.window = image.window;
    take_fake_samples(whole, {}, samples_ * rounds_);
    return whole.tally.rays == image.tally.rays &&
           std::ranges::equal(whole.tally.lengths, image.tally.lengths) &&
           std::ranges::equal(whole.pixels, image.pixels, [](const auto& a, const auto& b) {
             return std::ranges::equal(a.sum, b.sum) && a.samples == b.samples;
           });
  }

  ImageFilm image;
  std::vector<std::string> errors;
  std::uint64_t results = 0;

 private:
  void end(const UnitResult& result, std::map<std::uint64_t, Window>& taken,
           std::vector<bool>& broken, std::size_t worker) {
    const auto unit = taken.extract(result.id);
    if (unit.empty()) throw Error("a unit that came twice, or to nobody");
    if (!result.error.empty()) {
      errors.push_back(result.error);
      broken[worker] = true;
      open_.push_back(unit.mapped());
      return;
    }
    if (result.run.kernel_ms != static_cast<double>(result.id) + 0.5) throw Error("another's time");
    image.put(result.film);
    if (result.run.samples_done == 0) return;  // was cancelled
    ++results, --left_;
    if (result.film.next_sample < static_cast<std::uint32_t>(samples_ * rounds_)) {
      open_.push_back(unit.mapped());
    }
  }

  int samples_, rounds_;
  std::uint64_t left_ = 0, next_id_ = 1;
  std::deque<Window> open_;
};

}  // namespace pt
