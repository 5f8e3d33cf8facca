// The memory from which a kernel reads the spheres: global, shared or constant (the paper
// compares).
#pragma once

#include <cuda_runtime_api.h>

#include "common/plan/execution_plan.h"
#include "common/scene/data/scene.h"

namespace pt {

/// The scene as a kernel parameter. bind() gives the view that the kernel works with; all threads
/// of a block call it together.
template <SceneMemory memory>
struct SceneStorage;

template <>
struct SceneStorage<SceneMemory::global> {
  static constexpr SceneMemory memory = SceneMemory::global;
  Scene scene;
  __device__ const Scene& bind() const;
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
