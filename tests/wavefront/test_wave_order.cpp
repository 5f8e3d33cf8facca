// What a wave runs, and in which order: the waves are handed an Executor that only takes notes.
#include <gtest/gtest.h>

#include <set>

#include "common/render/option_names.h"
#include "common/sampling/random.h"
#include "wavefront/wavefront.h"

namespace pt {
namespace {

using TriangleScene = Traits<Accel::cwbvh, Geometry::triangles, Lighting::full>;
using SphereScene = Traits<Accel::brute, Geometry::spheres_and_quads, Lighting::sky>;

template <bool persistent>
class Notes {
 public:
  template <class Traits>
  static constexpr bool traces_queues = persistent;

  void compact(const CompactionRequest& request) {
    ran.push_back(StageId::compact);
    for (int c = 0; c < request.queues_wanted; ++c) wanted.push_back(request.wanted[c]);
  }
  void begin_wave() { ran.push_back(StageId::begin_wave); }
  template <class Stage>
  void run(const Stage&, const StageQueues& queues) {
    ran.push_back(Stage::id);
    inputs.push_back(queues.input);
    for (const StageId to : Stage::outcomes.to) EXPECT_TRUE(stage_info(to).has_own_queue());
  }
  bool traces_queues_here() const { return here; }
  void trace_queue(const StageQueues&, const SampleBuffer&) {
    traced.push_back(StageId::intersect), note_traced();
  }
  void trace_shadow_queue(const StageQueues&, const SampleBuffer&) {
    traced.push_back(StageId::shadow), note_traced();
  }

  bool here = true;  ///< the scene is one that they can trace
  std::vector<StageId> ran, traced, wanted;
  std::vector<StageInput> inputs;

 private:
  void note_traced() { ran.push_back(traced.back()); }
};

template <class Traits, Branching branching, bool persistent>
Notes<persistent> notes_of(const CompactionInfo& strategy, bool reuses_slots = true,
                           bool here = true) {
  WaveCounters counters{};
  std::uint32_t slot_count = 0;
  WaveBuffers buffers;
  buffers.compaction = strategy;
  buffers.counters = &counters;
  buffers.slot_count = &slot_count;
  buffers.reuses_slots = reuses_slots;
  const StageContext<PhiloxSource> context{{}, {}, {1}, &counters, nullptr, {}};
  Notes<persistent> notes;
  notes.here = here;
  run_wave<Traits, branching>(notes, buffers, context);
  run_finish<Traits>(notes, buffers, context);
  return notes;
}

using Ids = std::vector<StageId>;

TEST(WaveOrder, AThreadPerRayTracesAndSendsOn) {
  using enum StageId;
  for (const CompactionInfo& strategy : compaction_table) {
    SCOPED_TRACE(strategy.name);
    const auto notes = notes_of<TriangleScene, Branching::divergent, false>(strategy);
    EXPECT_EQ(notes.ran, (Ids{compact, begin_wave, generate, intersect, compact, shade_miss,
                              shade_surface, compact, shadow, finish}));
    EXPECT_EQ(notes.wanted, (Ids{generate, intersect, shade_miss, shade_surface, shadow}));
    EXPECT_TRUE(notes.traced.empty());
  }
}

TEST(WaveOrder, PersistentWarpsTraceAndSortHitsSendsOn) {
  using enum StageId;
  for (const CompactionInfo& strategy : compaction_table) {
    SCOPED_TRACE(strategy.name);
    const auto notes = notes_of<TriangleScene, Branching::divergent, true>(strategy);
    // They need queues that stages append to.
    EXPECT_EQ(notes.traced, strategy.appends ? (Ids{intersect, shadow}) : Ids{});
    EXPECT_EQ(std::ranges::count(notes.ran, sort_hits), strategy.appends ? 1 : 0);
    if (!strategy.appends) continue;
    EXPECT_EQ(notes.ran, (Ids{compact, begin_wave, generate, intersect, sort_hits, compact,
                              shade_miss, shade_surface, compact, shadow, finish}));
  }
}

TEST(WaveOrder, AThreadPerRayTracesScenesThatPersistentWarpsCannot) {
  const CompactionInfo& strategy = compaction_info(Compaction::atomic);
  const auto notes = notes_of<TriangleScene, Branching::divergent, true>(strategy, true, false);
  EXPECT_TRUE(notes.traced.empty());
  EXPECT_EQ(notes.ran, (notes_of<TriangleScene, Branching::divergent, false>(strategy).ran));
}

TEST(WaveOrder, ReducedBranchingHasNoStageForMisses) {
  using enum StageId;
  const auto notes =
      notes_of<SphereScene, Branching::reduced, false>(compaction_info(Compaction::atomic));
  EXPECT_EQ(notes.ran,
            (Ids{compact, begin_wave, generate, intersect, compact, shade_surface, finish}));
}

TEST(WaveOrder, EveryStageOfAWaveIsReached) {
  std::set<StageId> reached;
  for (const CompactionInfo& strategy : compaction_table) {
    const auto notes = notes_of<TriangleScene, Branching::divergent, true>(strategy);
    reached.insert(notes.ran.begin(), notes.ran.end());
  }
  for (const StageInfo& stage : stage_table) {
    if (stage.queue == StageId::idle) continue;  // of no wave
    EXPECT_TRUE(reached.contains(stage.id)) << stage.name;
  }
}

TEST(WaveOrder, AStageFindsItsSlotsAsTheStrategySays) {
  for (const CompactionInfo& strategy : compaction_table) {
    SCOPED_TRACE(strategy.name);
    for (const bool reuses_slots : {true, false}) {
      const auto notes =
          notes_of<TriangleScene, Branching::divergent, false>(strategy, reuses_slots);
      const StageInput usual = strategy.has_queues ? StageInput::queue : StageInput::tags;
      std::vector<StageInput> expected(notes.inputs.size(), usual);
      // A pool that holds the whole batch has no queue of free slots.
      if (strategy.has_queues && !reuses_slots) expected[0] = StageInput::every_slot;
      EXPECT_EQ(notes.inputs, expected);
    }
  }
}

}  // namespace
}  // namespace pt
