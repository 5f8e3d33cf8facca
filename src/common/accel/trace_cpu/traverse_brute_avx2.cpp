#include "common/accel/trace_cpu/traverse_brute_lanes.h"
#include "common/accel/traverse_triangles.h"

namespace pt {

#ifdef __x86_64__

const BruteBlock* brute_block_avx2() { return has_avx2() ? &brute_block_by<Lanes8> : nullptr; }

#else

const BruteBlock* brute_block_avx2() { return nullptr; }

#endif

}  // namespace pt
