// A block of CUDA's threads on the CPU, for device code that needs no more of CUDA than threads,
// votes, shuffles, barriers and atomic additions. Each thread is a fiber that runs until it must
// wait for others. Include it before the device code.
#pragma once

#include <ucontext.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <vector>

#include "common/platform/platform.h"

#define __device__
#define __forceinline__ inline

struct uint2 {
  std::uint32_t x, y;
};
struct alignas(16) uint4 {
  std::uint32_t x, y, z, w;
};
struct alignas(16) float4 {
  float x, y, z, w;
};

namespace pt {

/// Runs a function in all threads of a block.
class EmulatedBlock {
 public:
  struct Place {
    std::uint32_t x = 0;
  };

  explicit EmulatedBlock(std::uint32_t threads) : threads_(threads), warps_(threads / 32) {}

  void run(const std::function<void()>& function) {
    current_block = this;
    function_ = &function;
    for (Thread& thread : threads_) prepare(thread);
    for (bool advances = true; advances;) {
      advances = false;
      for (Thread& thread : threads_) {
        if (thread.is_done || is_waiting(thread)) continue;
        advances = true;
        running_ = &thread;
        swapcontext(&scheduler_, &thread.context);
      }
    }
    // Some thread waits for one that has gone another way.
    if (!std::ranges::all_of(threads_, &Thread::is_done)) std::abort();
    current_block = nullptr;
  }

  static EmulatedBlock& current() { return *current_block; }
  Place thread() const { return {static_cast<std::uint32_t>(running_ - threads_.data())}; }
  Place size() const { return {static_cast<std::uint32_t>(threads_.size())}; }

  /// The values of all threads of the warp, which meet here.
  const std::uint32_t* exchange(std::uint32_t mask, std::uint32_t value) {
    if (mask != 0xffffffffu) std::abort();
    const std::uint32_t thread_index = thread().x;
    return warps_[thread_index / 32].exchange(*this, thread_index % 32, value);
  }
  void meet_block() {
    const std::uint32_t turn = block_turn_;
    if (++arrived_ == threads_.size()) {
      arrived_ = 0, ++block_turn_;
    } else {
      wait(block_turn_, turn);
    }
  }

 private:
  static constexpr std::size_t stack_bytes = 1 << 18;

  struct Thread {
    ucontext_t context;
    std::unique_ptr<char[]> stack;
    const std::uint32_t* turn = nullptr;  ///< waits until this is no longer `seen`
    std::uint32_t seen = 0;
    bool is_done = false;
  };

  struct Warp {
    std::uint32_t values[32], results[32], arrived = 0, turn = 0;

    const std::uint32_t* exchange(EmulatedBlock& block, std::uint32_t lane, std::uint32_t value) {
      values[lane] = value;
      const std::uint32_t seen = turn;
      if (++arrived == 32) {
        std::memcpy(results, values, sizeof results);
        arrived = 0, ++turn;
      } else {
        block.wait(turn, seen);
      }
      return results;
    }
  };

  static bool is_waiting(const Thread& thread) {
    return thread.turn != nullptr && *thread.turn == thread.seen;
  }

  void wait(const std::uint32_t& turn, std::uint32_t seen) {
    Thread& thread = *running_;
    thread.turn = &turn, thread.seen = seen;
    swapcontext(&thread.context, &scheduler_);
    thread.turn = nullptr;
  }

  void prepare(Thread& thread) {
    thread.stack = std::make_unique<char[]>(stack_bytes);
    thread.is_done = false;
    getcontext(&thread.context);
    thread.context.uc_stack.ss_sp = thread.stack.get();
    thread.context.uc_stack.ss_size = stack_bytes;
    thread.context.uc_link = &scheduler_;
    makecontext(&thread.context, &EmulatedBlock::run_thread, 0);
  }

  static void run_thread() {
    (*current().function_)();
    current().running_->is_done = true;
  }

  inline static EmulatedBlock* current_block = nullptr;

