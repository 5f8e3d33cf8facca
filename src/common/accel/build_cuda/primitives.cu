// Boxes of the primitives, of their centers and of the scene; the triangles' records; Morton codes,
// their sorting (CUB's radix sort) and the prefixes that neighbours share.
#include <cub/device/device_radix_sort.cuh>

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build_cuda/kernels.cuh"
#include "common/accel/build_cuda/launch.cuh"

namespace pt::device_build {
namespace {

constexpr float coordinate_max = 1e12f;  // see mesh_triangles.cpp

__device__ MeshRange range_of(const TriangleSource& source, std::uint32_t triangle) {
  if (source.ranges == nullptr) return {};
  std::uint32_t low = 0, high = source.range_count;  // the last range that begins at or before
  while (high - low > 1) {
    const std::uint32_t middle = low + (high - low) / 2;
    if (source.ranges[middle].first_triangle <= triangle) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return source.ranges[low];
}

__device__ Triangle load_triangle(const TriangleSource& source, std::uint32_t i) {
  if (source.records != nullptr) return load_wide(&source.records[i]);
  const MeshRange range = range_of(source, i);
  const TriangleIndices indices = source.indices[i];
  const Vec3* positions = source.positions + range.first_vertex;
  const std::uint32_t id = range.first_id + (i - range.first_triangle);
  return {positions[indices.v[0]], id,
          positions[indices.v[1]], range.material,
          positions[indices.v[2]], range.attributes};
}

__device__ bool is_usable(const Vec3& p) {  // false for NaN, too
  return fabsf(p.x) <= coordinate_max && fabsf(p.y) <= coordinate_max &&
         fabsf(p.z) <= coordinate_max;
}

struct Primitive {
  Bounds box;
  bool is_usable;
};

__device__ Primitive load_primitive(const TriangleSource& source, std::uint32_t i) {
  const Triangle t = load_triangle(source, i);
  return {hit_bounds(t.v0, t.v1, t.v2), is_usable(t.v0) && is_usable(t.v1) && is_usable(t.v2)};
}

// Lower bounds first, then inverted upper ones; all shrink.
__device__ void shrink(std::uint32_t (&bits)[12], int first, const Vec3& low, const Vec3& high) {
  PT_UNROLL(3)
  for (int i = 0; i < 3; ++i) {
    bits[first + i] = min(bits[first + i], ordered_bits(low[i]));
    bits[first + 3 + i] = min(bits[first + 3 + i], ~ordered_bits(high[i]));
  }
}

__global__ void __launch_bounds__(block_size)
    bound_primitives(TriangleSource source, std::uint32_t count, BuildNode* primitives,
                     SharedBounds* bounds) {
  std::uint32_t bits[12];
  PT_UNROLL(12)
  for (std::uint32_t& b : bits) b = 0xffffffffu;
  bool bad = false;
  const std::uint32_t step = gridDim.x * blockDim.x;
  for (std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x; i < count; i += step) {
    const auto [box, usable] = load_primitive(source, i);
    store_wide(&primitives[i], BuildNode{box.min, 0, box.max, 0});
    if (usable) {
      shrink(bits, 0, box.center(), box.center());
      shrink(bits, 6, box.min, box.max);
    } else {
      bad = true;
    }
  }
  __shared__ std::uint32_t block_bits[13];
  if (threadIdx.x < 13) block_bits[threadIdx.x] = 0xffffffffu;
  __syncthreads();
  PT_UNROLL(12)
  for (int k = 0; k < 12; ++k) {
    const std::uint32_t least = warp_min(bits[k]);
    if (threadIdx.x % 32 == 0) atomicMin(&block_bits[k], least);
  }
  if (bad) block_bits[12] = 0;
  __syncthreads();
  if (threadIdx.x < 12) atomicMin(&bounds->bits[threadIdx.x], block_bits[threadIdx.x]);
  if (threadIdx.x == 12 && block_bits[12] == 0) bounds->is_bad = 0;
}

__global__ void __launch_bounds__(block_size)
    write_triangles(TriangleSource source, const std::uint32_t* order, std::uint32_t count,
                    Triangle* triangles) {
  const std::uint32_t slot = blockIdx.x * blockDim.x + threadIdx.x;
  if (slot < count) store_wide(&triangles[slot], load_triangle(source, order[slot]));
}

}  // namespace

void enqueue_bounds(const TriangleSource& source, std::uint32_t count, BuildNode* primitives,
                    SharedBounds* bounds) {
  check_cuda(cudaMemsetAsync(bounds, 0xff, sizeof(SharedBounds)), "clear bounds");
  bound_primitives<<<resident_blocks(bound_primitives, count), block_size>>>(source, count,
                                                                             primitives, bounds);
  check_cuda(cudaGetLastError(), "bound_primitives");
}

void enqueue_triangles(const TriangleSource& source, const std::uint32_t* order,
                       std::uint32_t count, Triangle* triangles) {
  write_triangles<<<blocks_for(count), block_size>>>(source, order, count, triangles);
  check_cuda(cudaGetLastError(), "write_triangles");
}

namespace {

__global__ void __launch_bounds__(block_size)
    make_codes(const BuildNode* primitives, std::uint32_t count, const SharedBounds* bounds,
               std::uint64_t* keys, std::uint32_t* values) {
  const MortonGrid grid = make_morton_grid(read_bounds(*bounds, 0), morton_bits_max);
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  const Bounds box = load_wide(&primitives[i]).bounds();
  keys[i] = morton_code(grid, box.center());
  values[i] = i;
}

__global__ void __launch_bounds__(block_size)
    find_prefixes(const std::uint64_t* keys, std::uint32_t count, bool by_code,
                  std::uint8_t* prefixes) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;  // of i - 1 and i
  if (i > count) return;
  const bool is_end = i == 0 || i == count;
  const std::uint64_t code = is_end || !by_code ? 0 : keys[i];
  const std::uint64_t before = is_end || !by_code ? 0 : keys[i - 1];
  prefixes[i] = is_end ? std::uint8_t{0} : neighbour_prefix(before, code, i - 1);
}

std::uint64_t sort(SortBuffers& buffers, std::uint32_t count, void* scratch,
                   std::size_t scratch_bytes) {
  cub::DoubleBuffer<std::uint64_t> keys(buffers.keys[0], buffers.keys[1]);
  cub::DoubleBuffer<std::uint32_t> values(buffers.values[0], buffers.values[1]);
  check_cuda(cub::DeviceRadixSort::SortPairs(scratch, scratch_bytes, keys, values, count, 0,
                                             3 * morton_bits_max),
             "sorting Morton codes");
  if (scratch != nullptr) {
    buffers = {{keys.Current(), keys.Alternate()}, {values.Current(), values.Alternate()}};
  }
  return scratch_bytes;
}

}  // namespace

void enqueue_morton(const BuildNode* primitives, std::uint32_t count, const SharedBounds* bounds,
                    const SortBuffers& buffers) {
  make_codes<<<blocks_for(count), block_size>>>(primitives, count, bounds, buffers.keys[0],
                                                buffers.values[0]);
  check_cuda(cudaGetLastError(), "make_codes");
}

std::uint64_t sort_scratch_bytes(std::uint32_t count) {
  SortBuffers none{};
  return sort(none, count, nullptr, 0);
}

void enqueue_sort(SortBuffers& buffers, std::uint32_t count, void* scratch,
                  std::uint64_t scratch_bytes) {
  sort(buffers, count, scratch, scratch_bytes);
}

void enqueue_prefixes(const std::uint64_t* keys, std::uint32_t count, bool by_code,
                      std::uint8_t* prefixes) {
  find_prefixes<<<blocks_for(std::uint64_t{count} + 1), block_size>>>(keys, count, by_code,
                                                                      prefixes);
  check_cuda(cudaGetLastError(), "find_prefixes");
}

}  // namespace pt::device_build
