// Which GPU a thread uses, whole or as some of its multiprocessors (--sms), by a green context.
#pragma once

#include <cuda.h>
#include <cuda_runtime_api.h>

#include <memory>
#include <string>

namespace pt {

/// Makes the GPU the thread's, unless it uses it already, whole or in part: enough for its memory.
/// Throws Error.
void reach_gpu(int index);

/// Of the part that the thread uses, or of its GPU, whose own count is no other in a green context.
int used_multiprocessors();

/// The address of one of the driver's functions; null where the driver is missing or too old.
void* find_in_driver(const char* name);

/// The driver's functions for green contexts. They are looked up: programs start where no driver
/// is, or an older one. Tests have others.
struct GreenDriver {
  decltype(&cuGetErrorString) error_string;
  decltype(&cuDeviceGet) device;
  decltype(&cuDeviceGetDevResource) resource;
  decltype(&cuDevSmResourceSplitByCount) split;
  decltype(&cuDevResourceGenerateDesc) describe;
  decltype(&cuGreenCtxCreate) create;
  decltype(&cuGreenCtxDestroy) destroy;
  decltype(&cuCtxFromGreenCtx) context_of;
  decltype(&cuCtxSetCurrent) set_current;
};

/// Throws Error where one is missing. `find`: its address by name, or null.
GreenDriver load_green_driver(void* (*find)(const char* name));

/// Some of a GPU's multiprocessors. Memory is that of the whole GPU.
class GreenContext {
 public:
  /// Throws Error unless the driver gives exactly `sms` of them.
  GreenContext(const GreenDriver& driver, int device, int sms);
  GreenContext(const GreenContext&) = delete;
  GreenContext& operator=(const GreenContext&) = delete;
  ~GreenContext() { driver_.destroy(green_); }

  /// The calling thread launches there from now on. By the driver's documentation, one thread at a
  /// time. Throws Error.
  void use() const;
  int whole() const { return whole_; }  ///< multiprocessors of the GPU

 private:
  void check(CUresult result, const char* what) const;

  GreenDriver driver_;
  int sms_, whole_ = 0;
  CUgreenCtx green_ = nullptr;
  CUcontext context_ = nullptr;
};

/// A GPU, or `sms` of its multiprocessors (0: all). Each object has a green context of its own.
class UsedGpu {
 public:
  /// The calling thread uses it from now on. Throws Error.
  explicit UsedGpu(int index, int sms = 0);
  UsedGpu(const UsedGpu&) = delete;
  UsedGpu& operator=(const UsedGpu&) = delete;
  ~UsedGpu();

  /// So does this one. Throws Error.
  void use() const;

  int index() const { return index_; }
  bool is_part() const { return part_ != nullptr; }
  /// ", 16 of 132 multiprocessors" of a part, else empty.
  std::string part_text() const;
  /// What the GPU's contexts took to make.
  double opening_ms() const { return opening_ms_; }

 private:
  int index_, sms_;
  double opening_ms_ = 0;
  std::unique_ptr<GreenContext> part_;  ///< null: the whole GPU
};

}  // namespace pt
