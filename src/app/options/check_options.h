// Options that each are valid but do not go together, or that this run would ignore.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "common/options/options.h"

namespace pt {

struct OptionEntry;

/// The names of the options that the user gave, without dashes: defaults are never refused.
using GivenOptions = std::set<std::string>;

/// Throws Error when two options contradict each other, whatever the device.
void check_consistent(const Options& options, const GivenOptions& given);

/// Throws Error when --crop, or a scene file's, is no part of the image.
void check_crop(const Options& options);

/// Whether a value of the option, as its `text` gives it, has an effect in a mode on any device.
bool has_effect(const OptionEntry& entry, const std::string& value, Mode mode);

/// Where the mode is left open, makes it the one in which all given options have an effect, if only
/// one is such. Throws Error where none is.
void fit_mode(Options& options, const GivenOptions& given);

/// Throws Error when a given option has no effect in the chosen mode, or none on `device`. The
/// device is checked only where it is known: pass choose_device's answer to check all.
void check_applicable(const Options& options, const GivenOptions& given,
                      std::optional<DeviceChoice::Kind> device);

}  // namespace pt
