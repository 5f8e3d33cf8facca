#include "common/medium/sample_grid.h"
#include "common/scene/data/volume_data.h"
#include "common/scene/load/files/volumes/volume_files.h"
#include "fuzz.h"

// Grids stay sparse: a lookup anywhere has to stay in the tree that the loader has accepted.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pt;
  expect_result_or_error([&] {
    SceneData scene;
    add_grid(scene, decode_nanovdb(as_bytes(data, size), "", "input", VolumeStorage::sparse));
    const Affine to_world = inverse(scene.grids[0].to_unit);
    const VolumeGrids grids{scene.grids.data(), scene.grid_values.data(), nullptr,
                            scene.grid_nodes.data()};
    for (int n = 0; n < 1000; ++n) {
      const Vec3 unit = 0.11f * Vec3(n / 100, n / 10 % 10, n % 10);
      const float value = sample_grid(grids, scene.grids[0], to_world.point(unit)).x;
      if (!(value >= 0) || !std::isfinite(value)) std::abort();
    }
  });
  return 0;
}
