// A libnvoptix.so of the tests' own (tests/accel/fake_optix.cpp): it keeps what it is told, fails
// where a test wants it to, and lets the test run launches.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/accel/trace_optix/optix_abi.h"

namespace pt {

struct FakeOptix {
  /// What accel_build was given; pointers are the host's.
  struct Structure {
    std::vector<optix::Box> boxes;
    const char* vertices = nullptr;  ///< of triangles, 48 bytes each
    unsigned count = 0;
    std::vector<optix::Instance> instances;
  };
  /// Of a launch, by their names.
  struct Launch {
    std::string raygen;
    std::vector<optix::ProgramGroupDescription> hit;  ///< by record
    const void* params;
    std::size_t params_bytes;
    unsigned width;
  };

  std::vector<std::string> calls;
  int fail_at = -1;  ///< number of the call that fails, counted from 0
  optix::Result error = 7900;
  int known_abi = optix::abi_version;
  std::size_t pointers = optix::table_pointers;
  unsigned primitives_max = 1u << 29, instances_max = 1u << 24, rtcore_version = 0, reordering = 0;
  int live = 0;                       ///< objects that are not destroyed
  std::string code;                   ///< of the last module
  std::string constants;              ///< of its parameters, from the first byte on
  optix::PipelineOptions pipeline{};  ///< options of the last pipeline
  std::map<optix::TraversableHandle, Structure> structures;
  std::function<void(const Launch&)> run;

  void reset() { *this = FakeOptix(); }
};

/// The library's one other symbol, "fake_optix".
using GetFakeOptix = FakeOptix* (*)();

}  // namespace pt
