// The compaction strategies by themselves, as `ptexp compact` measures them: slots of which some
// wait, a pass over their tags, and how long it takes beside a copy that moves as many bytes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "wavefront/compaction/compaction.h"

namespace pt {

struct CompactionCase {
  std::uint32_t items = 1;       ///< slots, 1..2^30
  float density = 0.5f;          ///< probability that a slot waits, 0..1
  std::uint32_t run_length = 1;  ///< so many neighbours wait for the same stage or for none
  int queues = 1;                ///< 1 or 2, among which the waiting slots are shared
};

inline constexpr int measured_queues_max = 2;
/// Whose queues are filled; all other slots are free.
inline constexpr StageId measured_stages[measured_queues_max] = {StageId::shade_surface,
                                                                 StageId::shade_miss};

/// A tag for each slot; the same for the same case.
std::vector<StageId> make_tags(const CompactionCase& c);

/// How many slots wait in any of the queues.
std::uint64_t count_waiting(const std::vector<StageId>& tags);

/// The bytes that a pass cannot but move: it reads a tag of one byte for each slot and, where it
/// gathers, writes a number of four bytes for each that waits.
std::uint64_t moved_bytes(Compaction strategy, std::uint64_t slots, std::uint64_t waiting);

/// What one pass has left.
struct CompactionResult {
  static constexpr std::uint32_t unwritten = 0xffffffffu;

  std::vector<std::uint32_t> counts;               ///< by queue
  std::vector<std::vector<std::uint32_t>> queues;  ///< [slots] each, `unwritten` before the pass
};

/// In which way the result breaks the contract of compaction.h, for the first of measured_stages;
/// empty: in none.
std::string contract_breach(Compaction strategy, const std::vector<StageId>& tags,
                            const CompactionResult& result);

struct MeasuredRuns {
  int warmup = 0;    ///< not measured
  int repeat = 1;    ///< >= 1
  bool cold = true;  ///< passes take memory in turn that no cache holds
};

/// What one measured time is made of: a pass alone would be too short for a clock.
struct PassPlan {
  std::uint32_t passes = 1;  ///< back to back
  std::uint32_t sets = 1;    ///< of memory, which they take in turn
};

/// Passes of so many items each that make `items_per_time` together, but at most 256.
std::uint32_t count_passes(std::uint64_t items_per_time, std::uint64_t items);

/// Sets of memory that have `cold_bytes` together where a pass moves `bytes` of each; at most 4096,
/// for with short passes memory does not count.
std::uint32_t count_sets(std::uint64_t cold_bytes, std::uint64_t bytes);

enum class CopyWay {
  memcpy,  ///< the library's
  kernel,  ///< 16 bytes a thread
};

/// Where passes run. Its functions throw Error where memory does not suffice.
class CompactionDevice {
 public:
  virtual ~CompactionDevice() = default;

  virtual std::vector<CopyWay> copy_ways() const = 0;
  /// For passes that each move so many bytes of so many items.
  virtual PassPlan plan(std::uint64_t items, std::uint64_t bytes, bool cold) const = 0;
  virtual int threads() const = 0;  ///< of the CPU; 0 on CUDA

  /// One pass. `strategy`: none that orders surfaces.
  virtual CompactionResult compact(Compaction strategy, const std::vector<StageId>& tags,
                                   int queues) = 0;
  /// Milliseconds of a pass, for each repeat.
  virtual std::vector<double> time_compaction(Compaction strategy, const std::vector<StageId>& tags,
                                              int queues, const PassPlan& plan,
                                              const MeasuredRuns& runs) = 0;
  /// Likewise, of a copy that reads `bytes` / 2 and writes as many.
  virtual std::vector<double> time_copy(CopyWay way, std::uint64_t bytes, const PassPlan& plan,
                                        const MeasuredRuns& runs) = 0;
};

/// On the calling thread's oneTBB arena; wall times.
std::unique_ptr<CompactionDevice> make_compaction_cpu();

/// On the CUDA device `index`; only in a build with CUDA. The passes of a time are one CUDA graph,
/// so that the host's launches do not count; times between two events.
std::unique_ptr<CompactionDevice> make_compaction_cuda(int index, int sms = 0);

}  // namespace pt
