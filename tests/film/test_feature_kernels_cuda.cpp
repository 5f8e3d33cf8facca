// Each scene that CUDA renders has a kernel for its AOVs, which no table promises. Needs no GPU.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/device/cuda/film_kernels.cuh"
#include "common/plan/kernels.h"

namespace pt {
namespace {

TEST(FeatureKernels, AreThereForEachSceneOfCuda) {
  int count = 0;
  for (int i = 0; i < extras_count; ++i) {
    for (const Accel accel : {Accel::brute, Accel::bvh2, Accel::cwbvh}) {
      for (const Geometry geometry :
           {Geometry::spheres_and_quads, Geometry::triangles, Geometry::mixed}) {
        for (const Lighting lighting : {Lighting::sky, Lighting::emitters, Lighting::full}) {
          SceneTraits scene = traits_of(Extras{i});
          scene.accel = accel, scene.geometry = geometry, scene.lighting = lighting;
          const auto is_rendered = [&](const KernelRow& row) {
            return row.on_cuda && row.accels.contains(accel) && is_of_scene(row, scene);
          };
          if (std::ranges::none_of(kernel_table, is_rendered)) continue;
          ++count;
          EXPECT_NE(feature_kernel(scene), nullptr);
        }
      }
    }
  }
  EXPECT_GT(count, 10);
}

}  // namespace
}  // namespace pt
