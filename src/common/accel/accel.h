// The list of acceleration structures.
#pragma once

namespace pt {

/// The structure in which a ray looks for its hit. Embree's is for the CPU.
enum class Accel { brute, bvh2, cwbvh, embree };

/// As the command line has it.
inline const char* accel_name(Accel accel) {
  constexpr const char* names[] = {"brute", "bvh2", "cwbvh", "embree"};
  return names[static_cast<int>(accel)];
}

}  // namespace pt
