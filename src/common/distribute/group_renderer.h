// Several workers as one renderer. Pixels are divided among them, never the samples of a pixel, and
// every unit's sums continue those of its window; so the image has the bits of one worker's,
// whatever the number of workers, their speed, and the units that were cut short.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "common/distribute/local_worker.h"
#include "common/distribute/unit_queue.h"
#include "common/film/image_film.h"
#include "common/render/batches.h"
#include "common/render/renderer.h"

namespace pt {

/// Environment variable of tests and experiments: so many windows of one size for each device.
inline constexpr const char* units_variable = "PTEXP_UNITS_PER_DEVICE";

/// What a group asks of who uses it. All may be empty.
struct GroupHooks {
  /// After each unit: the film so far.
  std::function<void(const ImageFilm&)> film_grew;
  /// A worker failed, and others go on.
  std::function<void(const std::string&)> warn;
};

class GroupRenderer : public Renderer {
 public:
  using Workers = std::vector<std::unique_ptr<Worker>>;

  /// `scene` is prepared; its filter is needed alone. `bell` rings at results; null: workers are
  /// asked often.
  GroupRenderer(const ImageSettings& settings, const PixelFilter& filter, Workers workers,
                std::shared_ptr<ResultBell> bell, GroupHooks hooks = {});

  /// Renders begin with the samples of this film instead of none, and add the rest of
  /// ImageSettings::spp.
  void start_from(ImageFilm film);
  /// Renders no other pixels. By default those of the film's window.
  void restrict_to(std::vector<Window> windows);

  /// Throws Error, too, where no worker is left; film() then has what was done.
  RenderRun render(const RenderHooks& hooks) override;
  RenderRun render(Film& film, int samples, const RenderHooks& hooks) override;
  RenderRun add(int samples, const RenderHooks& hooks) override;
  Image image() override;
  void describe(RenderReport& report) const override;

  const ImageFilm& film() const { return film_; }

 private:
  struct Member {
    std::unique_ptr<Worker> worker;
    DeviceShare share;
    std::vector<UnitSpan> at_work;  ///< in the order in which they were begun
    std::vector<std::uint64_t> ids;
    double paths_per_s = 0;
    bool has_failed = false;
  };

  RenderRun add_samples(std::uint32_t end, const RenderHooks& hooks);
  bool complete(std::uint32_t end, const RenderHooks& hooks, RenderRun& run);
  void hand_out(UnitQueue& queue);
  bool collect(UnitQueue& queue, RenderRun& run);
  void take(Member& member, UnitResult&& result, UnitQueue& queue, RenderRun& run);
  void fail(Member& member, const std::string& error, UnitQueue& queue);
  std::uint64_t unit_paths(const Member& member) const;
  double paths_per_s() const;
  double estimate_error() const;

  const ImageSettings settings_;
  const FilmPlan film_plan_;
  const PixelFilter filter_;
  std::shared_ptr<ResultBell> bell_;
  GroupHooks hooks_;
  std::vector<Member> members_;
  std::vector<Window> windows_;  ///< to be rendered
  ImageFilm start_, film_;
  std::vector<FilmSums> spares_;  ///< memory of films that came home
  std::uint64_t next_id_ = 0;
};

}  // namespace pt
