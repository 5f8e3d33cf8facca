// OptiX's library, which the driver brings, loaded when it is asked for.
#pragma once

#include <memory>
#include <string>

#include "common/accel/trace_optix/optix_abi.h"

namespace pt {

/// The function table of libnvoptix.so.1, or of the library that the environment variable
/// PTEXP_OPTIX_LIBRARY names.
class OptixLibrary {
 public:
  /// Throws Error where there is no library, or one that does not know optix::abi_version.
  OptixLibrary();
  ~OptixLibrary();
  OptixLibrary(const OptixLibrary&) = delete;
  OptixLibrary& operator=(const OptixLibrary&) = delete;

  const optix::FunctionTable& functions() const { return table_; }
  const std::string& path() const { return path_; }

  /// Throws Error with OptiX's name of it unless `result` is a success; `log`: what the call wrote.
  void check(optix::Result result, const char* call, const std::string& log = {}) const;

 private:
  std::string path_;
  void* handle_ = nullptr;
  optix::FunctionTable table_{};
};

/// A context on the current CUDA context.
class OptixContext {
 public:
  explicit OptixContext(std::shared_ptr<const OptixLibrary> library);
  ~OptixContext();
  OptixContext(const OptixContext&) = delete;
  OptixContext& operator=(const OptixContext&) = delete;

  const OptixLibrary& library() const { return *library_; }
  const optix::FunctionTable& functions() const { return library_->functions(); }
  optix::Context get() const { return context_; }
  unsigned property(int property) const;

  /// Of RT cores, "10" for version 1.0; 0: the device has none.
  unsigned rtcore_version() const { return property(optix::property_rtcore_version); }

  /// Whether the device reorders threads where programs ask for it; elsewhere that does nothing.
  bool reorders() const { return property(optix::property_reordering) != 0; }

 private:
  std::shared_ptr<const OptixLibrary> library_;
  optix::Context context_ = nullptr;
};

}  // namespace pt