  std::vector<Thread> threads_;
  std::vector<Warp> warps_;
  const std::function<void()>* function_ = nullptr;
  ucontext_t scheduler_;
  Thread* running_ = nullptr;
  std::size_t arrived_ = 0;
  std::uint32_t block_turn_ = 0;
};

}  // namespace pt

#define threadIdx (pt::EmulatedBlock::current().thread())
#define blockDim (pt::EmulatedBlock::current().size())
#define gridDim (pt::EmulatedBlock::Place{1})

// What CUDA has, by its names.
using std::max;
using std::min;

inline int __popc(std::uint32_t x) { return __builtin_popcount(x); }
inline int __ffs(std::uint32_t x) { return __builtin_ffs(static_cast<int>(x)); }
inline float __uint_as_float(std::uint32_t x) { return pt::bits_to_float(x); }
inline std::uint32_t __float_as_uint(float x) { return pt::float_to_bits(x); }
inline float __int_as_float(int x) { return pt::bits_to_float(static_cast<std::uint32_t>(x)); }
inline int __float_as_int(float x) { return static_cast<int>(pt::float_to_bits(x)); }
inline float __fmaf_rn(float a, float b, float c) { return std::fma(a, b, c); }
inline std::uint32_t __funnelshift_l(std::uint32_t low, std::uint32_t high, int shift) {
  return high << shift | low >> (32 - shift);
}
/// Byte i is that of x and y, one behind the other, which digit i of `select` names.
inline std::uint32_t __byte_perm(std::uint32_t x, std::uint32_t y, std::uint32_t select) {
  const std::uint64_t bytes = std::uint64_t{y} << 32 | x;
  std::uint32_t result = 0;
  for (int i = 0; i < 4; ++i) {
    const std::uint32_t digit = select >> 4 * i & 7u;
    result |= static_cast<std::uint32_t>(bytes >> 8 * digit & 0xffu) << 8 * i;
  }
  return result;
}
inline int __vimax3_s32_relu(int a, int b, int c) { return std::max({a, b, c, 0}); }
inline int __vimin3_s32(int a, int b, int c) { return std::min({a, b, c}); }
template <class T>
T __ldg(const T* p) {
  return *p;
}
/// Two 16-bit values of `a` times two bytes of `b`.
inline std::uint32_t dot_bytes(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return (a & 0xffffu) * (b & 0xffu) + (a >> 16) * (b >> 8 & 0xffu) + c;
}
inline std::uint32_t __dp2a_lo(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return dot_bytes(a, b, c);
}
inline std::uint32_t __dp2a_hi(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return dot_bytes(a, b >> 16, c);
}

inline std::uint32_t __ballot_sync(std::uint32_t mask, bool value) {
  const std::uint32_t* const values = pt::EmulatedBlock::current().exchange(mask, value ? 1 : 0);
  std::uint32_t votes = 0;
  for (int lane = 0; lane < 32; ++lane) votes |= values[lane] << lane;
  return votes;
}
inline bool __any_sync(std::uint32_t mask, bool value) { return __ballot_sync(mask, value) != 0; }
inline std::uint32_t __shfl_sync(std::uint32_t mask, std::uint32_t value, int lane) {
  return pt::EmulatedBlock::current().exchange(mask, value)[lane & 31];
}
inline std::uint32_t __match_any_sync(std::uint32_t mask, int value) {
  const auto mine = static_cast<std::uint32_t>(value);
  const std::uint32_t* const values = pt::EmulatedBlock::current().exchange(mask, mine);
  std::uint32_t peers = 0;
  for (int lane = 0; lane < 32; ++lane) peers |= (values[lane] == mine ? 1u : 0u) << lane;
  return peers;
}
inline void __syncwarp() { pt::EmulatedBlock::current().exchange(0xffffffffu, 0); }
inline void __syncthreads() { pt::EmulatedBlock::current().meet_block(); }
/// Threads change in waits alone.
inline std::uint32_t atomicAdd(std::uint32_t* p, std::uint32_t value) {
  const std::uint32_t old = *p;
  *p += value;
  return old;
}
