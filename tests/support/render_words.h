// Renders in this process by words of the command line.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/options/check_options.h"
#include "app/render/render_session.h"
#include "common/image/compare/compare.h"

namespace pt {

/// Options with their values.
using OptionWords = std::vector<std::pair<std::string, std::string>>;

/// Those of `words`, then those of `more`.
inline std::vector<Setting> settings_from(OptionWords words, const OptionWords& more = {}) {
  words.insert(words.end(), more.begin(), more.end());
  std::vector<Setting> settings;
  for (const auto& [name, value] : words) settings.push_back({&find_option(name), value});
  return settings;
}

inline RenderCommand command_from(const OptionWords& words, const OptionWords& more = {}) {
  return make_render_command(settings_from(words, more));
}

/// To its last sample, without warnings.
inline RenderResult render_now(RenderSession& session, const RenderCommand& command) {
  MeasureHooks hooks;
  hooks.stop = [] { return false; };
  return session.render(command, hooks, {});
}

inline std::uint64_t differing_pixels(const Image& a, const Image& b) {
  return compare_images(a, b, 0).differing_pixels;
}

}  // namespace pt
