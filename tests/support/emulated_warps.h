// Warps of CUDA on the CPU, for code that votes: a thread for each lane, which meets the others of
// its warp wherever CUDA's lanes do. Include it before such code, in a file of its own.
#pragma once

#include <algorithm>
#include <atomic>
#include <barrier>
#include <bit>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#define __device__

class EmulatedWarp {
 public:
  /// What all lanes give, at [lane]; by all of them together.
  const std::uint32_t* exchange(unsigned lane, std::uint32_t value) {
    std::uint32_t* const values = values_[turn_[lane]];
    turn_[lane] ^= 1;  // the next exchange must not overwrite what slower lanes still read
    values[lane] = value;
    barrier_.arrive_and_wait();
    return values;
  }

 private:
  std::uint32_t values_[2][32] = {};
  int turn_[32] = {};
  std::barrier<> barrier_{32};
};

struct EmulatedIndex {
  unsigned x = 0;
};

struct uint2 {
  unsigned x, y;
};

inline thread_local EmulatedIndex threadIdx, blockDim, gridDim;
inline thread_local EmulatedWarp* emulated_warp = nullptr;
inline thread_local std::barrier<>* emulated_block = nullptr;

using std::max;
using std::min;

inline std::uint32_t __shfl_sync(unsigned, std::uint32_t value, int lane) {
  return emulated_warp->exchange(threadIdx.x % 32, value)[lane];
}
inline unsigned __ballot_sync(unsigned, bool vote) {
  const std::uint32_t* const votes = emulated_warp->exchange(threadIdx.x % 32, vote ? 1 : 0);
  unsigned result = 0;
  for (int lane = 0; lane < 32; ++lane) result |= votes[lane] << lane;
  return result;
}
inline void __syncwarp() { emulated_warp->exchange(threadIdx.x % 32, 0); }
inline void __syncthreads() { emulated_block->arrive_and_wait(); }
inline int __popc(unsigned x) { return std::popcount(x); }
inline std::uint32_t atomicAdd(std::uint32_t* sum, std::uint32_t x) {
  return std::atomic_ref(*sum).fetch_add(x);
}

/// Calls function() by all threads of a block of `warps` warps.
template <class Function>
void run_emulated_block(unsigned warps, Function&& function) {
  std::barrier<> block(32 * warps);
  std::vector<std::unique_ptr<EmulatedWarp>> all;
  for (unsigned w = 0; w < warps; ++w) all.push_back(std::make_unique<EmulatedWarp>());
  std::vector<std::jthread> threads;
  for (unsigned i = 0; i < 32 * warps; ++i) {
    threads.emplace_back([&, i] {
      threadIdx.x = i, blockDim.x = 32 * warps, gridDim.x = 1;
      emulated_warp = all[i / 32].get();
      emulated_block = &block;
      function();
    });
  }
}
