#include "common/cuda/cuda_check.cuh"
#include "common/cuda/cuda_memory.cuh"
#include "common/cuda/used_gpu.cuh"
#include "common/device/cuda/create_world.h"

namespace pt {
namespace {

__global__ void create_world(SphereWorld* world, SphereWorldKind kind, std::uint32_t count) {
  create_sphere_world(*world, kind, count);
}

}  // namespace

SphereWorldCreator create_world_on(int device) {
  return [device](SphereWorld& world, SphereWorldKind kind, std::uint32_t count) {
    reach_gpu(device);
    CudaMemory memory;
    const std::uint32_t capacity = world.capacity;
    SphereWorld on_device{memory.allocate<Sphere>("spheres", capacity),
                          memory.allocate<MaterialDescription>("materials", capacity), capacity};
    SphereWorld* pointer = memory.upload("world", std::vector<SphereWorld>{on_device});
    create_world<<<1, 1>>>(pointer, kind, count);
    check_cuda(cudaGetLastError(), "create_world");
    const auto download = [](void* host, const void* from, std::size_t size) {
      check_cuda(cudaMemcpy(host, from, size, cudaMemcpyDeviceToHost), "create_world");
    };
    download(&on_device, pointer, sizeof on_device);
    world.count = on_device.count;
    download(world.spheres, on_device.spheres, world.count * sizeof(Sphere));
    download(world.materials, on_device.materials, world.count * sizeof(MaterialDescription));
  };
}

}  // namespace pt
