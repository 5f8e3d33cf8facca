// What a wave runs, and in which order: the waves are handed an Executor that only takes notes.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "common/options/option_names.h"
#include "common/sampling/random.h"
#include "wavefront/loop.h"

namespace pt {
namespace {

using MediaScene = Traits<Accel::bvh2, Geometry::mixed, Lighting::full, true, true>;
using TriangleScene = Traits<Accel::cwbvh, Geometry::triangles, Lighting::full>;
using SphereScene = Traits<Accel::brute, Geometry::spheres_and_quads, Lighting::sky>;

template <bool persistent>
class Notes {
 public:
  static constexpr bool streams_shading = persistent;
  template <class Traits>
  static constexpr bool traces_queues = persistent;
  static constexpr bool flies_queues = persistent;

  void compact(const CompactionRequest& request) {
    ran.push_back(StageId::compact);
    for (int c = 0; c < request.queues_wanted; ++c) wanted.push_back(request.wanted[c]);
  }
  void order_surfaces(const SurfaceOrder& how) {
    ran.push_back(StageId::order_surfaces);
    order = how;
  }
  void begin_wave() { ran.push_back(StageId::begin_wave); }
  template <class Stage>
  void run(const Stage& stage, const StageQueues& queues) {
    ran.push_back(id_of(stage));
    queues_of[id_of(stage)] = queues;
    if constexpr (requires { stage.starts_paths; }) starts_paths |= stage.starts_paths;
    inputs.push_back(queues.input);
    if (id_of(stage) == StageId::shade_surface) shaded.push_back(queues);
    if constexpr (requires { Stage::variant; }) variants.push_back(Stage::variant);
    for (const StageId to : Stage::outcomes.to) EXPECT_TRUE(stage_info(to).has_own_queue());
  }
  bool traces_queues_here() const { return here; }
  void trace_queue(const StageQueues&, const SampleBuffer&) {
    traced.push_back(StageId::intersect), note_traced();
  }
  void fly_queue(const StageQueues&, const SampleBuffer&) {
    traced.push_back(StageId::sample_medium), note_traced();
  }
  void trace_shadow_queue(const StageQueues&, const SampleBuffer&) {
    traced.push_back(StageId::shadow), note_traced();
  }

  bool here = true;  ///< the scene is one that they can trace
  std::vector<StageId> ran, traced, wanted;
  std::vector<StageInput> inputs;
  std::map<StageId, StageQueues> queues_of;
  bool starts_paths = false;  ///< a stage that follows paths begins them, too
  SurfaceOrder order;
  std::vector<StageQueues> shaded;
  std::vector<std::string> variants;  ///< of the stages' kernels

 private:
  void note_traced() { ran.push_back(traced.back()); }
};

/// What the waves of these tests have: fewer than any stage asks for, since none runs.
constexpr std::uint32_t few_slots = 3;

template <class Traits, Branching branching, bool persistent>
Notes<persistent> notes_of(const CompactionInfo& strategy, bool reuses_slots = true,
                           bool here = true, bool fused = false, bool starts_paths = true,
                           bool orders = false) {
  WaveCounters counters{};
  std::uint32_t slot_count = 0;
  WaveBuffers buffers;
  buffers.policy.compaction = strategy, buffers.policy.orders_surfaces = orders;
  buffers.counters = &counters;
  buffers.slot_count = &slot_count;
  buffers.reuses_slots = reuses_slots;
  buffers.policy.fused = fused;
  buffers.pool.slot_count = few_slots;
  const StageContext<PhiloxSource> context{{}, {}, {1}, &counters, nullptr, {}, {}};
  Notes<persistent> notes;
  notes.here = here;
  run_wave<Traits, branching>(notes, buffers, context, starts_paths);
  finish_paths<Traits>(notes, buffers, context);
  return notes;
}

/// Likewise of fused stages.
Notes<false> fused_notes(Compaction strategy, bool reuses_slots, bool starts_paths = true) {
  return notes_of<TriangleScene, Branching::divergent, false>(
      compaction_info(strategy), reuses_slots, true, true, starts_paths);
}

using Ids = std::vector<StageId>;

/// Where a wave orders surfaces: the queues and counters that it has.
struct OrderedWave {
  WaveCounters counters{};
  std::uint32_t slot_count = 0, queue[1] = {}, ordered[1] = {};
  Notes<false> notes;

