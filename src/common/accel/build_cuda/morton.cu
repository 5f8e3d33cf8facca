// Morton codes, their sorting (CUB's radix sort) and the prefixes that neighbours share.
#include <cub/device/device_radix_sort.cuh>

#include "common/accel/build_cuda/kernels.cuh"
#include "common/accel/build_cuda/launch.cuh"

namespace pt::device_build {
namespace {

template <class Key>
__global__ void __launch_bounds__(block_size)
    make_codes(const BuildNode* primitives, std::uint32_t count, const SharedBounds* bounds,
               int bits, Key* keys, std::uint32_t* values) {
  const MortonGrid grid = make_morton_grid(read_bounds(*bounds, 0), bits);
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  const Bounds box = load_wide(&primitives[i]).bounds();
  keys[i] = static_cast<Key>(morton_code(grid, box.center()));
  values[i] = i;
}

template <class Key>
__global__ void __launch_bounds__(block_size)
    find_prefixes(const Key* keys, std::uint32_t count, bool by_code, std::uint8_t* prefixes) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;  // of i - 1 and i
  if (i > count) return;
  const bool is_end = i == 0 || i == count;
  const std::uint64_t code = is_end || !by_code ? 0 : keys[i];
  const std::uint64_t before = is_end || !by_code ? 0 : keys[i - 1];
  prefixes[i] = is_end ? std::uint8_t{0} : neighbour_prefix(before, code, i - 1);
}

template <class Key>
std::uint64_t sort(SortBuffers& buffers, std::uint32_t count, int morton_bits, void* scratch,
                   std::size_t scratch_bytes) {
  cub::DoubleBuffer<Key> keys(static_cast<Key*>(buffers.keys[0]),
                              static_cast<Key*>(buffers.keys[1]));
  cub::DoubleBuffer<std::uint32_t> values(buffers.values[0], buffers.values[1]);
  check_cuda(cub::DeviceRadixSort::SortPairs(scratch, scratch_bytes, keys, values, count, 0,
                                             3 * morton_bits),
             "sorting Morton codes");
  if (scratch != nullptr) {
    buffers.keys[0] = keys.Current(), buffers.keys[1] = keys.Alternate();
    buffers.values[0] = values.Current(), buffers.values[1] = values.Alternate();
  }
  return scratch_bytes;
}

}  // namespace

void enqueue_morton(const BuildNode* primitives, std::uint32_t count, const SharedBounds* bounds,
                    int morton_bits, const SortBuffers& buffers) {
  const auto launch = [&](auto* keys) {
    make_codes<<<blocks_for(count), block_size>>>(primitives, count, bounds, morton_bits, keys,
                                                  buffers.values[0]);
  };
  if (has_small_keys(morton_bits)) {
    launch(static_cast<std::uint32_t*>(buffers.keys[0]));
  } else {
    launch(static_cast<std::uint64_t*>(buffers.keys[0]));
  }
  check_cuda(cudaGetLastError(), "make_codes");
}

std::uint64_t sort_scratch_bytes(std::uint32_t count, int morton_bits) {
  SortBuffers none{};
  return has_small_keys(morton_bits) ? sort<std::uint32_t>(none, count, morton_bits, nullptr, 0)
                                     : sort<std::uint64_t>(none, count, morton_bits, nullptr, 0);
}

void enqueue_sort(SortBuffers& buffers, std::uint32_t count, int morton_bits, void* scratch,
                  std::uint64_t scratch_bytes) {
  if (has_small_keys(morton_bits)) {
    sort<std::uint32_t>(buffers, count, morton_bits, scratch, scratch_bytes);
  } else {
    sort<std::uint64_t>(buffers, count, morton_bits, scratch, scratch_bytes);
  }
}

void enqueue_prefixes(const void* keys, std::uint32_t count, int morton_bits, bool by_code,
                      std::uint8_t* prefixes) {
  const unsigned blocks = blocks_for(std::uint64_t{count} + 1);
  if (has_small_keys(morton_bits)) {
    find_prefixes<<<blocks, block_size>>>(static_cast<const std::uint32_t*>(keys), count, by_code,
                                          prefixes);
  } else {
    find_prefixes<<<blocks, block_size>>>(static_cast<const std::uint64_t*>(keys), count, by_code,
                                          prefixes);
  }
  check_cuda(cudaGetLastError(), "find_prefixes");
}

}  // namespace pt::device_build
