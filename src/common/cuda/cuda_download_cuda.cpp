#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>

#include "common/cuda/cuda_check.cuh"
#include "common/cuda/cuda_download.cuh"

namespace pt {
namespace {

constexpr std::uint64_t piece_bytes = std::uint64_t{4} << 20;
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
