#include <dlfcn.h>
#include <fmt/format.h>

#include <chrono>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "common/cuda/cuda_check.cuh"
#include "common/cuda/used_gpu.cuh"
#include "common/error/error.h"

namespace pt {
namespace {

thread_local int used_sms = 0;  // of a part, 0: the whole GPU

int count_multiprocessors(int index) {
  int count = 0;
  check_cuda(cudaDeviceGetAttribute(&count, cudaDevAttrMultiProcessorCount, index),
             "cudaDeviceGetAttribute");
  return count;
}

void use_whole_gpu(int index) {
  check_cuda(cudaSetDevice(index), "cudaSetDevice");
  used_sms = 0;
}

/// Green contexts that nobody uses. They stay until the process ends: a thread may still have one
/// as its current context, and the next render wants one of the same size.
class IdleContexts {
 public:
  std::unique_ptr<GreenContext> take(int index, int sms) {
    {
      const std::lock_guard lock(mutex_);
      auto& idle = contexts_[{index, sms}];
      if (!idle.empty()) {
        std::unique_ptr<GreenContext> context = std::move(idle.back());
        idle.pop_back();
        return context;
      }
    }
    static const GreenDriver driver = load_green_driver(find_in_driver);
    return std::make_unique<GreenContext>(driver, index, sms);
  }

  void give_back(int index, int sms, std::unique_ptr<GreenContext> context) {
    const std::lock_guard lock(mutex_);
    contexts_[{index, sms}].push_back(std::move(context));
  }

 private:
  std::mutex mutex_;
  std::map<std::pair<int, int>, std::vector<std::unique_ptr<GreenContext>>> contexts_;
};

IdleContexts& idle_contexts() {
  static auto* const contexts = new IdleContexts;  // the driver may end before destructors run
  return *contexts;
}

}  // namespace

void* find_in_driver(const char* name) {
  static void* const driver = dlopen("libcuda.so.1", RTLD_NOW | RTLD_LOCAL);
  return driver != nullptr ? dlsym(driver, name) : nullptr;
}

void reach_gpu(int index) {
  int current = -1;
  check_cuda(cudaGetDevice(&current), "cudaGetDevice");
  if (current != index) use_whole_gpu(index);
}

int used_multiprocessors() {
  if (used_sms > 0) return used_sms;
  int index = 0;
  check_cuda(cudaGetDevice(&index), "cudaGetDevice");
  return count_multiprocessors(index);
}

GreenDriver load_green_driver(void* (*find)(const char* name)) {
  const auto load = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(find(name));
    if (function == nullptr)
      throw Error(
          fmt::format("--sms: the driver has no {}; expected one of CUDA 12.4 or newer", name));
  };
  GreenDriver driver{};
  load(driver.error_string, "cuGetErrorString");
  load(driver.device, "cuDeviceGet");
  load(driver.resource, "cuDeviceGetDevResource");
  load(driver.split, "cuDevSmResourceSplitByCount");
  load(driver.describe, "cuDevResourceGenerateDesc");
  load(driver.create, "cuGreenCtxCreate");
  load(driver.destroy, "cuGreenCtxDestroy");
  load(driver.context_of, "cuCtxFromGreenCtx");
  load(driver.set_current, "cuCtxSetCurrent");
  return driver;
}

GreenContext::GreenContext(const GreenDriver& driver, int index, int sms)
    : driver_(driver), sms_(sms) {
  CUdevice device{};
  check(driver_.device(&device, index), "cuDeviceGet");
  CUdevResource all{}, part{};
  check(driver_.resource(device, &all, CU_DEV_RESOURCE_TYPE_SM), "cuDeviceGetDevResource");
  whole_ = static_cast<int>(all.sm.smCount);
  unsigned groups = 1;
  const CUresult divided =
      driver_.split(&part, &groups, &all, nullptr, 0, static_cast<unsigned>(sms));
  if (divided == CUDA_ERROR_INVALID_RESOURCE_CONFIGURATION || divided == CUDA_ERROR_INVALID_VALUE)
    groups = 0;
  else
    check(divided, "cuDevSmResourceSplitByCount");
  const int given = groups > 0 ? static_cast<int>(part.sm.smCount) : 0;
  if (given != sms)
    throw Error(fmt::format(
        "--sms {}: of this GPU's {} multiprocessors the driver gives {} instead; expected a number "
        "that it gives (multiples of 8 on compute capability 9.0) or all",
        sms, whole_, given));
  CUdevResourceDesc description{};
  check(driver_.describe(&description, &part, 1), "cuDevResourceGenerateDesc");
  check(driver_.create(&green_, description, device, CU_GREEN_CTX_DEFAULT_STREAM),
        "cuGreenCtxCreate");
  const CUresult converted = driver_.context_of(&context_, green_);
  if (converted != CUDA_SUCCESS) driver_.destroy(green_);
  check(converted, "cuCtxFromGreenCtx");
}

void GreenContext::use() const { check(driver_.set_current(context_), "cuCtxSetCurrent"); }

void GreenContext::check(CUresult result, const char* what) const {
  if (result == CUDA_SUCCESS) return;
  const char* reason = nullptr;
  driver_.error_string(result, &reason);
  throw Error(fmt::format("--sms {}: {}: {}", sms_, what,
                          reason != nullptr ? reason : std::to_string(result).c_str()));
}

UsedGpu::UsedGpu(int index, int sms) : index_(index), sms_(sms) {
  const auto begin = std::chrono::steady_clock::now();
  use_whole_gpu(index);  // makes its context, of which a green one is a part
  if (sms > 0 && sms != count_multiprocessors(index)) part_ = idle_contexts().take(index, sms);
  use();
  opening_ms_ =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

UsedGpu::~UsedGpu() {
  if (part_ != nullptr) idle_contexts().give_back(index_, sms_, std::move(part_));
}

void UsedGpu::use() const {
  if (part_ == nullptr) return use_whole_gpu(index_);
  part_->use();
  used_sms = sms_;
}

std::string UsedGpu::part_text() const {
  return is_part() ? fmt::format(", {} of {} multiprocessors", sms_, part_->whole()) : "";
}

}  // namespace pt
