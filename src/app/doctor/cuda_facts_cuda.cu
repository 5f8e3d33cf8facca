#include <cuda_runtime_api.h>
#include <dlfcn.h>

#include "app/doctor/doctor.h"
#include "common/accel/trace_optix/optix_library.h"
#include "common/device/cuda/counter_session_cuda.h"
#include "wavefront/optix/optix_queue.h"

namespace pt {
namespace {

__global__ void probe() {}

/// Launches an empty kernel and waits for it: whether the program's code runs on this GPU.
cudaError_t run_probe_kernel() {
  probe<<<1, 1>>>();
  const cudaError_t launched = cudaGetLastError();
  return launched != cudaSuccess ? launched : cudaDeviceSynchronize();
}

/// Why this call failed; empty: it did not.
std::string problem_of(cudaError_t status) {
  if (status == cudaSuccess) return "";
  cudaGetLastError();  // clears it
  return cudaGetErrorString(status);
}

GpuFacts read_gpu(int device) {
  GpuFacts gpu;
  cudaDeviceProp p{};
  gpu.problem = problem_of(cudaGetDeviceProperties(&p, device));
  if (!gpu.problem.empty()) return gpu;
  gpu.name = p.name, gpu.major = p.major, gpu.minor = p.minor;
  gpu.memory = p.totalGlobalMem, gpu.multiprocessors = p.multiProcessorCount;
  gpu.block_shared = p.sharedMemPerBlock, gpu.block_shared_max = p.sharedMemPerBlockOptin;
  std::size_t available = 0, total = 0;
  gpu.problem = problem_of(cudaSetDevice(device));
  if (gpu.problem.empty()) gpu.problem = problem_of(cudaMemGetInfo(&available, &total));
  if (gpu.problem.empty()) gpu.problem = problem_of(run_probe_kernel());
  gpu.free_memory = available;
  return gpu;
}

std::string find_cupti() {
  for (const std::string& path : cupti_paths()) {
    void* library = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (library == nullptr) continue;
    dlclose(library);
    return path;
  }
  return "";
}

/// On the device used last.
void read_optix(CudaFacts& facts) {
  try {
    const auto library = std::make_shared<const OptixLibrary>();
    const unsigned version = OptixContext(library).rtcore_version();
    facts.optix = library->path() + ", ABI " + std::to_string(optix::abi_version) + ", " +
                  (version == 0 ? "no RT cores: it traces by software"
                                : "RT cores of version " + std::to_string(version / 10) + "." +
                                      std::to_string(version % 10));
    if (optix_queue_module().code.empty())
      facts.optix_problem = "ptexp was built without it (PTEXP_OPTIX)";
  } catch (const std::exception& error) {
    facts.optix_problem = error.what();
  }
}

}  // namespace

CudaFacts read_cuda() {
  CudaFacts facts;
  facts.is_built = true;
  facts.built = CUDART_VERSION;
  cudaRuntimeGetVersion(&facts.runtime);
  if (cudaDriverGetVersion(&facts.driver) != cudaSuccess) facts.driver = 0;
  int count = 0;
  facts.problem = problem_of(cudaGetDeviceCount(&count));
  for (int i = 0; facts.problem.empty() && i < count; ++i) facts.gpus.push_back(read_gpu(i));
  facts.cupti = find_cupti();
  if (!facts.gpus.empty()) read_optix(facts);
  return facts;
}

}  // namespace pt
