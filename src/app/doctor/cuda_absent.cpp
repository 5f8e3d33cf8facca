// In place of cuda_facts_cuda.cpp in a build without CUDA.
#include "app/doctor/machine.h"

namespace pt {

CudaFacts read_cuda() { return {}; }

}  // namespace pt
