// What the options say of a path's length.
#pragma once

#include "common/options/options.h"
#include "common/transport/path_limits.h"

namespace pt {

inline PathLimits path_limits_of(const Options& options) {
  return {static_cast<std::uint32_t>(options.max_depth),
          static_cast<std::uint32_t>(options.rr_depth), options.nee, options.sampling, options.mis};
}

}  // namespace pt
