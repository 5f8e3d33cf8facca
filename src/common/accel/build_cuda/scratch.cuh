// Temporary device memory of the builders.
#pragma once

#include <cstdint>

namespace pt::device_build {

/// Device memory that grows when needed and is divided again by each build.
class Scratch {
 public:
  Scratch() = default;
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() { release(); }

  void release();

  /// The layout is asked for twice: first to measure (null pointers), then to divide.
  template <class Layout>
  void divide(Layout&& layout) {
    used_ = 0;
    measures_ = true;
    layout(*this);
    const std::uint64_t needed = used_;
    if (needed > capacity_) reserve(needed);
    used_ = 0;
    measures_ = false;
    layout(*this);
  }

  std::uint64_t size_bytes() const { return capacity_; }

  template <class T>
  T* take(std::uint64_t count) {
    constexpr std::uint64_t alignment = 256;
    const std::uint64_t begin = used_;
    used_ += (count * sizeof(T) + alignment - 1) / alignment * alignment;
    return measures_ ? nullptr : reinterpret_cast<T*>(static_cast<char*>(memory_) + begin);
  }

 private:
  void reserve(std::uint64_t size_bytes);

  void* memory_ = nullptr;
  std::uint64_t capacity_ = 0, used_ = 0;
  bool measures_ = false;
};

}  // namespace pt::device_build
