// What the loading of a file tells the user.
#pragma once

#include <set>
#include <string>

#include "common/scene/load/files/load_options.h"
#include "common/scene/load/pbrt/syntax/place.h"

namespace pt::pbrt {

class Reporter {
 public:
  /// `load_options` outlive it.
  explicit Reporter(const LoadOptions& load_options) : options_(load_options) {}

  /// Reports what is replaced or ignored, once for each `kind`.
  void warn_once(const std::string& kind, const Place& place, const std::string& message) {
    if (warned_.insert(kind).second) options_.report(message_at(place, message));
  }

  /// Says what was chosen where the file leaves it open.
  void note(const Place& place, const std::string& message) const {
    if (options_.warn) options_.warn(message_at(place, message));
  }

  const LoadOptions& options() const { return options_; }

 private:
  const LoadOptions& options_;
  std::set<std::string> warned_;
};

}  // namespace pt::pbrt
