#include "app/render/scene_defaults.h"

#include <limits>

namespace pt {

void apply_defaults(const SceneDefaults& defaults, const GivenOptions& given, Options& options) {
  const auto apply = [&](const char* name, const std::optional<int>& value, int Options::*field) {
    if (value && !given.contains(name)) options.*field = *value;
  };
  apply("width", defaults.width, &Options::width);
  apply("height", defaults.height, &Options::height);
  apply("spp", defaults.spp, &Options::spp);
  apply("max-depth", defaults.max_depth, &Options::max_depth);
  apply("rr", defaults.rr_depth, &Options::rr_depth);
  if (!options.crop) options.crop = defaults.crop;
  if (!options.filter) options.filter = defaults.filter;
  check_crop(options);
  // A stop is asked to decide: the number of samples does only where it is given.
  const bool has_stop = options.time_limit > 0 || options.target_error > 0;
  if (has_stop && !given.contains("spp")) options.spp = std::numeric_limits<int>::max();
}

}  // namespace pt
