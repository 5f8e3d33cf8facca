// What stages have to move, against the records by hand and against what the stages write.
#include <gtest/gtest.h>

#include <cstring>
#include <set>

#include "common/scene/prepare/prepare_scene.h"
#include "make_render.h"
#include "wavefront/pool/stage_bytes.h"
#include "wavefront/run_stage_cpu.h"

namespace pt {
namespace {

/// The defaults on CUDA: queues that are appended to, the whole batch in the pool.
WaveLayout usual(bool lights = true) {
  WaveLayout layout;
  layout.fields = {lights, false, false, false};
  layout.slots = 1000;
  return layout;
}

void expect_bytes(const PredictedBytes& found, double read, double written) {
  EXPECT_DOUBLE_EQ(found.read, read);
  EXPECT_DOUBLE_EQ(found.written, written);
}

// The first wave of 100 paths: all are new; 60 meet a surface, where 50 ask a light and 40 go on.
WaveFlow first_wave() {
  WaveFlow flow;
  flow.generated = flow.rays = 100;
  flow.misses = 40, flow.surfaces = 60, flow.shadows = 50, flow.continued = 40;
  return flow;
}

TEST(StageBytes, FirstWaveByHand) {
  const auto predict = [](const char* kernel) {
    return predict_bytes(kernel, first_wave(), usual());
  };
  // Writes origin and direction, its place in the queue, and a sample of 16 bytes.
  expect_bytes(predict("generate"), 0, 100 * (16 + 16 + 4 + 16));
  // Reads its place and the ray; hits have 8 bytes; all are sent on.
  expect_bytes(predict("intersect"), 100 * (4 + 32), 60 * 8 + 100 * 4);
  // Reads its place, the direction, and what lights have added.
  expect_bytes(predict("shade_miss"), 40 * (4 + 16 + 12), 40 * 16);
  // 20 paths end; 40 are stored and queued; shadow rays have three records and a place.
  expect_bytes(predict("shade_surface"), 60 * (4 + 32 + 8) + 20 * 12,
               40 * (48 + 4) + 20 * 16 + 50 * (48 + 4));
  expect_bytes(predict("shadow"), 50 * (4 + 48 + 12), 50 * 12);
  expect_bytes(predict("begin_wave"), 0, 0);
  expect_bytes(predict("accumulate"), 0, 0);
  expect_bytes(predict("megakernel"), 0, 0);
}

// Begun with the path, loaded for each ray, and stored where the path goes on.
TEST(StageBytes, ExtraRecords) {
  WaveLayout more = usual();
  more.fields.extra_records = 4;
  const auto expect_more = [&](const char* kernel, double read, double written) {
    const PredictedBytes without = predict_bytes(kernel, first_wave(), usual());
    expect_bytes(predict_bytes(kernel, first_wave(), more), without.read + read,
                 without.written + written);
  };
  expect_more("generate", 0, 100 * 64);
  expect_more("intersect", 0, 0);
  expect_more("shade_miss", 40 * 64, 0);
  expect_more("shade_surface", 60 * 64, 40 * 64);
  expect_more("shadow", 0, 0);
}

TEST(StageBytes, OldPathsHaveAThroughput) {
  WaveFlow flow = first_wave();
  flow.generated = 25;
  expect_bytes(predict_bytes("shade_miss", flow, usual(false)), 40 * (4 + 16 + 0.75 * 16), 40 * 16);
}

TEST(StageBytes, WhatAScenesKindAdds) {
  WaveLayout layout = usual();
  layout.fields.instances = layout.fields.receivers = layout.all_lights = true;
  layout.queues_free = true;
  const auto predict = [&](const char* kernel) {
    return predict_bytes(kernel, first_wave(), layout);
  };
  expect_bytes(predict("generate"), 100 * 4, 100 * (16 + 16 + 4 + 16));
  expect_bytes(predict("intersect"), 100 * (4 + 32), 60 * (8 + 4) + 100 * 4);
  expect_bytes(predict("shade_miss"), 40 * (4 + 32 + 12), 40 * (16 + 4));
  expect_bytes(predict("shade_surface"), 60 * (4 + 32 + 12 + 4) + 20 * 12,
               40 * (48 + 4 + 4) + 20 * (16 + 4) + 50 * (48 + 4));
}

TEST(StageBytes, HalfARayIsASectorWhereBothShareOne) {
  WaveLayout layout = usual();
  layout.fields.layout = PoolLayout::sectors;
  expect_bytes(predict_bytes("shade_miss", first_wave(), layout), 40 * (4 + 32 + 12), 40 * 16);
}

TEST(StageBytes, TagsInsteadOfQueues) {
  WaveLayout layout = usual(false);
  layout.has_queues = layout.appends = false;
  layout.fields.tags = true;
  const auto predict = [&](const char* kernel) {
    return predict_bytes(kernel, first_wave(), layout);
  };
  expect_bytes(predict("generate"), 1000, 100 * (16 + 16 + 1));
  expect_bytes(predict("intersect"), 1000 + 100 * 32, 60 * 8 + 100);
  expect_bytes(predict("shade_miss"), 1000 + 40 * 16, 40 * (16 + 1));
}

TEST(StageBytes, PersistentWarpsStoreAllHits) {
  WaveLayout layout = usual();
  layout.persistent = true;
  expect_bytes(predict_bytes("intersect", first_wave(), layout), 100 * 36, 100 * 8);
  expect_bytes(predict_bytes("route_hits", first_wave(), layout), 100 * 12, 100 * 4);
}

TEST(StageBytes, OrdersOfSurfacesReadTheHits) {
  const auto predict = [](const char* kernel) {
    return predict_bytes(kernel, first_wave(), usual());
  };
  expect_bytes(predict("order_tiles"), 60 * (4 + 8), 60 * 4);
}

TEST(StageBytes, FusedStagesStoreWhatGoesOn) {
  WaveLayout layout = usual();
  layout.fused = true;
  WaveFlow flow = first_wave();
  flow.misses = flow.surfaces = flow.shadows = 0;  // nobody waits there
  // A pool of the whole batch: 40 paths go on, with their sample so far; 60 end.
  expect_bytes(predict_bytes("bounce", flow, layout), 0, 40 * (48 + 16 + 4) + 60 * 16);
  layout.queues_free = true;  // generate has stored the new ones, which are all
  expect_bytes(predict_bytes("bounce", flow, layout), 100 * (4 + 32 + 12),
               40 * (48 + 16 + 4) + 60 * (16 + 4));
  layout.queues_free = false;
  flow.generated = 0;  // a later wave, without lights
  layout.fields.lights = false;
  expect_bytes(predict_bytes("bounce", flow, layout), 100 * (4 + 48), 40 * (48 + 4) + 60 * 16);
  layout.appends = false;  // all tags are read, and each path's is written
  expect_bytes(predict_bytes("bounce", flow, layout), 100 * (4 + 48),
               40 * (48 + 1) + 60 * (16 + 1));
}

TEST(StageBytes, LastPathsAreReadOnceAndEnd) {
  WaveFlow flow;
  flow.finished = 10;
  expect_bytes(predict_bytes("finish", flow, usual()), 10 * (4 + 48 + 12), 10 * 16);
}

TEST(StageBytes, FlowIsWhatTheCountersSay) {
  WaveCounters counters{};
  counters.generate = 3, counters.intersect = 8, counters.finish = 2, counters.live = 5;
  counters.waiting[queue_of<StageId::shade_miss>] = 1;
  counters.waiting[queue_of<StageId::shade_surface>] = 7;
  counters.waiting[queue_of<StageId::shadow>] = 4;
  const WaveFlow flow = flow_of(counters);
  EXPECT_EQ(flow.generated, 3);
  EXPECT_EQ(flow.rays, 8);
  EXPECT_EQ(flow.misses, 1);
  EXPECT_EQ(flow.surfaces, 7);
  EXPECT_EQ(flow.shadows, 4);
  EXPECT_EQ(flow.finished, 2);
}

/// A pool in one block of memory, filled with a pattern that no stage writes.
class MarkedPool {
 public:
  static constexpr unsigned char mark = 0xa5;

