// Names for the time line of a profiler.
#pragma once

#include <nvtx3/nvToolsExt.h>

#include <string>

namespace pt {

/// A range of the host's time line in Nsight Systems (NVTX), as long as it lives. Ranges nest; the
/// kernels launched in one are shown as its own.
class ProfilerRange {
 public:
  explicit ProfilerRange(const char* name) { nvtxRangePushA(name); }
  explicit ProfilerRange(const std::string& name) : ProfilerRange(name.c_str()) {}
  ~ProfilerRange() { nvtxRangePop(); }
  ProfilerRange(const ProfilerRange&) = delete;
  ProfilerRange& operator=(const ProfilerRange&) = delete;
};

}  // namespace pt
