#include "common/error/error.h"
#include "common/scene/data/volume_data.h"

namespace pt {

void for_each_brick(const SparseBlock*, const std::function<void(const SparseBrick&)>&) {}

bool number_voxels(VolumeData&, std::vector<float>&) { return false; }

VolumeData make_sparse(std::uint32_t, std::span<const glm::ivec3>,
                       const std::function<void(std::size_t, float*)>&) {
  throw Error(
      "a sparse grid: this program was built without NanoVDB; install libnanovdb-dev and build "
      "with PTEXP_NANOVDB=ON");
}

}  // namespace pt
