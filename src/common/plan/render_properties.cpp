#include "common/plan/render_properties.h"

#include "common/accel/trace_cpu/ray_block.h"
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
