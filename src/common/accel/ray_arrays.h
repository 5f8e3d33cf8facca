// Rays and hits in device memory.
#pragma once

#include "common/accel/ray_record.h"

namespace pt {

/// `next` counts the rays handed out to persistent warps; it is 0 before a launch.
struct RayArrays {
  const RayRecord* rays = nullptr;
  HitRecord* hits = nullptr;
  std::uint32_t count = 0;
  std::uint32_t* next = nullptr;
};

/// Numbers [next, end) of rays that a warp has reserved; empty at first. In shared memory.
struct ReservedRays {
  std::uint32_t next, end;
};

}  // namespace pt
