#include "common/scene/load/files/meshes/mesh_files.h"
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pt::expect_result_or_error(
      [&] { pt::check_mesh(pt::decode_ply(pt::as_bytes(data, size), "input")); });
  return 0;
}
