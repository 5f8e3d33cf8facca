// Refuses options that do not go together or that a run would ignore, and completes them by a
// scene's defaults.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/options/option_list.h"
#include "common/options/options.h"

namespace pt {

struct SceneDefaults;

/// The names of the options that the user gave, without dashes: defaults are never refused.
using GivenOptions = std::set<std::string>;

/// Throws Error when two options contradict each other, whatever the device.
void check_consistent(const Options& options, const GivenOptions& given);

/// Throws Error when the crop window, the user's or the scene file's, is not part of the image.
void check_crop(const Options& options);

/// Whether a value of the option, as its `text` prints it, has an effect in a mode on any device.
bool has_effect(const OptionEntry& entry, const std::string& value, Mode mode);

/// Sets a mode that is left open if all given options have an effect in that mode alone. Throws
/// Error if they have in none.
void fit_mode(Options& options, const GivenOptions& given);

/// Throws Error when a given option has no effect in the chosen mode or on `device`, which is not
/// checked if absent.
void check_applicable(const Options& options, const GivenOptions& given,
                      std::optional<DeviceChoice::Kind> device);

/// Fills in what `given` lacks and the scene's file has. Throws Error as check_crop does.
void apply_defaults(const SceneDefaults& defaults, const GivenOptions& given, Options& options);

struct RenderCommand {
  Options options;
  GivenOptions given;  ///< for check_applicable, once the device is known
};

/// Options of rendering from settings; a later one overrides an earlier one. Throws Error for
/// everything that can be refused without a device or a scene.
RenderCommand make_render_command(const std::vector<Setting>& settings);

}  // namespace pt
