// The list of acceleration structures.
#pragma once

namespace pt {

/// The structure in which a ray looks for its hit. Embree's is for the CPU, and cwbvh_avx2, the
/// wide tree by a processor's AVX2, for one that has it.
enum class Accel { brute, bvh2, cwbvh, embree, cwbvh_avx2 };

/// As the command line has it.
inline const char* accel_name(Accel accel) {
  constexpr const char* names[] = {"brute", "bvh2", "cwbvh", "embree", "cwbvh"};
  return names[static_cast<int>(accel)];
}

}  // namespace pt
