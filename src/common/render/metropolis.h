// Metropolis light transport as a loop over batches: bootstrap, chains, the image. It knows no mode
// and no device: the paths are traced as all others are (docs/design/metropolis.md).
#pragma once

#include "common/film/film_data.h"
#include "common/film/markov_chains.h"
#include "common/plan/render_properties.h"
#include "common/render/batches.h"

namespace pt {

/// How many chains there are and what they take.
struct ChainPlan {
  std::uint64_t chains = 0;
  std::uint64_t bootstrap = 0;        ///< paths before the chains, at most
  std::uint64_t bootstrap_batch = 0;  ///< of them at once
  bool bootstrap_is_timed = false;    ///< it ends when it has had its share of --time-limit
  std::uint32_t blocks = 0;           ///< of random numbers that each chain stores
  int clock_interval = 1;             ///< iterations between two looks at the clock

  /// The paths of the largest batch.
  std::uint64_t batch_paths() const { return std::max(chains, bootstrap_batch); }
};

/// What a device takes where --chains and --bootstrap say nothing.
struct ChainDefaults {
  std::uint64_t chains = std::uint64_t{1} << 13;
  std::uint64_t bootstrap = std::uint64_t{1} << 17;  ///< at least; twice the mutations
  std::uint64_t bootstrap_most = std::uint64_t{1} << 25;
  std::uint64_t clock_interval = std::uint64_t{1} << 16;  ///< paths between two looks at the clock
};

/// Throws Error when the memory cannot hold what the options ask for.
ChainPlan plan_chains(const ImageSettings& settings, const ChainDefaults& defaults,
                      const FilmMemory& memory);

/// Throws Error when the settings ask for what chains cannot do, or the scene has masks or media.
void check_metropolis(const ImageSettings& settings, const SceneProperties& scene,
                      const PixelFilter& filter);

/// What the chains added up.
struct ChainSums {
  std::vector<SplatSum> sums;  ///< [pixel of the window][channel]
  ChainTally steps;
  PathTally paths;

  /// Adds what chains have counted: ChainCounts::copies of them.
  void add(const ChainCounts* counts);
};

/// The mean target of the bootstrap paths and its standard error, and where chains begin.
struct ChainStarts {
  double brightness = 0, brightness_error = 0;
  std::vector<double> below;  ///< [group]: Bootstrap::below
  ChainPositions positions;
};

/// The starts of chains after `paths` bootstrap paths, whose targets have these sums; chains begin
/// in proportion to the target, all by one number `u` in [0, 1). Throws Error where no path found
/// light.
ChainStarts choose_starts(const std::vector<TargetSum>& groups, std::uint32_t paths,
                          std::uint32_t chains, double u);

/// What a device does for the chains. What takes time is added to the run's.
class ChainDevice {
 public:
  virtual ~ChainDevice() = default;

  /// Before the first batch of a render: over which pixels the chains walk. Sums are zero.
  virtual void begin_chains(const ChainWindow& window) = 0;
  /// Traces the bootstrap paths [first, first + count) and keeps their targets. False: `cancel`, a
  /// hook, abandoned them, and none of them counts.
  virtual bool trace_bootstrap(std::uint32_t first, std::uint32_t count, RenderRun& run,
                               const std::function<bool()>& cancel) = 0;
  /// Adds those that were traced last to the sums.
  virtual void splat_bootstrap(std::uint32_t count, const ChainStep& step, RenderRun& run) = 0;
  /// The first `paths` targets, summed by groups.
  virtual std::vector<TargetSum> sum_targets(std::uint32_t paths, RenderRun& run) = 0;
  /// Traces the paths at which the chains begin, and they do.
  virtual void start_chains(const ChainStarts& starts, const ChainStep& step, RenderRun& run) = 0;
  /// Traces a path of each chain and lets it step (ChainStep::Kind::mutate), until each has taken
  /// its step number `last` since its start.
  virtual void mutate_chains(std::uint32_t chains, const ChainStep& step, std::uint32_t last,
                             RenderRun& run) = 0;
  /// The chains add what they have not yet added (ChainStep::Kind::finish).
  virtual void finish_chains(std::uint32_t chains, const ChainStep& step, RenderRun& run) = 0;
  /// And leaves them at zero.
  virtual ChainSums take_chain_sums() = 0;
};

/// Renders `samples` mutations per pixel of the film's window, or more, so that all chains are of
/// the same length. Fills in the film's pixels and counts, but for those of the bootstrap's paths,
/// which the device counts as it does all others. An interruption ends the bootstrap, and the
/// chains take a step from what was found; where nothing was, the film is black and has no samples.
/// `pace` limits turns.
RenderRun render_chains(ChainDevice& device, const ChainPlan& plan, const ImageSettings& settings,
                        int samples, const RenderHooks& hooks, Film& film,
                        BatchPace* pace = nullptr);

}  // namespace pt
