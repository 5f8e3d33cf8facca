#include "common/scene/load/files/images/image_files.h"
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pt::expect_result_or_error([&] {
    const pt::TextureImage image = pt::decode_texture_image(pt::as_bytes(data, size), "input");
    const std::size_t texel_bytes = image.format == pt::TextureFormat::rgb32f ? 12 : 4;
    if (image.width == 0 || image.height == 0 ||
        image.texels.size() != texel_bytes * image.width * image.height ||
        (!image.alpha.empty() && image.alpha.size() * 12 != image.texels.size())) {
      std::abort();
    }
  });
  return 0;
}
