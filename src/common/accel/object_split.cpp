#include "common/accel/object_split.h"

#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>

#include "common/accel/parallel_partition.h"

namespace pt {

namespace {

constexpr int bins_max = 32;
constexpr std::uint32_t serial_max = 1 << 16;  // more references than this are shared by threads
constexpr std::uint32_t serial_block = 1 << 13;

int bin_count_for(std::uint32_t size) { return size < 32 ? 8 : size < 1024 ? 16 : bins_max; }

struct Bin : Box4 {
  std::uint32_t count = 0;
  void add(const BuildReference& r) { grow(r), ++count; }
  void add(const Bin& b) { grow(b), count += b.count; }
};

struct Bins {
  explicit Bins(int count) { clear(count); }
  void clear(int count) {
    for (auto& axis : of) std::fill_n(axis.begin(), count, Bin());
  }
  void add(const Bins& other, int count) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int b = 0; b < count; ++b) of[axis][b].add(other.of[axis][b]);
    }
  }
  std::array<std::array<Bin, bins_max>, 3> of;
};

void fill_bins(std::span<const BuildReference> references, const BinMapping& mapping, Bins& bins) {
  for (const BuildReference& r : references) {
    const Int4 bin = mapping(r.twice_center());
    for (int axis = 0; axis < 3; ++axis) bins.of[axis][bin[axis]].add(r);
  }
}

// Minima, maxima and integer sums do not depend on the order of the parts.
Bins make_bins(std::span<const BuildReference> references, const BinMapping& mapping, int count) {
  if (references.size() <= serial_max) {
    Bins bins(count);
    fill_bins(references, mapping, bins);
    return bins;
  }
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, references.size(), serial_block), Bins(count),
      [&](const auto& part, Bins bins) {
        fill_bins(references.subspan(part.begin(), part.size()), mapping, bins);
        return bins;
      },
      [&](Bins a, const Bins& b) { return a.add(b, count), a; });
}

void try_axis(const std::array<Bin, bins_max>& bins, int axis, int count, ObjectSplit& best) {
  std::array<float, bins_max> left_cost;
  Bin sum;
  for (int b = 1; b < count; ++b) {
    sum.add(bins[b - 1]);
    left_cost[b] = sum.count == 0 ? HUGE_VALF : sum.half_area() * static_cast<float>(sum.count);
  }
  sum = {};
  for (int b = count - 1; b >= 1; --b) {
    sum.add(bins[b]);
    if (sum.count == 0) continue;
    const float cost = left_cost[b] + sum.half_area() * static_cast<float>(sum.count);
    if (cost < best.cost) best = {cost, axis, b, count};
  }
}

ReferenceRange measured(std::span<const BuildReference> references, std::uint32_t begin,
                        std::uint32_t end) {
  ReferenceRange range{begin, end, {}, {}};
  for (std::uint32_t i = begin; i < end; ++i) range.grow(references[i]);
  return range;
}

template <class GoesLeft>
RangeHalves partition_serial(std::span<BuildReference> references, const ReferenceRange& range,
                             GoesLeft goes_left) {
  RangeHalves halves;
  std::uint32_t i = range.begin, j = range.end;
  for (;;) {
    for (; i < j && goes_left(references[i]); ++i) halves.left.grow(references[i]);
    for (; i < j && !goes_left(references[j - 1]); --j) halves.right.grow(references[j - 1]);
    if (i >= j) break;
    std::swap(references[i], references[j - 1]);
  }
  halves.left.begin = range.begin, halves.left.end = halves.right.begin = i;
  halves.right.end = range.end;
  return halves;
}

ReferenceRange measured_in_parallel(std::span<const BuildReference> references, std::uint32_t begin,
                                    std::uint32_t end) {
  ReferenceRange range = tbb::parallel_reduce(
      tbb::blocked_range<std::uint32_t>(begin, end, serial_block), ReferenceRange(),
      [&](const auto& part, ReferenceRange sum) {
        sum.grow(measured(references, part.begin(), part.end()));
        return sum;
      },
      [](ReferenceRange a, const ReferenceRange& b) { return a.grow(b), a; });
  range.begin = begin, range.end = end;
  return range;
}

}  // namespace

BinMapping::BinMapping(const Box4& centers, int bin_count) : base_(centers.low) {
  const auto count = static_cast<float>(bin_count);
  for (int axis = 0; axis < 4; ++axis) {
    const float size = centers.high[axis] - centers.low[axis];
    // Not the fourth; nor what is so small that its inverse overflows.
    scale_[axis] = axis < 3 && size > 1e-30f ? count / size : 0.0f;
    last_[axis] = count - 1.0f;
  }
}

ObjectSplit find_object_split(std::span<const BuildReference> references,
                              const ReferenceRange& range) {
  const int count = bin_count_for(range.size());
  const BinMapping mapping(range.centers, count);
  const Bins bins = make_bins(references.subspan(range.begin, range.size()), mapping, count);
  ObjectSplit best;
  for (int axis = 0; axis < 3; ++axis) {
    if (!mapping.is_flat(axis)) try_axis(bins.of[axis], axis, count, best);
  }
  return best;
}

RangeHalves partition_references(std::span<BuildReference> references, const ReferenceRange& range,
                                 const ObjectSplit& split) {
  const BinMapping mapping(range.centers, split.bin_count);
  const auto goes_left = [&](const BuildReference& r) {
    return mapping(r.twice_center())[split.axis] < split.bin;
  };
  if (range.size() <= serial_max) return partition_serial(references, range, goes_left);
  const std::size_t left =
      parallel_partition(references.subspan(range.begin, range.size()), goes_left);
  const std::uint32_t middle = range.begin + static_cast<std::uint32_t>(left);
  return {measured_in_parallel(references, range.begin, middle),
          measured_in_parallel(references, middle, range.end)};
}

RangeHalves split_in_halves(std::span<BuildReference> references, const ReferenceRange& range) {
  const Float4 size = range.centers.high - range.centers.low;
  const int axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
  const std::uint32_t middle = range.begin + (range.size() + 1) / 2;
  const auto first = references.begin();
  std::nth_element(first + range.begin, first + middle, first + range.end,
                   [axis](const BuildReference& a, const BuildReference& b) {
                     const float x = a.twice_center()[axis], y = b.twice_center()[axis];
                     return x < y || (x == y && a.id() < b.id());
                   });
  return {measured(references, range.begin, middle), measured(references, middle, range.end)};
}

}  // namespace pt
