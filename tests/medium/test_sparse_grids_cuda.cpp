// Sparse grids on a GPU: the bits of dense ones.
#include <gtest/gtest.h>

#include "common/error/error.h"
#include "common/scene/builtin/generated_scenes.h"
#include "cuda_test.h"
#include "sparse_fogs.h"

namespace pt {
namespace {

class CudaSparseGrids : public CudaTest {
 protected:
  void SetUp() override {
    CudaTest::SetUp();
    if (!reads_nanovdb()) GTEST_SKIP() << "built without NanoVDB";
  }
};

Options sparse_options(const std::string& mode, const Settings& more = {}) {
  return with(with(cloud_options(mode), {{"device", "cuda:0"}, {"width", "61"}}), more);
}

TEST_F(CudaSparseGrids, GiveTheImagesOfDenseOnesInAllModes) {
  const SceneData dense = sparse_fogs(VolumeStorage::dense),
                  sparse = sparse_fogs(VolumeStorage::sparse);
  const Rendered expected = render_clouds(dense, sparse_options("megakernel"));
  expect_plausible(expected, sparse_options("megakernel"));
  for (const Options& options :
       {sparse_options("megakernel"), sparse_options("wavefront"),
        sparse_options("wavefront", {{"wave-collisions", "2"}}),
        sparse_options("wavefront", {{"finish-paths", "0"}}),
        sparse_options("wavefront", {{"stages", "fused"}}),
        sparse_options("wavefront", {{"schedule", "host"}, {"persistent", "off"}})}) {
    SCOPED_TRACE(command_of(options));
    expect_same(render_clouds(sparse, options), expected);
  }
}

// The dense one is traced by persistent warps, and its last paths by blocks.
TEST_F(CudaSparseGrids, GiveTheImagesOfDenseOnesInGlass) {
  const Rendered expected =
      render_clouds(sparse_glasses(VolumeStorage::dense), sparse_options("wavefront"));
  const SceneData sparse = sparse_glasses(VolumeStorage::sparse);
  for (const Options& options :
       {sparse_options("megakernel"), sparse_options("wavefront"),
        sparse_options("wavefront", {{"compaction", "cub"}, {"wave-collisions", "3"}})}) {
    SCOPED_TRACE(command_of(options));
    expect_same(render_clouds(sparse, options), expected);
  }
  EXPECT_THROW(render_clouds(sparse, sparse_options("wavefront", {{"accel", "cwbvh"}})), Error);
}

// The first hits look through media, too.
TEST_F(CudaSparseGrids, GiveTheFeaturesOfDenseOnes) {
  const auto image = [](VolumeStorage storage) {
    return render_clouds(sparse_fogs(storage),
                         sparse_options("megakernel", {{"aov", "depth,collision,transmittance"},
                                                       {"output", "a.exr"}}));
  };
  const Rendered dense = image(VolumeStorage::dense), sparse = image(VolumeStorage::sparse);
  ASSERT_EQ(dense.image.layers.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(sparse.image.layers.at(i).values, dense.image.layers[i].values) << i;
  }
}

TEST_F(CudaSparseGrids, CloudsAreTheSameAsDenseOnes) {
  const auto image = [](VolumeStorage storage, const std::string& mode) {
    const CloudSettings settings{192, 20, 0.9f, true};
    return render_clouds(make_cloud_scene(settings, storage),
                         sparse_options(mode, {{"width", "120"}, {"height", "80"}}));
  };
  const Rendered expected = image(VolumeStorage::dense, "megakernel");
  expect_same(image(VolumeStorage::sparse, "megakernel"), expected);
  expect_same(image(VolumeStorage::sparse, "wavefront"), expected);
}

}  // namespace
}  // namespace pt
