#include "common/scene/load/obj/mtl.h"
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pt::expect_result_or_error([&] {
    pt::SceneData scene;
    pt::CountedWarnings warnings;
    pt::obj::NamedFiles files(warnings);
    pt::obj::MtlTextures textures({"folder"}, files, scene, warnings);
    for (const auto& material : pt::obj::parse_mtl(pt::as_bytes(data, size), "a.mtl", warnings)) {
      pt::obj::add_material(material, textures, scene, warnings);
    }
    for (const pt::MaterialDescription& material : scene.materials) {
      const pt::Color& albedo = material.color(0);
      for (int c = 0; c < 3 && material.node == pt::MaterialNode::none; ++c) {
        if (!(albedo[c] >= 0.0f && albedo[c] <= 1.0f)) std::abort();
      }
    }
  });
  return 0;
}
