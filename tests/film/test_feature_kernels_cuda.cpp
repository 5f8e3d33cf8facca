// Each scene that CUDA renders has a kernel for its AOVs, which no table promises. Needs no GPU.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/device/cuda/film_kernels.cuh"
#include "common/render/dispatch.h"

namespace pt {
namespace {

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
