#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>

#include "common/accel/build/binary/split.h"

namespace pt {

namespace {

struct ObjectBin : Box4 {
  std::uint32_t count = 0;
  void add(const BuildReference& r) { grow(r), ++count; }
  void add(const ObjectBin& b) { grow(b), count += b.count; }
};

/// By axis. The number of bins is a type's, since making more than needed takes long for small
/// nodes.
template <int bin_count>
struct ObjectBins {
  std::array<std::array<ObjectBin, bin_count>, 3> of;

  void add(const ObjectBins& other) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int b = 0; b < bin_count; ++b) of[axis][b].add(other.of[axis][b]);
    }
  }
};

template <int bin_count>
void fill_bins(std::span<const BuildReference> references, const BinMapping& mapping,
               ObjectBins<bin_count>& bins) {
  for (const BuildReference& r : references) {
    const Int4 bin = mapping(r.twice_center());
    for (int axis = 0; axis < 3; ++axis) bins.of[axis][bin[axis]].add(r);
  }
}

// Minima, maxima and integer sums do not depend on the order of the parts.
template <int bin_count>
ObjectBins<bin_count> make_bins(std::span<const BuildReference> references,
                                const BinMapping& mapping) {
  if (references.size() <= serial_range_max) {
    ObjectBins<bin_count> bins;
    fill_bins(references, mapping, bins);
    return bins;
  }
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, references.size(), range_block), ObjectBins<bin_count>(),
      [&](const auto& part, ObjectBins<bin_count> bins) {
        fill_bins(references.subspan(part.begin(), part.size()), mapping, bins);
        return bins;
      },
      [&](ObjectBins<bin_count> a, const ObjectBins<bin_count>& b) {
        a.add(b);
        return a;
      });
}

template <int bin_count>
void try_axis(const std::array<ObjectBin, bin_count>& bins, int axis, ObjectSplit& best) {
  std::array<ObjectBin, bin_count> left;  // of the bins below
  for (int b = 1; b < bin_count; ++b) left[b] = left[b - 1], left[b].add(bins[b - 1]);
  ObjectBin right;
  for (int b = bin_count - 1; b >= 1; --b) {
    right.add(bins[b]);
    if (right.count == 0 || left[b].count == 0) continue;
    const float cost = left[b].half_area() * static_cast<float>(left[b].count) +
                       right.half_area() * static_cast<float>(right.count);
    if (cost < best.cost) best = {cost, axis, b, bin_count, left[b], right};
  }
}

template <int bin_count>
ObjectSplit find_split(std::span<const BuildReference> references, const Box4& centers) {
  const BinMapping mapping(centers, bin_count);
  const ObjectBins<bin_count> bins = make_bins<bin_count>(references, mapping);
  ObjectSplit best;
  for (int axis = 0; axis < 3; ++axis) {
    if (!mapping.is_flat(axis)) try_axis<bin_count>(bins.of[axis], axis, best);
  }
  return best;
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
  const auto those = references.subspan(range.begin, range.size());
  if (range.size() < 32) return find_split<8>(those, range.centers);
  if (range.size() < 1024) return find_split<16>(those, range.centers);
  return find_split<32>(those, range.centers);
}

RangeHalves partition_references(std::span<BuildReference> references, const ReferenceRange& range,
                                 const ObjectSplit& split) {
  const BinMapping mapping(range.centers, split.bin_count);
  const auto goes_left = [&](const BuildReference& r) {
    return mapping(r.twice_center())[split.axis] < split.bin;
  };
  return partition_range(references, range.begin, range.end, goes_left);
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
  return {measured_range(references, range.begin, middle),
          measured_range(references, middle, range.end)};
}

}  // namespace pt
