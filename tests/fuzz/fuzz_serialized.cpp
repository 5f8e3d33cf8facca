#include "common/scene/load/files/meshes/mesh_files.h"
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (const int shape : {0, 1}) {
    pt::expect_result_or_error(
        [&] { pt::check_mesh(pt::decode_serialized(pt::as_bytes(data, size), "input", shape)); });
  }
  return 0;
}
