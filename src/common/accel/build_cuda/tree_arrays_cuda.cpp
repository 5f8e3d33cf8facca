#include <algorithm>

#include "common/accel/build_cuda/tree_arrays.cuh"
#include "common/cuda/cuda_check.cuh"

namespace pt {

void TreeArrays::reserve_triangles(std::uint64_t count) {
  triangles_ = memory_.allocate<Triangle>("triangles", count);
}

void* TreeArrays::take(TreeArray array, std::uint64_t size_bytes) {
  if (array == TreeArray::nodes) return take_nodes(size_bytes);
  if (array == TreeArray::order) return take_order(size_bytes);
  Triangle* place = triangles_ + triangles_used_;
  triangles_used_ += size_bytes / sizeof(Triangle);
  return place;
}

void* TreeArrays::take_nodes(std::uint64_t size_bytes) {
  if (blocks_.empty() || blocks_.back().used + size_bytes > blocks_.back().capacity) {
    constexpr std::uint64_t least = 1 << 20;
    // In proportion to what there is: the number of blocks grows with its logarithm.
    const std::uint64_t capacity = std::max({size_bytes, node_bytes_ / 4, least});
    blocks_.push_back({temporary_.allocate<char>("nodes", capacity), 0, capacity});
  }
  Block& block = blocks_.back();
  char* place = block.begin + block.used;
  block.used += size_bytes;
  node_bytes_ += size_bytes;
  return place;
}

void* TreeArrays::take_order(std::uint64_t size_bytes) {
  if (size_bytes > order_bytes_) {
    order_ = temporary_.allocate<char>("order", size_bytes);
    order_bytes_ = size_bytes;
  }
  return order_;
}

const void* TreeArrays::join_bytes(const void* last, std::uint64_t last_bytes) {
  char* nodes = memory_.allocate<char>("acceleration structure", node_bytes_ + last_bytes);
  char* next = nodes;
  for (const Block& block : blocks_) {
    check_cuda(cudaMemcpyAsync(next, block.begin, block.used, cudaMemcpyDeviceToDevice),
               "moving nodes");
    next += block.used;
  }
  if (last_bytes > 0) {
    check_cuda(cudaMemcpy(next, last, last_bytes, cudaMemcpyHostToDevice), "uploading nodes");
  }
  // The kernels that read them run in streams that do not wait for the default one.
  check_cuda(cudaStreamSynchronize(nullptr), "moving nodes");
  return nodes;
}

}  // namespace pt
