// What the options say of a path's length.
#pragma once

#include "common/options/options.h"
#include "common/transport/path_limits.h"

namespace pt {

inline PathLimits path_limits_of(const ImageSettings& settings) {
  return {static_cast<std::uint32_t>(settings.max_depth),
          static_cast<std::uint32_t>(settings.rr_depth), settings.nee, settings.sampling,
          settings.mis};
}

}  // namespace pt
