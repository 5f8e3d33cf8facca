// The path pool in all layouts: what is stored in a slot is what is loaded from it, and its size
// is what it says.
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "wavefront/pool/path_pool.h"

namespace pt {
namespace {

using Fields = PathPool::Fields;

/// All combinations, in this layout.
std::vector<Fields> all_fields(PoolLayout layout) {
  std::vector<Fields> all;
  for (int bits = 0; bits < 16; ++bits) {
    all.push_back({(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, (bits & 8) != 0, layout});
    constexpr std::uint32_t records[] = {0, 1, 5, 16};
    all.back().extra_records = records[bits / 2 % 4];
  }
  return all;
}

/// A pool whose memory is exactly as large as asked for, so that sanitizers see what leaves it.
class PoolMemory {
 public:
  PathPool allocate(const Fields& fields, std::uint32_t slot_count) {
    PathPool pool;
    pool.slot_count = slot_count;
    pool.allocate_arrays(fields, [this]<class T>(T*, std::uint64_t count) {
      size_bytes += count * sizeof(T);
      memory_.emplace_back(std::aligned_alloc(16, (count * sizeof(T) + 15) / 16 * 16), std::free);
      return static_cast<T*>(memory_.back().get());
    });
    return pool;
  }

  std::uint64_t size_bytes = 0;

 private:
  std::vector<std::unique_ptr<void, void (*)(void*)>> memory_;
};

/// Numbers that differ from slot to slot and from field to field.
Vec3 vector_of(std::uint32_t slot, int field) {
  const auto s = static_cast<float>(slot), f = static_cast<float>(field);
  return {s + f / 16, -s - f / 16, 1000 * f + s};
}

PathState path_of(std::uint32_t slot) {
  PathState path;
  path.index = 7 * slot;
  path.beta = vector_of(slot, 1);
  path.rays = static_cast<std::uint16_t>(slot + 1);
  path.shadow_rays = static_cast<std::uint16_t>(slot / 2);
  path.bsdf_pdf = static_cast<float>(slot) + 0.25f;
  path.receiver = {slot * 3 + 1};
  return path;
}

void store(const PathPool& pool, const Fields& fields, std::uint32_t slot) {
  const PathState path = path_of(slot);
  pool.store_path(slot, {vector_of(slot, 2), vector_of(slot, 3)}, path);
  pool.store_hit(slot, {static_cast<float>(slot) / 2, slot + 100, slot + 200});
  if (fields.lights) {
    const Ray ray{vector_of(slot, 4), vector_of(slot, 5)};
    const ShadowRay shadow{ray, static_cast<float>(slot) + 0.5f, vector_of(slot, 6)};
    pool.store_shadow_ray(slot, shadow, path);
    pool.store_shadow_radiance(slot, shadow.radiance, path);
  }
  pool.extra.begin(slot, path.index);
  for (std::uint32_t ray = 1; ray < path.rays; ++ray) pool.extra.step(slot);
  if (fields.tags) pool.tag[slot] = static_cast<StageId>(slot % 5);
  if (fields.tags && fields.lights) pool.shadow_tag[slot] = static_cast<StageId>(slot % 3);
}

void expect_stored(const PathPool& pool, const Fields& fields, std::uint32_t slot) {
  const PathState expected = path_of(slot);
  Ray ray;
  const PathState path = pool.load_path(slot, ray);
  EXPECT_EQ(ray.origin, vector_of(slot, 2));
  EXPECT_EQ(ray.direction, vector_of(slot, 3));
  EXPECT_EQ(path.index, expected.index);
  EXPECT_EQ(path.beta, expected.beta);
  EXPECT_EQ(path.rays, expected.rays);
  EXPECT_EQ(path.shadow_rays, expected.shadow_rays);
  EXPECT_EQ(path.bsdf_pdf, expected.bsdf_pdf);
  if (fields.receivers) {
    EXPECT_EQ(path.receiver.bits, expected.receiver.bits);
  }
  EXPECT_EQ(pool.extra.count, fields.extra_records);
  EXPECT_TRUE(pool.extra.is_whole(slot, expected));
  const Hit hit = pool.load_hit(slot);
  EXPECT_EQ(hit.t, static_cast<float>(slot) / 2);
  EXPECT_EQ(hit.primitive, slot + 100);
  EXPECT_EQ(hit.instance, fields.instances ? slot + 200 : 0);
  if (fields.lights) {
    std::uint32_t path_index = 0;
    const ShadowRay shadow = pool.load_shadow(slot, path_index);
    EXPECT_EQ(path_index, expected.index);
    EXPECT_EQ(shadow.ray.origin, vector_of(slot, 4));
    EXPECT_EQ(shadow.ray.direction, vector_of(slot, 5));
    EXPECT_EQ(shadow.distance, static_cast<float>(slot) + 0.5f);
    EXPECT_EQ(shadow.radiance, vector_of(slot, 6));
    EXPECT_EQ(pool.load_shadow_rays(slot), expected.rays);
  }
  if (fields.tags) {
    EXPECT_EQ(pool.tag[slot], static_cast<StageId>(slot % 5));
  }
  if (fields.tags && fields.lights) {
    EXPECT_EQ(pool.shadow_tag[slot], static_cast<StageId>(slot % 3));
  }
}

std::string name_of(PoolLayout layout) {
  return layout == PoolLayout::soa ? "soa" : layout == PoolLayout::sectors ? "sectors" : "aos";
}

class PathPoolOf : public testing::TestWithParam<PoolLayout> {};
INSTANTIATE_TEST_SUITE_P(Layouts, PathPoolOf,
                         testing::Values(PoolLayout::soa, PoolLayout::sectors, PoolLayout::aos),
                         [](const auto& layout) { return name_of(layout.param); });

TEST_P(PathPoolOf, KeepsWhatEachSlotHas) {
  constexpr std::uint32_t slot_count = 37;
  for (const Fields& fields : all_fields(GetParam())) {
    SCOPED_TRACE(testing::Message()
                 << "lights " << fields.lights << ", instances " << fields.instances << ", tags "
                 << fields.tags << ", receivers " << fields.receivers);
    PoolMemory memory;
    const PathPool pool = memory.allocate(fields, slot_count);
    for (std::uint32_t slot = 0; slot < slot_count; ++slot) store(pool, fields, slot);
    for (std::uint32_t slot = 0; slot < slot_count; ++slot) expect_stored(pool, fields, slot);
    EXPECT_EQ(memory.size_bytes, slot_count * PathPool::bytes_per_slot(fields));
    if (HasFailure()) return;
  }
}

// A record is read by one access of 16 bytes, which must not be apart.
TEST_P(PathPoolOf, EveryRecordIsAligned) {
  for (const Fields& fields : all_fields(GetParam())) {
    PoolMemory memory;
    const PathPool pool = memory.allocate(fields, 3);
    for (std::uint32_t slot = 0; slot < 3; ++slot) {
      const auto expect_aligned = [&](auto* field) {
        if (field == nullptr) return;
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(pool.at(field, slot)) % alignof(*field), 0u);
      };
      expect_aligned(pool.origin), expect_aligned(pool.direction), expect_aligned(pool.throughput);
      expect_aligned(pool.hit), expect_aligned(pool.hit_instance), expect_aligned(pool.receiver);
      expect_aligned(pool.shadow_origin), expect_aligned(pool.shadow_direction);
      expect_aligned(pool.shadow_radiance);
    }
  }
}

// Two records of a path share a sector, as the halves of a ray do.
TEST_P(PathPoolOf, ExtraRecordsLieAsTheOthers) {
  for (const std::uint32_t records : {1u, 6u, 15u}) {
    Fields fields{true, false, false, false, GetParam()};
    fields.extra_records = records;
    PoolMemory memory;
    const PathPool pool = memory.allocate(fields, 5);
    const std::ptrdiff_t in_row = GetParam() == PoolLayout::soa       ? 1
                                  : GetParam() == PoolLayout::sectors ? 2
                                                                      : 16;
    for (std::uint32_t k = 1; k < records; ++k) {
      const bool is_next = pool.extra.at(3, k) - pool.extra.at(3, k - 1) == 1;
      EXPECT_EQ(is_next, k % in_row != 0) << k;
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(pool.extra.at(3, k)) % 16, 0u);
    }
    Fields none = fields;
    none.extra_records = 0;
    const std::uint32_t whole = GetParam() == PoolLayout::sectors ? (records + 1) / 2 * 2 : records;
    EXPECT_EQ(PathPool::bytes_per_slot(fields), PathPool::bytes_per_slot(none) + 16 * whole);
  }
}

// As the table in docs/design/wavefront.md has it.
TEST(PathPool, SizesInBytes) {
  const auto bytes = [](Fields fields, PoolLayout layout) {
    fields.layout = layout;
    return PathPool::bytes_per_slot(fields);
  };
  const auto no_hits = [](bool instances, bool receivers) {  // of fused stages
    Fields fields{false, instances, false, receivers};
    fields.hits = false;
    return fields;
  };
  const struct {
    Fields fields;
    std::uint64_t soa, aos;
  } cases[] = {{{false, false, false, false}, 56, 64},
               {{false, true, false, true}, 64, 64},
               {{true, false, false, false}, 104, 112},
               {{true, true, false, true}, 112, 112},
               {{false, false, true, false}, 57, 65},
               {{true, true, true, true}, 114, 114},
               {no_hits(false, false), 48, 48},
               {no_hits(true, false), 48, 48},
               {no_hits(true, true), 52, 64}};
  for (const auto& [fields, soa, aos] : cases) {
    EXPECT_EQ(bytes(fields, PoolLayout::soa), soa);
    EXPECT_EQ(bytes(fields, PoolLayout::sectors), soa);
    EXPECT_EQ(bytes(fields, PoolLayout::aos), aos);
  }
}

// More than 4 GiB: no memory is touched.
TEST_P(PathPoolOf, TheLastSlotOfALargePoolIsFarAway) {
  const Fields fields{true, false, false, false, GetParam()};
  PoolMemory memory;
  const PathPool pool = memory.allocate(fields, 1);
  const auto place = [](const void* p) { return reinterpret_cast<std::uintptr_t>(p); };
  const bool aos = GetParam() == PoolLayout::aos;
  const std::uint64_t of_ray = aos ? 112 : GetParam() == PoolLayout::sectors ? 32 : 16;
  EXPECT_EQ(place(pool.half_at(pool.shadow_origin, 0x7fffffffu)) - place(pool.shadow_origin),
            0x7fffffffu * of_ray);
  EXPECT_EQ(place(pool.at(pool.throughput, 0x7fffffffu)) - place(pool.throughput),
            0x7fffffffu * (aos ? 112ull : 16ull));
}

TEST(PathPool, SectorsHoldWholeRays) {
  PoolMemory memory;
  const PathPool pool = memory.allocate({true, false, false, false, PoolLayout::sectors}, 9);
  for (std::uint32_t slot = 0; slot < 9; ++slot) {
    EXPECT_EQ(pool.half_at(pool.origin, slot) + 1, pool.half_at(pool.direction, slot));
    EXPECT_EQ(pool.half_at(pool.shadow_origin, slot) + 1,
              pool.half_at(pool.shadow_direction, slot));
  }
}

}  // namespace
}  // namespace pt
