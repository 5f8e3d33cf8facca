#include "common/accel/trace_cpu/lanes_avx512.h"
// clang-format off: behind it
#include "common/accel/trace_cpu/traverse_brute_lanes.h"
// clang-format on

namespace pt {

#ifdef __x86_64__

const BruteBlock* brute_block_avx512() { return has_avx512() ? &brute_block_by<Lanes16> : nullptr; }

#else

const BruteBlock* brute_block_avx512() { return nullptr; }

#endif

}  // namespace pt
