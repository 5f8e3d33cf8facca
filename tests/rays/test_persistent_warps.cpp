// Persistent warps, emulated: whatever the rays cost, each is traced once, by itself, and in the
// end no warp has many in reserve.
#include <gtest/gtest.h>

// The emulation comes before what it emulates.
// clang-format off
#include "emulated_gpu.h"
#include "common/accel/trace_cuda/persistent_cwbvh.cuh"
// clang-format on

namespace pt {
namespace {

/// The steps of a ray's traversal; after each third one it tests a leaf.
std::uint32_t cost_of(std::uint32_t ray_id) { return ray_id % 7 == 0 ? 0 : ray_id * 37 % 23; }

struct CountedQuery {
  float first = 0.0f, cost = 0.0f;
  std::uint32_t steps = 0, tests = 0;

  CountedQuery(float t_min, float t_max) : first(t_min), cost(t_max) {}
};

class CountedRays {
 public:
  struct Ray {
    float t_min, t_max;
    std::uint32_t id;
  };
  void store(unsigned lane, const RayRecord& record, std::uint32_t ray_id) {
    rays_[lane] = {record.t_min, record.t_max, ray_id};
  }
  Ray load(unsigned lane) const { return rays_[lane]; }

 private:
  Ray rays_[32];
};

class CountingLane {
 public:
  using Query = CountedQuery;
  using Rays = CountedRays;
  struct Memory {};
  static constexpr bool has_instances = false;
  static constexpr bool is_speculative = false;
  static constexpr int stack_size = 1;

  CountingLane(const TriangleTree&, const SlotOrder&, uint2*, const Memory&) {}

  bool wants_test() const { return tests_next_; }
  bool wants_step() const { return !tests_next_ && left_ > 0; }
  bool is_active() const { return tests_next_ || left_ > 0; }
  const Query& query() const { return query_; }
  void begin(const CountedRays::Ray& ray, const Query& query) {
    EXPECT_FALSE(is_active());
    query_ = query;
    left_ = static_cast<std::uint32_t>(ray.t_max);
  }
  void step() {
    --left_;
    tests_next_ = ++query_.steps % 3 == 0;
  }
  template <class Work>
  void test_leaf(const Work&) {
    ++query_.tests;
    tests_next_ = false;
  }

 private:
  Query query_{0.0f, 0.0f};
  std::uint32_t left_ = 0;
  bool tests_next_ = false;
};

/// The rays that all warps share.
struct SharedRays {
  std::uint32_t count = 0, next = 0;
  std::vector<int> finished;
  int wrong = 0;

  explicit SharedRays(std::uint32_t n) : count(n), finished(n) {}
};

struct CountedWork {
  SharedRays& rays;

  std::uint32_t fetch(unsigned lane, ReservedRays& reserved, RayRecord& record, int& count) const {
    const std::uint32_t first = reserve_rays(&rays.next, rays.count, lane, reserved, count);
    const std::uint32_t ray_id = first + lane;
    record.t_min = static_cast<float>(ray_id);
    record.t_max = static_cast<float>(cost_of(ray_id));
    return first;
  }

  void finish(std::uint32_t ray_id, const CountedQuery& query) const {
    const std::uint32_t cost = cost_of(ray_id);
    const bool is_right =
        query.first == static_cast<float>(ray_id) && query.steps == cost && query.tests == cost / 3;
    if (!is_right || ray_id >= rays.count) ++rays.wrong;
    if (ray_id < rays.count) ++rays.finished[ray_id];
  }
};

template <int warps>
void trace(SharedRays& rays) {
  const TriangleTree tree;
  const auto memory = std::make_unique<PersistentMemory<CountingLane, 32 * warps>>();
  EmulatedBlock(32 * warps).run([&] {
    CountedWork work{rays};
    trace_persistent<CountingLane>(tree, *memory, work);
  });
}

template <int warps>
void expect_each_once(std::uint32_t count) {
  SharedRays rays(count);
  trace<warps>(rays);
  EXPECT_EQ(rays.wrong, 0) << count;
  for (std::uint32_t i = 0; i < count; ++i) EXPECT_EQ(rays.finished[i], 1) << i << " of " << count;
}

TEST(PersistentWarps, TraceEachRayOnce) {
  for (const std::uint32_t count : {0u, 1u, 31u, 32u, 33u, 300u}) {
    expect_each_once<1>(count);
    expect_each_once<3>(count);
  }
}

// By several warps at once, and many at a time: without a traversal, which emulated would take
// long.
TEST(PersistentWarps, ReserveEachRayOnce) {
  for (const std::uint32_t count : {0u, 1u, 33u, 5000u}) {
    SharedRays rays(count);
    ReservedRays reserved[3] = {};
    EmulatedBlock(96).run([&] {
      const unsigned lane = threadIdx.x % 32;
      for (int got = 1; got > 0;) {
        const std::uint32_t first =
            reserve_rays(&rays.next, rays.count, lane, reserved[threadIdx.x / 32], got);
        if (static_cast<int>(lane) < got) ++rays.finished.at(first + lane);
        __syncwarp();
      }
    });
    for (std::uint32_t i = 0; i < count; ++i)
      EXPECT_EQ(rays.finished[i], 1) << i << " of " << count;
  }
}

TEST(PersistentWarps, ReserveManyAtFirstAndFewInTheEnd) {
  for (const std::uint32_t warps : {4u, 96u, 4224u}) {
    for (std::uint32_t left = 0; left < 30'000'000; left = left * 5 / 4 + 1) {
      const std::uint32_t batch = reserved_batch(left, 32 * warps);
      EXPECT_EQ(batch % 32, 0u);
      EXPECT_GE(batch, 32u);
      EXPECT_LE(batch, 512u);
      // No warp takes more than an eighth of its share, and none could take 32 more.
      if (batch > 32) {
        EXPECT_LE(std::uint64_t{batch} * 8 * warps, left);
      }
      if (batch < 512) {
        EXPECT_GT(std::uint64_t{batch + 32} * 8 * warps, left);
      }
    }
  }
}

}  // namespace
}  // namespace pt
