// What rays are traced against in scenes made of triangles, built on the CUDA device.
#pragma once

#include "common/accel/build/build_triangle_tree.h"
#include "common/accel/build/tree_statistics.h"
#include "common/cuda/cuda_memory.cuh"

namespace pt {

struct DeviceTriangleTree {
  TriangleTree view;  ///< of device memory
  TreeSummary summary;
};

/// As build_triangle_tree(), by a builder of the device: one tree of the whole, or one for each
/// group and, on the CPU since it is small, one over the instances. Its arrays belong to `memory`.
/// `meshes` and `instances` have passed check_geometry(), and the options check_builder(). Throws
/// Error where the device has too little memory.
DeviceTriangleTree build_device_triangle_tree(std::span<const Mesh> meshes,
                                              std::span<const Instance> instances,
                                              const TreeOptions& options, CudaMemory& memory);

}  // namespace pt
