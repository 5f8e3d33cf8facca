#include "common/plan/render_properties.h"

#include "common/accel/trace_cpu/traverse_brute_block.h"
#include "common/accel/traverse_triangles.h"

namespace pt {

DeviceProperties cpu_properties(int threads) {
  DeviceProperties cpu;
  cpu.has_avx2 = has_avx2();
  cpu.has_ray_blocks = brute_block() != nullptr;
  cpu.threads = threads;
  return cpu;
}

}  // namespace pt
