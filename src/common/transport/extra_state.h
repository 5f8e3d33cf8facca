// More state of a path than its transport needs (--path-bytes): records of 16 bytes that every ray
// of the path reads, changes and stores wherever the path's state is kept. They stand for spectra,
// derivatives, guiding or motion, and tell what the size of a path costs each mode. They leave the
// image as it is, unless a record is lost or is another path's: then the sample is not a number.
#pragma once

#include <type_traits>

#include "common/sampling/sampler_source.h"
#include "common/transport/path.h"

namespace pt {

struct alignas(16) ExtraRecord {
  std::uint32_t words[4];
};

inline constexpr int extra_record_bytes = path_bytes_step;
inline constexpr int extra_records_max = path_bytes_max / extra_record_bytes;
static_assert(sizeof(ExtraRecord) == extra_record_bytes);

/// Each ray but the last multiplies every word by it. It is odd, so that no word loses bits.
inline constexpr std::uint32_t extra_factor = 0x9e3779b1u;

/// What the k-th record of a new path is; different for each path.
PT_HD ExtraRecord first_extra_record(std::uint32_t path_index, std::uint32_t k) {
  ExtraRecord record{};
  PT_UNROLL(4)
  for (std::uint32_t i = 0; i < 4; ++i)
    record.words[i] = (path_index * 0x85ebca6bu + (4 * k + i) * 0xc2b2ae35u) | 1u;
  return record;
}

PT_HD void change_extra_record(ExtraRecord& record) {
  PT_UNROLL(4)
  for (std::uint32_t& word : record.words) word *= extra_factor;
}

/// What all changes of `count` rays multiply by. Neither a compiler nor a path knows it before the
/// path's end, so that every record must be kept until then.
PT_HD std::uint32_t extra_growth(std::uint32_t count) {
  std::uint32_t growth = 1;
  for (std::uint32_t square = extra_factor; count != 0; count >>= 1, square *= square)
    if ((count & 1u) != 0) growth *= square;
  return growth;
}

PT_HD bool is_extra_record(const ExtraRecord& record, std::uint32_t path_index, std::uint32_t k,
                           std::uint32_t growth) {
  const ExtraRecord first = first_extra_record(path_index, k);
  std::uint32_t difference = 0;
  PT_UNROLL(4)
  for (int i = 0; i < 4; ++i) difference |= record.words[i] ^ first.words[i] * growth;
  return difference == 0;
}

/// The radiance of a path whose records are not what they should be.
PT_HD Color broken_radiance() { return Color(bits_to_float(0x7fc00000u)); }

/// The records of paths in memory, each path's at a *place*: a slot or a lane. Run-time values, so
/// that all numbers of records and all layouts are one code.
struct ExtraState {
  char* records = nullptr;       ///< the first one of place 0
  std::uint32_t count = 0;       ///< of a path
  std::uint32_t stride = 0;      ///< bytes from a place to the next one
  std::uint32_t row_bits = 0;    ///< 2^this records of a place lie side by side, a row
  std::uint64_t row_stride = 0;  ///< bytes from a place's row to its next one

  /// All records of a place side by side, and the places one after the other.
  PT_HD static ExtraState by_place(ExtraRecord* records, std::uint32_t count) {
    return {reinterpret_cast<char*>(records), count, count * extra_record_bytes, 4, 0};
  }

  PT_HD ExtraRecord* at(std::uint64_t place, std::uint32_t k) const {
    const std::uint32_t row = k >> row_bits;
    char* const first = records + place * stride + row * row_stride;
    return reinterpret_cast<ExtraRecord*>(first) + (k - (row << row_bits));
  }

  PT_HD void begin(std::uint64_t place, std::uint32_t path_index) const {
    for (std::uint32_t k = 0; k < count; ++k)
      store_wide(at(place, k), first_extra_record(path_index, k));
  }

