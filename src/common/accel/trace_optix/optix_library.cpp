#include "common/accel/trace_optix/optix_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#include "common/error/error.h"

namespace pt {
namespace {

/// PTEXP_OPTIX_LOG=1..4: OptiX's messages up to this level go to stderr; unset: none.
int log_level() {
  const char* text = std::getenv("PTEXP_OPTIX_LOG");
  return text == nullptr ? 0 : std::atoi(text);
}

void log_message(unsigned level, const char* tag, const char* message, void*) {
  std::fprintf(stderr, "OptiX [%u] %s: %s\n", level, tag, message);
}

}  // namespace

OptixLibrary::OptixLibrary() {
  const char* named = std::getenv("PTEXP_OPTIX_LIBRARY");
  path_ = named != nullptr ? named : "libnvoptix.so.1";
  handle_ = dlopen(path_.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle_ == nullptr) {
    throw Error(fmt::format("OptiX: cannot load {}, which NVIDIA's driver brings ({})",
                            in_quotes(path_), clipped(dlerror(), 200)));
  }
  try {
    const auto query =
        reinterpret_cast<optix::QueryFunctionTable>(dlsym(handle_, "optixQueryFunctionTable"));
    if (query == nullptr)
      throw Error(fmt::format("OptiX: {} has no optixQueryFunctionTable", in_quotes(path_)));
    const optix::Result result =
        query(optix::abi_version, 0, nullptr, nullptr, &table_, sizeof table_);
    if (result != optix::success) {
      throw Error(fmt::format(
          "OptiX: {} does not know ABI {} with {} functions (error {}{}); expected a driver from "
          "535 on",
          in_quotes(path_), optix::abi_version, optix::table_pointers, result,
          result == optix::error_unsupported_abi ? ", unsupported ABI"
          : result == optix::error_table_size    ? ", size of the table"
                                                 : ""));
    }
  } catch (...) {
    dlclose(handle_);
    throw;
  }
}

OptixLibrary::~OptixLibrary() { dlclose(handle_); }

void OptixLibrary::check(optix::Result result, const char* call, const std::string& log) const {
  if (result == optix::success) return;
  const char* name = table_.error_name != nullptr ? table_.error_name(result) : nullptr;
  throw Error(fmt::format("OptiX: {} failed: {} ({}){}", call, name != nullptr ? name : "unknown",
                          result, log.empty() ? "" : ": " + clipped(log, 1000)));
}

OptixContext::OptixContext(std::shared_ptr<const OptixLibrary> library)
    : library_(std::move(library)) {
  optix::ContextOptions options{};
  options.log_level = log_level();
  if (options.log_level > 0) options.log = log_message;
  library_->check(functions().context_create(nullptr, &options, &context_),
                  "optixDeviceContextCreate");
}

OptixContext::~OptixContext() { functions().context_destroy(context_); }

unsigned OptixContext::property(int property) const {
  unsigned value = 0;
  library_->check(functions().context_property(context_, property, &value, sizeof value),
                  "optixDeviceContextGetProperty");
  return value;
}

}  // namespace pt
