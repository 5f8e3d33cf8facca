#include "common/scene/load/files/meshes/mesh_files.h"
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pt::expect_result_or_error([&] {
    pt::Mesh mesh = pt::decode_obj(pt::as_bytes(data, size), "input");
    pt::check_mesh(mesh);
    pt::compute_vertex_normals(mesh);
    pt::check_mesh(mesh);
  });
  return 0;
}
