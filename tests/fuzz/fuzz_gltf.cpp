#include "check_scene.h"
#include "common/scene/load/load_scene.h"
#include "fuzz_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const pt::FuzzFolder folder;
  const auto path = folder.write("input.gltf", pt::as_bytes(data, size));
  pt::LoadOptions options;
  options.time = 0.5f;
  pt::expect_result_or_error([&] { pt::check_scene(pt::load_gltf(path, options)); });
  return 0;
}
