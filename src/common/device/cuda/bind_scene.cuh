// How a kernel binds its scene: device code.
#pragma once

#include "common/device/cuda/scene_storage.cuh"

namespace pt {

__device__ inline const Scene& SceneStorage<SceneMemory::global>::bind() const { return scene; }

__device__ inline Scene SceneStorage<SceneMemory::shared>::bind() const {
  extern __shared__ HalfSpheres shared_spheres[];
  const std::uint32_t threads = blockDim.x * blockDim.y;
  for (std::uint32_t i = threadIdx.y * blockDim.x + threadIdx.x; i < scene.primitives.half_count;
       i += threads) {
    store_wide(&shared_spheres[i], load_wide(&scene.primitives.halves[i]));
  }
  __syncthreads();
  Scene bound = scene;
  bound.primitives.halves = shared_spheres;
  return bound;
}

__device__ inline Scene SceneStorage<SceneMemory::constant>::bind() const {
  Scene bound = scene;
  bound.primitives.halves = spheres;
  return bound;
}

}  // namespace pt
