// What `ptexp doctor` makes of a machine's facts.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/doctor/machine.h"

namespace pt {

/// ok; warning: something is slow or left out; missing: something that this program was built for
/// does not work here.
enum class Health { ok, warning, missing };

std::string_view to_string(Health health);

struct Check {
  std::string name;
  Health health;
  std::string detail;
  std::string remedy;  ///< empty if ok
};

std::vector<Check> check_machine(const Machine& machine);

/// How the code of a build's CUDA architectures, a CMake list such as "75-virtual;90-real", gets to
/// run on a GPU of that compute capability.
enum class GpuCode {
  machine,  ///< machine code for it
  ptx,      ///< PTX, which the driver compiles first
  none,
  unknown  ///< an architecture's name says not which
};

GpuCode code_for(const std::string& architectures, int major, int minor);

}  // namespace pt
