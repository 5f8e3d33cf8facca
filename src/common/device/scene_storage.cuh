// The memory from which a kernel reads the spheres: global, shared or constant (the paper
// compares).
#pragma once

#include <cuda_runtime_api.h>

#include "common/render/options.h"
#include "common/scene/scene.h"

namespace pt {

/// A kernel's parameters may take 32,764 bytes (CUDA 12.1 and later, compute capability 7.0); half
/// of it is enough for the paper's scenes and keeps launches short.
inline constexpr std::uint32_t constant_spheres_max = 1024;

/// Up to here constant memory is as good as any: the scan's first two chunks are addressed by
/// constants (traverse_brute.h). Beyond, 250 spheres take 5 % longer than in global memory, 1000
/// 45 % (results/).
inline constexpr std::uint32_t constant_spheres_best = 64;

/// The scene as a kernel parameter. bind() gives the view that the kernel works with; all threads
/// of a block call it together.
template <SceneMemory memory>
struct SceneStorage;

template <>
struct SceneStorage<SceneMemory::global> {
  static constexpr SceneMemory memory = SceneMemory::global;
  Scene scene;
  __device__ Scene bind() const;
};

template <>
struct SceneStorage<SceneMemory::shared> {
  static constexpr SceneMemory memory = SceneMemory::shared;
  Scene scene;  // the kernel is launched with room for all spheres

  __device__ Scene bind() const;
};

template <>
struct SceneStorage<SceneMemory::constant> {
  static constexpr SceneMemory memory = SceneMemory::constant;
  Scene scene;
  HalfSpheres spheres[constant_spheres_max /
                      HalfSpheres::count];  // in the constant bank, being a parameter

  __device__ Scene bind() const;
};

}  // namespace pt
