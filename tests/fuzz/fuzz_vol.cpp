#include "common/scene/load/files/volumes/volume_files.h"
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pt::expect_result_or_error([&] {
    pt::SceneData scene;
    pt::add_grid(scene, pt::decode_vol(pt::as_bytes(data, size), "input").grid);
  });
  return 0;
}
