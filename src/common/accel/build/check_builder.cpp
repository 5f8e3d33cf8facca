#include "common/accel/build/check_builder.h"

#include <fmt/format.h>

#include "common/error/error.h"
#include "common/options/option_names.h"

namespace pt {

void check_builder(TreeBuilder builder, AccelKind accel, bool on_cuda) {
  if (!is_device_builder(builder)) return;
  const std::string name = to_string(builder);
  if (!on_cuda) {
    throw Error(
        fmt::format("--builder {}: needs a CUDA device; on the CPU expected sah or sbvh", name));
  }
  if (accel != AccelKind::bvh2 && accel != AccelKind::cwbvh) {
    throw Error(fmt::format(
        "--builder {}: builds binary and wide trees; expected --accel bvh2 or cwbvh", name));
  }
}

}  // namespace pt