  void run(bool orders) {
    WaveBuffers buffers;
    buffers.policy.compaction = compaction_info(Compaction::atomic);
    buffers.counters = &counters, buffers.slot_count = &slot_count;
    buffers.queues[queue_index(StageId::shade_surface)] = queue;
    buffers.policy.orders_surfaces = orders;
    buffers.ordered = ordered;
    const StageContext<PhiloxSource> context{{}, {}, {1}, &counters, nullptr, {}, {}};
    run_wave<TriangleScene, Branching::divergent>(notes, buffers, context);
  }
};

TEST(WaveOrder, AThreadPerRayTracesAndSendsOn) {
  using enum StageId;
  for (const CompactionInfo& strategy : compaction_table) {
    SCOPED_TRACE(strategy.name);
    for (const bool orders : {false, true}) {
      const auto notes = notes_of<TriangleScene, Branching::divergent, false>(strategy, true, true,
                                                                              false, true, orders);
      Ids expected{compact,    begin_wave,    generate, intersect, compact,
                   shade_miss, shade_surface, compact,  shadow,    finish};
      if (orders) expected.insert(expected.begin() + 6, order_surfaces);
      EXPECT_EQ(notes.ran, expected);
      EXPECT_EQ(notes.wanted, (Ids{generate, intersect, shade_miss, shade_surface, shadow}));
      EXPECT_TRUE(notes.traced.empty());
    }
  }
}

TEST(WaveOrder, PersistentWarpsTraceAndRouteHitsSendsOn) {
  using enum StageId;
  for (const CompactionInfo& strategy : compaction_table) {
    SCOPED_TRACE(strategy.name);
    const auto notes = notes_of<TriangleScene, Branching::divergent, true>(strategy);
    // They need queues that stages append to.
    EXPECT_EQ(notes.traced, strategy.appends ? (Ids{intersect, shadow}) : Ids{});
    EXPECT_EQ(std::ranges::count(notes.ran, route_hits), strategy.appends ? 1 : 0);
    if (!strategy.appends) continue;
    Ids expected{compact,    begin_wave,    generate, intersect, route_hits, compact,
                 shade_miss, shade_surface, compact,  shadow,    finish};
    EXPECT_EQ(notes.ran, expected);
  }
}

TEST(WaveOrder, AThreadPerRayTracesScenesThatPersistentWarpsCannot) {
  const CompactionInfo& strategy = compaction_info(Compaction::atomic);
  const auto notes = notes_of<TriangleScene, Branching::divergent, true>(strategy, true, false);
  EXPECT_TRUE(notes.traced.empty());
  EXPECT_EQ(notes.ran, (notes_of<TriangleScene, Branching::divergent, false>(strategy).ran));
}

// Where they have grids; and a thread per flight can pause it, or write tags.
TEST(WaveOrder, PersistentWarpsTakeFlightsToTheirEnds) {
  using enum StageId;
  for (const CompactionInfo& strategy : compaction_table) {
    SCOPED_TRACE(strategy.name);
    for (const bool has_volumes : {false, true}) {
      for (const std::uint32_t collisions : {to_the_end, 4u}) {
        WaveCounters counters{};
        std::uint32_t slot_count = 0;
        WaveBuffers buffers;
        buffers.policy.compaction = strategy;
        buffers.counters = &counters, buffers.slot_count = &slot_count;
        buffers.policy.has_media = true, buffers.policy.has_volumes = has_volumes;
        buffers.policy.wave_collisions = collisions;
        const StageContext<SamplerSource> context{{}, {}, {}, &counters, nullptr, {}, {}};
        Notes<true> notes;
        notes.here = false;
        run_wave<MediaScene, Branching::divergent>(notes, buffers, context);
        const bool by_warps = strategy.appends && has_volumes && collisions == to_the_end;
        EXPECT_EQ(notes.traced, by_warps ? Ids{sample_medium} : Ids{});
        // By warps, they are routed then.
        EXPECT_EQ(std::ranges::count(notes.ran, sample_medium), by_warps ? 2 : 1);
        EXPECT_EQ(notes.variants, std::vector<std::string>(by_warps ? 1 : 0, "route"));
      }
    }
  }
}

TEST(WaveOrder, ReducedBranchingHasNoStageForMisses) {
  using enum StageId;
  const auto notes =
      notes_of<SphereScene, Branching::reduced, false>(compaction_info(Compaction::atomic));
  EXPECT_EQ(notes.ran,
            (Ids{compact, begin_wave, generate, intersect, compact, shade_surface, finish}));
}

TEST(WaveOrder, FusedStagesTraceAndShadeInOneKernel) {
  using enum StageId;
  for (const Compaction strategy : {Compaction::atomic, Compaction::cub, Compaction::none}) {
    SCOPED_TRACE(to_string(strategy));
    const Notes<false> notes = fused_notes(strategy, true);
    EXPECT_EQ(notes.ran, (Ids{compact, begin_wave, generate, bounce, finish}));
    EXPECT_EQ(notes.wanted, (Ids{generate, intersect}));
    EXPECT_FALSE(notes.starts_paths);
  }
}

// A pool that holds the whole batch: nobody stores the camera rays, and later waves start no path.
TEST(WaveOrder, FusedStagesOfAWholeBatchStartItsPaths) {
  using enum StageId;
  const Notes<false> first = fused_notes(Compaction::atomic, false);
  EXPECT_EQ(first.ran, (Ids{compact, begin_wave, bounce, finish}));
  EXPECT_TRUE(first.starts_paths);
  EXPECT_EQ(first.inputs[0], StageInput::every_slot);
  const Notes<false> later = fused_notes(Compaction::atomic, false, false);
  EXPECT_EQ(later.ran, first.ran);
  EXPECT_FALSE(later.starts_paths);
  EXPECT_EQ(later.inputs[0], StageInput::queue);
}

// Who appends to the queue that it reads needs two halves of it; who writes tags does not.
TEST(WaveOrder, FusedStagesReadOneHalfOfTheQueueAndFillTheOther) {
  const auto bounce_of = [](Compaction strategy) {
    return fused_notes(strategy, true).queues_of.at(StageId::bounce);
  };
  EXPECT_NE(bounce_of(Compaction::atomic).first, nullptr);
  EXPECT_EQ(bounce_of(Compaction::cub).first, nullptr);
  WaveCounters counters{};
  std::uint32_t& rays = counters.waiting[queue_of<StageId::intersect>];
  counters.waiting[queue_of<free_slot>] = 10;
  EXPECT_TRUE(begin_wave(counters, 12, true, 1, 10));
  EXPECT_EQ(counters.first_ray, 0u);
  EXPECT_EQ(counters.intersect, 10u);
  EXPECT_EQ(rays, 10u) << "the second half begins";
  rays += 7, counters.waiting[queue_of<free_slot>] += 3;
  EXPECT_TRUE(begin_wave(counters, 12, true, 1, 10));
  EXPECT_EQ(counters.first_ray, 10u);
  EXPECT_EQ(counters.live, 7u);
  EXPECT_EQ(counters.intersect, 9u);
  EXPECT_EQ(rays, 0u);
  rays = 1;
  for (int again = 0; again < 2; ++again) {  // a wave after the last finds the same
    EXPECT_FALSE(begin_wave(counters, 12, true, 1, 10));
    EXPECT_EQ(counters.first_ray, 0u);
    EXPECT_EQ(counters.finish, 1u);
  }
}

TEST(WaveOrder, TheLastPathsAreSentNowhere) {
  const StageQueues last = fused_notes(Compaction::atomic, true).queues_of.at(StageId::finish);
  for (const std::uint32_t* queue : last.next) EXPECT_EQ(queue, nullptr);
}

TEST(WaveOrder, FusedStagesNeedNoQueuesBetweenThem) {
  WaveBuffers buffers;
  buffers.policy.compaction = compaction_info(Compaction::atomic);
  buffers.pool.slot_count = few_slots;
  const auto places_of = [&](bool fused, bool reuses_slots) {
    buffers.policy.fused = fused, buffers.reuses_slots = reuses_slots;
    buffers.policy.fields.lights = !fused;
    std::uint64_t all = 0;
    buffers.for_each_queue([&](auto*&, std::uint64_t capacity) { all += capacity; });
    return all / few_slots;
  };
  EXPECT_EQ(places_of(false, true), 5u);
  EXPECT_EQ(places_of(false, false), 4u);
  EXPECT_EQ(places_of(true, true), 3u);  // rays twice, free slots
  EXPECT_EQ(places_of(true, false), 2u);
}

TEST(WaveOrder, OneKernelShadesAllOrNothingIsOrdered) {
  OrderedWave sorted, as_they_come;
  sorted.run(true);
  ASSERT_EQ(sorted.notes.shaded.size(), 1u);
  EXPECT_EQ(sorted.notes.shaded[0].slots, sorted.ordered);
  EXPECT_EQ(sorted.notes.shaded[0].count, sorted.notes.order.count);
  EXPECT_EQ(sorted.notes.queues_of[StageId::shade_surface].first, nullptr);
  as_they_come.run(false);
  ASSERT_EQ(as_they_come.notes.shaded.size(), 1u);
  EXPECT_EQ(as_they_come.notes.shaded[0].slots, as_they_come.queue);
  EXPECT_EQ(std::ranges::count(as_they_come.notes.ran, StageId::order_surfaces), 0);
}

/// Notes of a wave in which paths repeat.
Notes<false> repeat_notes(bool fused) {
  WaveCounters counters{};
  WaveBuffers buffers;
  buffers.policy.compaction = compaction_info(Compaction::atomic);
  buffers.counters = &counters;
  buffers.policy.fused = fused;
  const ChainRun chains{};
  const StageContext<SamplerSource> context{{}, {}, {}, &counters, nullptr, {}, {&chains}};
  Notes<false> notes;
  run_wave<TriangleScene, Branching::divergent>(notes, buffers, context);
  return notes;
}

TEST(WaveOrder, RepeatedPathsAreStartedByTheirOwnStage) {
  using enum StageId;
  EXPECT_EQ(repeat_notes(false).ran, (Ids{compact, mutate, compact, begin_wave, intersect, compact,
                                          shade_miss, shade_surface, compact, shadow}));
  EXPECT_EQ(repeat_notes(true).ran, (Ids{compact, mutate, compact, begin_wave, bounce}));
}

TEST(WaveOrder, EveryStageOfAWaveIsReached) {
  std::set<StageId> reached;
  for (const CompactionInfo& strategy : compaction_table) {
    const auto notes = notes_of<TriangleScene, Branching::divergent, true>(strategy);
    reached.insert(notes.ran.begin(), notes.ran.end());
    const auto in_media = notes_of<MediaScene, Branching::divergent, true>(strategy);
    reached.insert(in_media.ran.begin(), in_media.ran.end());
  }
  for (const auto& notes : {fused_notes(Compaction::atomic, true), repeat_notes(false)}) {
    reached.insert(notes.ran.begin(), notes.ran.end());
  }
  for (const StageInfo& stage : stage_table) {
    if (stage.queue == StageId::idle) continue;    // of no wave
    if (stage.id == StageId::hand_over) continue;  // after the last one, on CUDA
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
