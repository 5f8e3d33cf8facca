// Every row of the table of kernels on a GPU.
#include <algorithm>

#include "common/device/cuda/film_kernels.cuh"
#include "common/render/dispatch.h"
#include "cuda_test.h"
#include "kernel_cases.h"

namespace pt {
namespace {

class CudaTableOfKernels : public CudaTest {};

TEST_F(CudaTableOfKernels, EachRenders) { render_by_each_kernel(true); }

// Each scene that CUDA renders has a kernel for its AOVs. Needs no GPU.
TEST(FeatureKernels, AreThereForEachSceneOfCuda) {
  int count = 0;
  for (int i = 0; i < detail::traits_count; ++i) {
    const SceneTraits scene = detail::traits_at(i);
    const auto is_rendered = [&](const KernelRow& row) {
      return row.on_cuda && row.accels.contains(scene.accel) && is_of_scene(row, scene);
    };
    if (std::ranges::none_of(kernel_table, is_rendered)) continue;
    ++count;
    EXPECT_NE(feature_kernel(scene), nullptr);
  }
  EXPECT_GT(count, 10);
}

}  // namespace
}  // namespace pt
