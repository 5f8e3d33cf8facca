// The memory and the stream that OptiX works on: a GPU's, or in tests, whose OptiX is a library of
// their own, the host's.
#pragma once

#include <cstddef>

#include "common/accel/trace_optix/optix_abi.h"
#include "common/geometry/triangle.h"

namespace pt {

/// How far the boxes of custom primitives go beyond hit_bounds (docs/design/optix.md).
struct OptixBoxMargin {
  float absolute = 0;  ///< in the triangles' space
};

class OptixMemory {
 public:
  virtual ~OptixMemory() = default;

  /// Throws Error where there is too little; `what` is named.
  virtual void* allocate(std::size_t bytes, const char* what) = 0;
  virtual void release(void* memory) noexcept = 0;
  /// Both wait until what was enqueued before has run.
  virtual void to_device(void* to, const void* from, std::size_t bytes) = 0;
  virtual void to_host(void* to, const void* from, std::size_t bytes) = 0;
  /// Enqueues a copy of what `from` holds at the time of the call.
  virtual void enqueue_to_device(void* to, const void* from, std::size_t bytes) = 0;
  virtual void synchronize() = 0;
  virtual optix::Stream stream() const = 0;
  /// Enqueues boxes[i] = the box of triangles[i]; both on the device.
  virtual void enqueue_boxes(optix::Box* boxes, const Triangle* triangles, std::size_t count,
                             const OptixBoxMargin& margin) = 0;
};

/// The box of a custom primitive.
PT_HD optix::Box optix_box(const Triangle& triangle, const OptixBoxMargin& margin) {
  const Bounds box = hit_bounds(triangle.v0, triangle.v1, triangle.v2);
  optix::Box result;
  for (int i = 0; i < 3; ++i) {
    result.min[i] = lowered(box.min[i], margin.absolute);
    result.max[i] = raised(box.max[i], margin.absolute);
  }
  return result;
}

/// Memory that is released with the object.
class OptixBuffer {
 public:
  OptixBuffer() = default;
  OptixBuffer(OptixMemory& memory, std::size_t bytes, const char* what)
      : memory_(&memory), data_(memory.allocate(bytes, what)), bytes_(bytes) {}
  ~OptixBuffer() { reset(); }
  OptixBuffer(OptixBuffer&& other) noexcept { *this = static_cast<OptixBuffer&&>(other); }
  OptixBuffer& operator=(OptixBuffer&& other) noexcept {
    if (this == &other) return *this;
    reset();
    memory_ = other.memory_, data_ = other.data_, bytes_ = other.bytes_;
    other.data_ = nullptr, other.bytes_ = 0;
    return *this;
  }

  void reset() noexcept {
    if (data_ != nullptr) memory_->release(data_);
    data_ = nullptr, bytes_ = 0;
  }
  void* get() const { return data_; }
  optix::DevicePointer address() const { return reinterpret_cast<optix::DevicePointer>(data_); }
  std::size_t bytes() const { return bytes_; }

 private:
  OptixMemory* memory_ = nullptr;
  void* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace pt
