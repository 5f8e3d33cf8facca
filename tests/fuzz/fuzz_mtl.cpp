#include "common/error/error_context.h"
#include "common/scene/load/files/meshes/obj_material.h"
#include "fuzz.h"

// Instead of the library's own object code, so that the fuzzer sees into it.
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pt::expect_result_or_error([&] {
    pt::ObjFile file;
    pt::explaining("input", [&] {  // as its callers do
      pt::decode_mtl(pt::as_bytes(data, size), "folder/a.mtl", file);
    });
    for (const pt::ObjMaterial& material : file.materials) {
      const pt::Color& albedo = material.material.color(0);
      for (int c = 0; c < 3; ++c) {
        if (!(albedo[c] >= 0.0f && albedo[c] <= 1.0f)) std::abort();
      }
    }
  });
  return 0;
}