  MarkedPool(std::uint32_t slots, const PathPool::Fields& fields) {
    pool.slot_count = slots;
    pool.allocate_arrays(fields, [&]<class T>(T*, std::uint64_t count) {
      blocks_.emplace_back(count * sizeof(T) / sizeof(PathRecord) + 1);
      std::memset(blocks_.back().data(), mark, blocks_.back().size() * sizeof(PathRecord));
      return reinterpret_cast<T*>(blocks_.back().data());
    });
  }

  /// Bytes of records of which something was written.
  std::size_t written_bytes() const {
    PathRecord unused;
    std::memset(&unused, mark, sizeof unused);
    std::size_t bytes = 0;
    for (const std::vector<PathRecord>& block : blocks_) {
      for (const PathRecord& r : block)
        bytes += std::memcmp(&r, &unused, sizeof r) != 0 ? sizeof r : 0;
    }
    return bytes;
  }

  PathPool pool;

 private:
  std::vector<std::vector<PathRecord>> blocks_;
};

// The stage itself writes what is predicted, but for queue and sample.
TEST(StageBytes, GenerateWritesThePredictedRecords) {
  Options options;
  options.scene = "cornell";
  options.width = 8, options.height = 4, options.spp = 1;
  const SceneData data = make_scene_for(options, choose_device({DeviceChoice::Kind::cpu, 0}));
  const Scene scene = host_view(data, options.width, options.height);
  constexpr std::uint32_t n = 32;
  for (const std::uint32_t extra_records : {0u, 4u}) {
    PathPool::Fields fields = {true, false, false, false};
    fields.extra_records = extra_records;
    const MarkedPool marked(n, fields);
    std::vector<Sample> samples(n);
    std::vector<std::uint32_t> queue(n);
    WaveCounters counters{};
    counters.generate = counters.intersect = n;
    const SampleBuffer buffer(samples.data(), Window{0, 0, 8, 4}, 0, 1);
    const GeneratePaths<PhiloxSource> stage{
        {marked.pool, buffer, PhiloxSource{1}, &counters, queue.data(), {}, {}}, true};
    for (std::uint32_t slot = 0; slot < n; ++slot) stage(scene, slot, slot);
    WaveFlow flow;
    flow.generated = flow.rays = n;
    WaveLayout layout;
    layout.fields = fields;
    const double beside = n * (sizeof(Sample) + sizeof(std::uint32_t));
    EXPECT_EQ(static_cast<double>(marked.written_bytes()) + beside,
              predict_bytes("generate", flow, layout).written);
  }
}

}  // namespace
}  // namespace pt
