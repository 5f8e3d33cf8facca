#include "view/mode_command.h"

#include "common/options/option_names.h"

namespace pt {
namespace {

/// As the option says it, whatever the user wrote.
std::string value_of(const Setting& setting) {
  Options options;
  setting.entry->set(options, setting.value);
  return setting.entry->text(options);
}

}  // namespace

RenderCommand mode_command(const std::vector<Setting>& settings, Mode mode) {
  std::vector<Setting> chosen;
  for (const Setting& setting : settings) {
    const OptionEntry& entry = *setting.entry;
    const bool is_kept = entry.name != "mode" && !entry.group.starts_with("Camera") &&
                         has_effect(entry, value_of(setting), mode);
    if (is_kept) chosen.push_back(setting);
  }
  chosen.push_back({&find_option("mode"), to_string(mode)});
  return make_render_command(chosen);
}

}  // namespace pt
