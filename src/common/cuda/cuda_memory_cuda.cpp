#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <algorithm>
#include <cstring>

#include "common/cuda/cuda_check.cuh"
#include "common/cuda/cuda_memory.cuh"
#include "common/cuda/used_gpu.cuh"
#include "common/error/host_memory.h"

namespace pt {

void check_cuda(cudaError_t status, const char* what) {
  if (status == cudaSuccess) return;
  const std::string message = fmt::format("CUDA: {}: {}", what, cudaGetErrorString(status));
  cudaGetLastError();  // clears it, for what the process does next
  if (status == cudaErrorMemoryAllocation) throw OutOfMemory(message);
  throw Error(message);
}

CudaMemory::~CudaMemory() {
  for (void* pointer : pointers_) cudaFree(pointer);
}

std::uint64_t CudaMemory::free_bytes() {
  std::size_t free = 0, total = 0;
  check_cuda(cudaMemGetInfo(&free, &total), "cudaMemGetInfo");
  return free;
}

void* CudaMemory::allocate_bytes(const std::string& name, std::uint64_t size_bytes) {
  if (size_bytes == 0) return nullptr;
  void* pointer = nullptr;
  if (cudaMalloc(&pointer, size_bytes) != cudaSuccess) {
    cudaGetLastError();  // clears it
    throw OutOfMemory(memory_error("device memory", name, size_bytes, free_bytes()).what());
  }
  pointers_.push_back(pointer);
  for (BufferSize& entry : sizes_) {
    if (entry.name == name) {
      entry.size_bytes += size_bytes;
      return pointer;
    }
  }
  sizes_.push_back({name, size_bytes});
  return pointer;
}

namespace {

constexpr std::uint64_t piece_bytes = std::uint64_t{1} << 20;
constexpr std::uint64_t large_bytes = std::uint64_t{32} << 20;  // pays for pinning the pieces

}  // namespace

void CudaMemory::copy_to_device(void* device, const void* host, std::uint64_t size_bytes) {
  if (size_bytes == 0) return;
  if (size_bytes < large_bytes) {
    check_cuda(cudaMemcpy(device, host, size_bytes, cudaMemcpyHostToDevice), "cudaMemcpy");
    return;
  }
  if (upload_ == nullptr) upload_ = std::make_unique<CudaUpload>();
  upload_->copy(device, host, size_bytes);
}

void CudaUpload::allocate() {
  check_cuda(cudaGetDevice(&device_), "cudaGetDevice");
  for (Lane& lane : lanes_) {
    check_cuda(cudaStreamCreateWithFlags(&lane.stream, cudaStreamNonBlocking), "cudaStreamCreate");
    for (int i = 0; i < 2; ++i) {
      check_cuda(cudaMallocHost(reinterpret_cast<void**>(&lane.pieces[i]), piece_bytes),
                 "cudaMallocHost");
      check_cuda(cudaEventCreateWithFlags(&lane.copied[i], cudaEventDisableTiming),
                 "cudaEventCreate");
    }
  }
}

CudaUpload::~CudaUpload() {
  for (const Lane& lane : lanes_) {
    if (lane.stream != nullptr) cudaStreamSynchronize(lane.stream);
    for (int i = 0; i < 2; ++i) {
      cudaFreeHost(lane.pieces[i]);
      if (lane.copied[i] != nullptr) cudaEventDestroy(lane.copied[i]);
    }
    if (lane.stream != nullptr) cudaStreamDestroy(lane.stream);
  }
}

void CudaUpload::copy(void* to, const void* from, std::uint64_t size_bytes) {
  if (lanes_[0].stream == nullptr) allocate();
  // What was given to the default stream before may use the memory.
  check_cuda(cudaStreamSynchronize(nullptr), "uploading");
  tbb::parallel_for(
      0, lanes,
      [&](int lane) {
        copy_every(lane, static_cast<char*>(to), static_cast<const char*>(from), size_bytes);
      },
      tbb::simple_partitioner());
}

/// Every piece that is the lane's.
void CudaUpload::copy_every(int lane_index, char* to, const char* from, std::uint64_t size_bytes) {
  reach_gpu(device_);
  const Lane& lane = lanes_[lane_index];
  int turn = 0;
  for (std::uint64_t at = lane_index * piece_bytes; at < size_bytes; at += lanes * piece_bytes) {
    const std::uint64_t count = std::min(piece_bytes, size_bytes - at);
    check_cuda(cudaEventSynchronize(lane.copied[turn]), "uploading");  // at first nothing
    std::memcpy(lane.pieces[turn], from + at, count);
    check_cuda(
        cudaMemcpyAsync(to + at, lane.pieces[turn], count, cudaMemcpyHostToDevice, lane.stream),
        "uploading");
    check_cuda(cudaEventRecord(lane.copied[turn], lane.stream), "cudaEventRecord");
    turn = 1 - turn;
  }
  check_cuda(cudaStreamSynchronize(lane.stream), "uploading");
}

namespace {

constexpr std::uint64_t grain_bytes = std::uint64_t{256} << 10;  // that a thread copies at least

void copy_by_threads(char* to, const char* from, std::uint64_t size_bytes) {
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, size_bytes, grain_bytes),
                    [&](const tbb::blocked_range<std::uint64_t>& range) {
                      std::memcpy(to + range.begin(), from + range.begin(), range.size());
                    });
}

}  // namespace

CudaDownload::~CudaDownload() {
  for (int i = 0; i < 2; ++i) {
    cudaFreeHost(pieces_[i]);
    if (filled_[i] != nullptr) cudaEventDestroy(filled_[i]);
  }
}

void CudaDownload::allocate() {
  for (int i = 0; i < 2; ++i) {
    check_cuda(cudaMallocHost(reinterpret_cast<void**>(&pieces_[i]), piece_bytes),
               "cudaMallocHost");
    check_cuda(cudaEventCreateWithFlags(&filled_[i], cudaEventDisableTiming), "cudaEventCreate");
  }
}

void CudaDownload::copy(void* to, const void* from, std::uint64_t size_bytes, cudaStream_t stream) {
  if (pieces_[0] == nullptr && size_bytes > 0) allocate();
  const std::uint64_t count = (size_bytes + piece_bytes - 1) / piece_bytes;
  const auto size_of = [&](std::uint64_t i) {
    return std::min(piece_bytes, size_bytes - i * piece_bytes);
  };
  const auto fill = [&](std::uint64_t i) {
    check_cuda(cudaMemcpyAsync(pieces_[i % 2], static_cast<const char*>(from) + i * piece_bytes,
                               size_of(i), cudaMemcpyDeviceToHost, stream),
               "downloading");
    check_cuda(cudaEventRecord(filled_[i % 2], stream), "cudaEventRecord");
  };
  if (count > 0) fill(0);
  for (std::uint64_t i = 0; i < count; ++i) {
    if (i + 1 < count) fill(i + 1);
    check_cuda(cudaEventSynchronize(filled_[i % 2]), "downloading");
    copy_by_threads(static_cast<char*>(to) + i * piece_bytes, pieces_[i % 2], size_of(i));
  }
}

}  // namespace pt
