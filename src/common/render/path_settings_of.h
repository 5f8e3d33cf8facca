// The path settings of a render.
#pragma once

#include "common/options/options.h"
#include "common/transport/path_settings.h"

namespace pt {

inline PathSettings path_settings_of(const ImageSettings& settings) {
  return {static_cast<std::uint32_t>(settings.max_depth),
          static_cast<std::uint32_t>(settings.rr_depth), settings.nee, settings.sampling,
          settings.mis};
}

}  // namespace pt
