// Metropolis light transport as a loop over batches: bootstrap, chains, the image. It knows no mode
// and no device: the paths are traced as all others are (docs/metropolis.md).
#pragma once

#include "common/film/film_data.h"
#include "common/film/markov_chains.h"
#include "common/render/batches.h"

namespace pt {

/// How many chains there are and what they take.
struct ChainPlan {
  std::uint64_t chains = 0;
  std::uint64_t bootstrap = 0;        ///< paths before the chains
  std::uint64_t bootstrap_batch = 0;  ///< of them at once
  std::uint32_t blocks = 0;           ///< of random numbers that each chain stores
  int turn = 1;                       ///< iterations between two looks at the clock

  /// Of the largest batch.
  std::uint64_t batch_paths() const { return std::max(chains, bootstrap_batch); }
};

/// What a device takes where --chains and --bootstrap say nothing.
struct ChainDefaults {
  std::uint64_t chains = std::uint64_t{1} << 13;
  std::uint64_t bootstrap = std::uint64_t{1} << 17;  ///< at least; half of the mutations
  std::uint64_t turn = std::uint64_t{1} << 16;       ///< mutations between two looks at the clock
};

/// Throws Error when the memory cannot hold what the options ask for.
ChainPlan plan_chains(const Options& options, const ChainDefaults& defaults,
                      const FilmMemory& memory);

/// Throws Error when the options ask for what chains cannot do, or the scene has masks.
void check_metropolis(const Options& options, const SceneTraits& traits, const PixelFilter& filter);

/// What the chains added up.
struct ChainSums {
  std::vector<SplatSum> sums;  ///< [pixel of the window][channel]
  ChainTally steps;
  PathTally paths;

  /// Adds what chains have counted: ChainCounts::places of them.
  void add(const ChainCounts* counts);
};

/// What a device does for the chains.
class ChainDevice {
 public:
  virtual ~ChainDevice() = default;

  /// Before the first batch of a render: over which pixels the chains walk. Sums are zero.
  virtual void begin_chains(const ChainWindow& window) = 0;
  /// Of the next batch, one for each of its paths.
  virtual void set_proposals(const std::vector<Proposal>& proposals) = 0;
  /// Traces a path of each chain (ChainStep::Kind::finish: none), and the chain takes this step.
  /// Adds to the run's time.
  virtual void run_chains(std::uint32_t paths, const ChainStep& step, RenderRun& run) = 0;
  /// The same with ChainStep::Kind::mutate until each chain has taken its step number `last` since
  /// its start.
  virtual void mutate_chains(std::uint32_t chains, const ChainStep& step, std::uint32_t last,
                             RenderRun& run) = 0;
  /// Those of the last batch.
  virtual std::vector<Sample> read_chain_samples(std::uint32_t paths) = 0;
  /// And leaves them at zero.
  virtual ChainSums take_chain_sums() = 0;
};

/// The mean target of the bootstrap paths and its standard error, and for each chain the path at
/// which it begins: drawn in proportion to the target, all chains by one number `u` in [0, 1)
/// (systematic resampling). Throws Error where no path found light.
struct ChainStarts {
  double brightness = 0, brightness_error = 0;
  std::vector<std::uint32_t> paths;
};
ChainStarts choose_starts(const std::vector<float>& targets, std::uint64_t chains, double u);

/// Renders `samples` mutations per pixel of the film's window, or more, so that all chains are of
/// the same length. Fills in the film's pixels; adds the bootstrap's paths to its tally.
RenderRun render_chains(ChainDevice& device, const ChainPlan& plan, const Options& options,
                        int samples, const RenderHooks& hooks, Film& film);

}  // namespace pt
