#include "common/accel/trace_cpu/traverse_brute_block.h"

namespace pt {

const BruteBlock* brute_block() {
  static const BruteBlock* const best =
      brute_block_avx512() != nullptr ? brute_block_avx512() : brute_block_avx2();
  return best;
}

}  // namespace pt
