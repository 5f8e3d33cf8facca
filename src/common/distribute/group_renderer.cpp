#include "common/distribute/group_renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <utility>

#include "common/error/error.h"
#include "common/film/develop.h"
#include "common/film/pixel_statistics.h"
#include "common/render/settings_of.h"

namespace pt {
namespace {

// Films come home so often, and a render that is interrupted waits for nobody longer.
constexpr double unit_s = 1;
// Before its rate is known a worker gets so many times what keeps it busy.
constexpr std::uint64_t first_unit_factor = 64;
// A render that takes longer grows evenly until so much is left.
constexpr double even_s = 20;
// Between two looks at the time, at interruptions and at workers without a bell.
constexpr double poll_s = 2e-4, poll_most_s = 2e-3, bell_s = 0.02;

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

int windows_per_worker() {
  const char* const text = std::getenv(units_variable);
  return text == nullptr ? 0 : std::max(0, std::atoi(text));
}

void add_stages(std::vector<StageTime>& stages, const std::vector<StageTime>& more) {
  for (const StageTime& time : more) {
    const auto found = std::ranges::find(stages, time.stage, &StageTime::stage);
    if (found == stages.end()) {
      stages.push_back(time);
    } else {
      found->time_ms += time.time_ms, found->launches += time.launches;
    }
  }
}

}  // namespace

GroupRenderer::GroupRenderer(const ImageSettings& settings, const PixelFilter& filter,
                             Workers workers, std::shared_ptr<ResultBell> bell, GroupHooks hooks)
    : settings_(settings),
      film_plan_(film_plan_of(settings, filter)),
      filter_(filter),
      bell_(std::move(bell)),
      hooks_(std::move(hooks)),
      windows_{window_of(settings)},
      start_(window_of(settings), film_plan_),
      film_(start_) {
  if (settings.integrator == IntegratorKind::mlt) {
    throw Error(
        "--integrator mlt: its chains walk over the whole image, which is not divided; "
        "expected one device, without --checkpoint and --part");
  }
  for (std::unique_ptr<Worker>& worker : workers) {
    Member member;
    member.share.name = worker->name();
    member.worker = std::move(worker);
    members_.push_back(std::move(member));
  }
}

void GroupRenderer::start_from(ImageFilm film) { start_ = std::move(film), film_ = start_; }

void GroupRenderer::restrict_to(std::vector<Window> windows) { windows_ = std::move(windows); }

RenderRun GroupRenderer::render(const RenderHooks& hooks) {
  if (start_.parts.empty()) {
    film_.clear();
  } else {
    film_ = start_;
  }
  return add_samples(static_cast<std::uint32_t>(settings_.spp), hooks);
}

RenderRun GroupRenderer::render(Film& film, int samples, const RenderHooks& hooks) {
  const std::vector<Window> windows = std::exchange(windows_, {film.window});
  film_ = ImageFilm(window_of(settings_), film_plan_);
  film_.put(film);
  const RenderRun run = add_samples(film.next_sample + static_cast<std::uint32_t>(samples), hooks);
  film = film_.take(film.window);
  film.tally = film_.tally;
  windows_ = windows;
  return run;
}

RenderRun GroupRenderer::add(int samples, const RenderHooks& hooks) {
  const std::uint32_t before = film_.least_samples(windows_);
  RenderRun run = add_samples(before + static_cast<std::uint32_t>(samples), hooks);
  run.samples_done -= static_cast<int>(before);
  return run;
}

// As of one device, samples are added by portions where something but their number may end the
// render: all pixels then have the same.
RenderRun GroupRenderer::add_samples(std::uint32_t end, const RenderHooks& hooks) {
  RenderRun run;
  for (Member& member : members_) member.share = {member.share.name, 0, 0, 0, 0};
  const bool has_stop = hooks.stops.seconds > 0 || hooks.stops.relative_error > 0;
  if (!has_stop) {
    if (!complete(end, hooks, run)) run.ended_by = RunEnd::interrupted;
  } else {
    std::uint64_t least = 0, pixels = 0;
    for (const Member& member : members_) least += member.worker->least_paths();
    for (const Window& window : windows_) pixels += window.pixel_count();
    const std::uint32_t begin = film_.least_samples(windows_);
    BatchPace pace(least);
    const BatchRun batches = for_each_batch(
        static_cast<int>(end - begin), static_cast<int>(end - begin), pixels, hooks,
        [&](int first, int count) {
          RenderHooks stoppable;
          stoppable.stop = hooks.stop;
          return complete(begin + static_cast<std::uint32_t>(first + count), stoppable, run);
        },
        [&] { return estimate_error(); }, &pace);
    run.ended_by = batches.ended_by;
    run.relative_error = batches.relative_error;
  }
  run.samples_done = static_cast<int>(film_.least_samples(windows_));
  for (const Member& member : members_) {
    run.devices.push_back(member.share);
    run.kernel_ms = std::max(run.kernel_ms, member.share.kernel_ms);
  }
  return run;
}

/// Until all pixels have the samples up to `end`. False: interrupted.
bool GroupRenderer::complete(std::uint32_t end, const RenderHooks& hooks, RenderRun& run) {
  std::vector<FilmPart> parts;
  UnitRule rule{0, 1, windows_per_worker()};
  for (const Member& member : members_) {
    if (member.has_failed) continue;
    ++rule.workers;
    rule.least_paths = std::max(rule.least_paths, member.worker->least_paths());
  }
  for (const Window& window : windows_) {
    for (const FilmPart& lacking : film_.lacking(window, end)) {
      const int samples = static_cast<int>(end - lacking.next_sample);
      for (const Window& piece : divide_pixels({lacking.window}, samples, rule)) {
        parts.push_back({piece, lacking.first_sample, lacking.next_sample});
      }
    }
  }
  UnitQueue queue(parts, end);
  const std::uint64_t total = queue.paths_left();
  bool is_interrupted = false;
  for (auto active = std::chrono::steady_clock::now();;) {
    if (!is_interrupted) hand_out(queue);
    const bool is_idle =
        std::ranges::all_of(members_, [](const Member& m) { return m.ids.empty(); });
    if (is_idle && (is_interrupted || queue.is_done())) break;
    if (is_idle) throw Error("no device is left that could go on");
    if (collect(queue, run)) {
      active = std::chrono::steady_clock::now();
    } else if (bell_) {
      bell_->wait(bell_s);
    } else {  // a hundredth of the time in which nothing came: this takes a core from a device
      ResultBell().wait(std::clamp(0.01 * seconds_since(active), poll_s, poll_most_s));
    }
    if (hooks.progress) hooks.progress(total - queue.paths_left(), total);
    if (!is_interrupted && hooks.stop && hooks.stop()) {
      is_interrupted = true;
      for (Member& member : members_) member.worker->cancel();
    }
  }
  return queue.is_done();
}

double GroupRenderer::paths_per_s() const {
  double sum = 0;
  for (const Member& member : members_) {
    if (!member.has_failed) sum += member.paths_per_s;
  }
  return sum;
}

std::uint64_t GroupRenderer::unit_paths(const Member& member) const {
  if (member.paths_per_s > 0) return static_cast<std::uint64_t>(unit_s * member.paths_per_s) + 1;
  return first_unit_factor * member.worker->least_paths();
}

void GroupRenderer::hand_out(UnitQueue& queue) {
  const auto even_paths = static_cast<std::uint64_t>(even_s * paths_per_s());
  // The second unit of a worker waits until all have a first one.
  for (std::size_t depth = 0; depth < 2; ++depth) {
    for (Member& member : members_) {
      const auto capacity = static_cast<std::size_t>(member.worker->capacity());
      if (member.has_failed || member.ids.size() != depth || depth >= capacity) continue;
      const auto span = queue.next(unit_paths(member), even_paths);
      if (!span) return;
      member.at_work.push_back(*span);
      member.ids.push_back(++next_id_);
      FilmSums memory;
      if (!spares_.empty()) memory = std::move(spares_.back()), spares_.pop_back();
      member.worker->begin(
          {next_id_, film_.take(span->part.window, std::move(memory)), span->samples});
    }
  }
}

bool GroupRenderer::collect(UnitQueue& queue, RenderRun& run) {
  bool any = false;
  for (Member& member : members_) {
    while (!member.has_failed && !member.ids.empty()) {
      std::optional<UnitResult> result = member.worker->poll();
      if (!result) break;
      any = true;
      take(member, std::move(*result), queue, run);
    }
  }
  return any;
}

void GroupRenderer::take(Member& member, UnitResult&& result, UnitQueue& queue, RenderRun& run) {
  const UnitSpan span = member.at_work.front();
  if (result.error.empty() && result.id != member.ids.front()) {
    result.error = "sent the result of another unit";
  }
  if (!result.warning.empty() && hooks_.warn) {
    hooks_.warn(fmt::format("{}: {}", member.share.name, result.warning));
  }
  if (!result.error.empty()) {
    fail(member, result.error, queue);
    return;
  }
  member.at_work.erase(member.at_work.begin());
  member.ids.erase(member.ids.begin());
  const std::uint32_t next_sample =
      span.part.next_sample + static_cast<std::uint32_t>(result.run.samples_done);
  queue.end(span.part.window, next_sample);
  if (result.run.samples_done == 0) return;
  film_.put(result.film);
  if (spares_.size() < 2 * members_.size()) spares_.push_back(std::move(result.film));
  const auto paths = static_cast<double>(span.part.window.pixel_count()) * result.run.samples_done;
  // By kernel time alone: a unit that is short beside its transfers must not make the
  // next one shorter still.
  if (result.run.kernel_ms > 0) member.paths_per_s = paths / (1e-3 * result.run.kernel_ms);
  DeviceShare& share = member.share;
  ++share.units;
  share.samples += static_cast<std::uint64_t>(paths);
  share.kernel_ms += result.run.kernel_ms, share.wall_ms += result.wall_ms;
  add_stages(run.stages, result.run.stages);
  run.waves += result.run.waves;
  if (hooks_.film_grew) hooks_.film_grew(film_);
}

// Its units are as they were: others get them.
void GroupRenderer::fail(Member& member, const std::string& error, UnitQueue& queue) {
  member.has_failed = true;
  for (const UnitSpan& span : member.at_work) queue.end(span.part.window, span.part.next_sample);
  member.at_work.clear();
  member.ids.clear();
  const bool is_last = std::ranges::all_of(members_, [](const Member& m) { return m.has_failed; });
  if (is_last)
    throw Error(fmt::format("{}: {}; no other device is left", member.share.name, error));
  if (hooks_.warn) {
    hooks_.warn(fmt::format("{}: {}; the other devices go on", member.share.name, error));
  }
}

Image GroupRenderer::image() {
  const Window& window = film_.window;
  Image image = develop(film_, filter_);
  image.place = {static_cast<int>(window.x), static_cast<int>(window.y), settings_.width,
                 settings_.height};
  return image;
}

double GroupRenderer::estimate_error() const {
  const std::uint64_t pixels = film_.window.pixel_count();
  return relative_error(PixelReader(film_, film_plan_, filter_, pixels), pixels,
                        film_.least_samples());
}

// Memory is the sum over all devices, as are kernels' times; what else there is to tell is the
// first one's.
void GroupRenderer::describe(RenderReport& report) const {
  std::vector<BufferSize> memory;
  std::vector<std::string> names;
  for (auto member = members_.rbegin(); member != members_.rend(); ++member) {
    if (member->has_failed) continue;
    report.memory.clear();
    member->worker->describe(report);
    names.insert(names.begin(), report.device_name);
    for (const BufferSize& buffer : report.memory) {
      const auto found = std::ranges::find(memory, buffer.name, &BufferSize::name);
      if (found == memory.end()) {
        memory.push_back(buffer);
      } else {
        found->size_bytes += buffer.size_bytes;
      }
    }
  }
  report.memory = std::move(memory);
  report.counts = summarize(film_.tally);
  if (names.size() < 2) return;
  const bool all_same = std::ranges::count(names, names.front()) == std::ssize(names);
  report.device_name = all_same ? fmt::format("{} x {}", names.size(), names.front())
                                : fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace pt
