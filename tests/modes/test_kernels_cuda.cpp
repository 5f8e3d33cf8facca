// Every row of the table of kernels on a GPU.
#include "cuda_test.h"
#include "kernel_cases.h"

namespace pt {
namespace {

class CudaTableOfKernels : public CudaTest {};

TEST_F(CudaTableOfKernels, EachRenders) { render_by_each_kernel(true); }

}  // namespace
}  // namespace pt
