#include "common/accel/lanes_avx512.h"
// clang-format off: behind it
#include "common/accel/traverse_brute_lanes.h"
// clang-format on

namespace pt {

#ifdef __x86_64__

namespace {

bool has_avx512() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("bmi") &&
         __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
}

}  // namespace

const BruteBlock* brute_block_avx512() {
  static const bool has = has_avx512();
  return has ? &brute_block_by<Lanes16> : nullptr;
}

#else

const BruteBlock* brute_block_avx512() { return nullptr; }

#endif

}  // namespace pt