  /// The path goes on.
  PT_HD void step(std::uint64_t place) const {
    constexpr std::uint32_t at_once = 4;  // loads that wait together
    for (std::uint32_t first = 0; first < count; first += at_once) {
      ExtraRecord loaded[at_once];
      PT_UNROLL(4)
      for (std::uint32_t i = 0; i < at_once; ++i)
        if (first + i < count) loaded[i] = load_wide(at(place, first + i));
      PT_UNROLL(4)
      for (std::uint32_t i = 0; i < at_once; ++i) {
        if (first + i >= count) break;
        change_extra_record(loaded[i]);
        store_wide(at(place, first + i), loaded[i]);
      }
    }
  }

  /// Whether the path that ends has all that it began with. It has traced `path.rays`.
  PT_HD bool is_whole(std::uint64_t place, const PathState& path) const {
    if (count == 0) return true;
    const std::uint32_t growth = extra_growth(path.rays - 1u);
    bool whole = true;
    for (std::uint32_t k = 0; k < count; ++k)
      whole = is_extra_record(load_wide(at(place, k)), path.index, k, growth) && whole;
    return whole;
  }

  /// Moves a path that goes on elsewhere.
  PT_HD void copy_to(std::uint64_t place, const ExtraState& other, std::uint64_t to) const {
    for (std::uint32_t k = 0; k < count; ++k) store_wide(other.at(to, k), load_wide(at(place, k)));
  }
};

/// The records of the one path that a thread follows, in registers: `count` at compile time.
template <int count>
class ExtraRegisters {
 public:
  PT_HD explicit ExtraRegisters(const PathSettings&) {}
  PT_HD void begin(std::uint32_t path_index) {
    PT_UNROLL(16)
    for (int k = 0; k < count; ++k)
      records_[k] = first_extra_record(path_index, static_cast<std::uint32_t>(k));
  }
  PT_HD void step() {
    PT_UNROLL(16)
    for (ExtraRecord& record : records_) change_extra_record(record);
  }
  PT_HD bool is_whole(const PathState& path) const {
    const std::uint32_t growth = extra_growth(path.rays - 1u);
    bool whole = true;
    PT_UNROLL(16)
    for (int k = 0; k < count; ++k) {
      const auto index = static_cast<std::uint32_t>(k);
      whole = is_extra_record(records_[k], path.index, index, growth) && whole;
    }
    return whole;
  }

 private:
  ExtraRecord records_[count];
};

/// As many as --path-bytes says.
inline constexpr int any_extra = -1;

/// The same for a CPU, which has them in memory and in its first cache.
template <>
class ExtraRegisters<any_extra> {
 public:
  explicit ExtraRegisters(const PathSettings& settings) : count_(settings.extra_records) {}
  void begin(std::uint32_t path_index) { state().begin(0, path_index); }
  void step() { state().step(0); }
  bool is_whole(const PathState& path) { return state().is_whole(0, path); }

 private:
  ExtraState state() { return ExtraState::by_place(records_, count_); }

  std::uint32_t count_;
  ExtraRecord records_[extra_records_max];
};

/// None.
template <>
class ExtraRegisters<0> {
 public:
  PT_HD explicit ExtraRegisters(const PathSettings&) {}
  PT_HD void begin(std::uint32_t) {}
  PT_HD void step() {}
  PT_HD bool is_whole(const PathState&) const { return true; }
};

/// The source of random numbers of CUDA kernels whose paths carry so many records, apart from all
/// others: these have no instruction for it.
template <int count = any_extra>
struct CarryingSource : SamplerSource {
  static constexpr int extra_records = count;
};

/// The records that paths of kernels with this source carry.
template <class Source>
constexpr int extra_records_of() {
  if constexpr (requires { Source::extra_records; }) return Source::extra_records;
  return is_cuda_code ? 0 : any_extra;
}
template <class Source>
inline constexpr bool carries_extra = extra_records_of<Source>() != 0;

/// The member of a kernel's objects where they carry none.
struct NoExtraState {
  PT_HD NoExtraState(const ExtraState&) {}
};
template <bool carries>
using ExtraStateIf = std::conditional_t<carries, ExtraState, NoExtraState>;

}  // namespace pt
