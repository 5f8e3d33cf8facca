#include "app/options/check_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "app/options/option_list.h"
#include "app/options/option_values.h"
#include "common/error/error.h"
#include "common/image/atomic_file.h"
#include "common/image/codecs/image_io.h"
#include "common/options/option_names.h"
#include "common/scene/data/scene_data.h"

namespace pt {
namespace {

template <typename E>
bool contains(std::span<const E> list, E value) {
  return std::ranges::find(list, value) != list.end();
}

template <typename E>
std::string joined(std::span<const E> list) {
  std::string text;
  for (const E value : list) text += (text.empty() ? "" : " or ") + to_string(value);
  return text;
}

/// "cuda:1" is the value "cuda".
bool has_value(const OptionRule& rule, const std::string& text) {
  return rule.value.empty() || text.substr(0, text.find(':')) == rule.value;
}

void check_rule(const OptionRule& rule, const std::string& name, const std::string& value,
                Mode mode, std::optional<DeviceChoice::Kind> device) {
  if (mode != Mode::automatic && !contains(rule.modes, mode))
    throw Error(fmt::format("--{} {}: has no effect with --mode {}; it applies to {}", name, value,
                            to_string(mode), joined(rule.modes)));
  if (device && !contains(rule.devices, *device))
    throw Error(fmt::format("--{} {}: has no effect on the device {}; it applies to {}{}", name,
                            value, to_string(*device), joined(rule.devices),
                            rule.instead.empty() ? "" : "; " + rule.instead));
}

void check_files(const Options& o, const GivenOptions& given) {
  const std::pair<const char*, std::string> files[] = {{"output", o.output},
                                                       {"stats", o.stats_file},
                                                       {"csv", o.csv_file},
                                                       {"checkpoint", o.checkpoint.file}};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j)
      if (is_same_file(files[i].second, files[j].second))
        throw Error(fmt::format("--{} {}: is the file of --{} too", files[i].first, files[i].second,
                                files[j].first));
  if (given.contains("exposure") && o.output.ends_with(".exr"))
    throw Error(fmt::format("--exposure {}: applies to .png and .ppm; {} holds linear radiance",
                            exposure_text(o.exposure), o.output));
}

void check_film(const Options& o, const GivenOptions& given) {
  if (o.aovs != 0 && image_ending(o.output) != ".exr")
    throw Error(fmt::format("--aov {}: are layers of an .exr; {} has no place for them",
                            aovs_text(o.aovs), o.output));
  if (o.crop && given.contains("width") && given.contains("height")) check_crop(o);
  if (o.time_limit > 0 && o.repeat > 1)
    throw Error(
        fmt::format("--time-limit {}: with --repeat {} each render would be of other samples; "
                    "expected --repeat 1",
                    number_text(o.time_limit), o.repeat));
}

void check_camera(const CameraOverrides& camera) {
  const auto& up = camera.up;
  const auto text = [](const char* name) { return find_option(name).text; };
  Options o;
  o.camera = camera;
  if (up && (*up)[0] == 0 && (*up)[1] == 0 && (*up)[2] == 0)
    throw Error(fmt::format("--up {}: expected a direction, not zero", text("up")(o)));
  if (!camera.look_from || !camera.look_at) return;
  double view[3], length = 0;
  for (int i = 0; i < 3; ++i) {
    view[i] = double{(*camera.look_at)[i]} - (*camera.look_from)[i];
    length += std::abs(view[i]);
  }
  if (length == 0)
    throw Error(
        fmt::format("--look-at {}: expected a point other than --look-from", text("look-at")(o)));
  if (!up) return;
  double cross = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    cross += std::abs(view[j] * (*up)[k] - view[k] * (*up)[j]);
  }
  if (cross == 0)
    throw Error(
        fmt::format("--up {}: expected a direction other than that from --look-from to "
                    "--look-at",
                    text("up")(o)));
}

void check_metropolis_only(const Options& options, const GivenOptions& given) {
  if (options.integrator == IntegratorKind::mlt) return;
  for (const char* name : {"chains", "large-step-probability", "mutation-size", "bootstrap"}) {
    if (!given.contains(name)) continue;
    throw Error(fmt::format("--{} {}: has no effect with --integrator {}; it applies to mlt", name,
                            find_option(name).text(options), to_string(options.integrator)));
  }
}

void refuse_with_stages(const Options& options, const std::string& name, Stages expected) {
  throw Error(fmt::format("--{} {}: has no effect with --stages {}; it applies to {}", name,
                          find_option(name).text(options), to_string(options.stages),
                          to_string(expected)));
}

/// Options that one of --stages split and fused does not support.
void check_stages(const Options& options, const GivenOptions& given) {
  if (options.stages != Stages::fused) {
    if (given.contains("wave-rays")) refuse_with_stages(options, "wave-rays", Stages::fused);
    return;
  }
  for (const char* name : {"persistent", "wave-collisions"}) {
    if (given.contains(name)) refuse_with_stages(options, name, Stages::split);
  }
  if (options.order_surfaces == SurfaceOrdering::on)
    refuse_with_stages(options, "order-surfaces", Stages::split);
  if (options.branching == Branching::reduced)
    refuse_with_stages(options, "branching", Stages::split);
}

void check_surface_order(const Options& options) {
  if (options.order_surfaces == SurfaceOrdering::on &&
      !compaction_info(options.compaction).has_queues)
    throw Error(fmt::format(
        "--order-surfaces on: sorts a queue; --compaction {} has no queues, expected another",
        to_string(options.compaction)));
}

/// The kernels `vote` and `sort` need whole warps that fetch paths, and a wide tree.
void check_phase_voting(const Options& options, const GivenOptions& given) {
  if (options.kernel != MegakernelKind::vote && options.kernel != MegakernelKind::sort) return;
  const std::string kernel = to_string(options.kernel);
  if (options.work != Work::persistent)
    throw Error(
        fmt::format("--kernel {}: its warps fetch paths; expected --work persistent, not {}",
                    kernel, to_string(options.work)));
  if (options.accel != AccelKind::automatic && options.accel != AccelKind::cwbvh)
    throw Error(
        fmt::format("--kernel {}: traces wide trees; expected --accel cwbvh or auto, not {}",
                    kernel, to_string(options.accel)));
  if (options.kernel == MegakernelKind::sort) {
    if (given.contains("block"))
      throw Error(
          fmt::format("--block {}: has no effect with --kernel sort, whose blocks are as "
                      "large as multiprocessors",
                      block_text(options.block)));
  } else if (options.block.x * options.block.y % 32 != 0) {
    throw Error(
        fmt::format("--kernel vote: whole warps vote; expected a --block of a multiple of "
                    "32 threads, {} has {}",
                    block_text(options.block), options.block.x * options.block.y));
  }
}

/// `option` has no effect if `holds`.
struct InertRule {
  const char* option;
  bool (*holds)(const Options&);
  const char* why;
};

constexpr InertRule inert_rules[] = {
    {"mis", [](const Options& o) { return !o.nee; }, "with --nee off: no light is asked"},
    {"light-selection", [](const Options& o) { return !o.nee; },
     "with --nee off: no light is asked"},
    {"mutation-size", [](const Options& o) { return o.large_step_probability == 1.0f; },
     "with --large-step-probability 1: no step is a small one"},
    {"finish-paths", [](const Options& o) { return o.integrator == IntegratorKind::mlt; },
     "with --integrator mlt: chains go on to the last wave"},
    {"shutter", [](const Options& o) { return !o.time; },
     "without --time: animations are not evaluated"},
    {"animation", [](const Options& o) { return !o.time; },
     "without --time: animations are not evaluated"},
    {"focus-distance", [](const Options& o) { return o.camera.aperture == 0.0f; },
     "with --aperture 0: all is in focus"},
    {"builder", [](const Options& o) { return o.accel == AccelKind::brute; },
     "with --accel brute: there is no tree"},
    {"builder", [](const Options& o) { return o.accel == AccelKind::embree; },
     "with --accel embree: it builds its own tree"},
    {"optix-hits", [](const Options& o) { return o.accel != AccelKind::optix; },
     "without --accel optix"},
    {"reorder", [](const Options& o) { return o.accel != AccelKind::optix; },
     "without --accel optix"},
};

/// Scripts may give an option's default value in any case.
void check_inert(const Options& options, const GivenOptions& given) {
  for (const InertRule& rule : inert_rules) {
    const OptionEntry& entry = find_option(rule.option);
    const std::string value = entry.text(options);
    if (!given.contains(rule.option) || !rule.holds(options)) continue;
    if (value == entry.text(Options())) continue;
    throw Error(fmt::format("--{} {}: has no effect {}", rule.option, value, rule.why));
  }
}

/// Checkpoints, parts and several devices need one render of whole paths.
void check_parts(const Options& o, const GivenOptions& given) {
  const bool has_file = !o.checkpoint.file.empty();
  const auto refuse = [](const std::string& option, const std::string& why) {
    throw Error(fmt::format("{}: {}", option, why));
  };
  if (o.part.count > 1 && !has_file)
    refuse("--part " + part_text(o.part),
           "expected --checkpoint FILE, which the part is written to");
  if (o.part.count > 1 && given.contains("output"))
    refuse("--output " + o.output, "a part of an image is written to --checkpoint alone");
  if (o.part.count > 1 && (o.target_error > 0 || o.time_limit > 0))
    refuse("--part " + part_text(o.part),
           "all parts need the same samples; expected neither --time-limit nor --target-error");
  if (has_file && o.repeat + o.warmup > 1)
    refuse("--checkpoint " + o.checkpoint.file,
           "is of one render; expected neither --repeat nor --warmup");
  const bool has_several = o.device.has_several();
  if (has_several && o.mode == Mode::serial)
    refuse("--device " + to_string(o.device), "--mode serial has one thread; expected one device");
  if (has_several && o.counters)
    refuse("--counters", "reads those of one device; --device names several");
  if (o.limits.sms > 0 && o.counters)
    refuse("--counters", "reads those of a whole GPU; expected no --sms");
  if (o.integrator == IntegratorKind::mlt && (has_several || has_file))
    refuse(has_several ? "--device " + to_string(o.device) : "--checkpoint " + o.checkpoint.file,
           "the chains of --integrator mlt walk over the whole image and have no state that could "
           "be continued; expected one device and no checkpoint");
}

}  // namespace

void check_consistent(const Options& options, const GivenOptions& given) {
  check_parts(options, given);
  check_metropolis_only(options, given);
  check_stages(options, given);
  check_files(options, given);
  check_film(options, given);
  check_camera(options.camera);
  check_phase_voting(options, given);
  check_inert(options, given);
  check_surface_order(options);
  if (given.contains("spheres") && options.scene != "spheres")
    throw Error(fmt::format("--spheres {}: has no effect on the scene '{}', only on 'spheres'",
                            options.spheres, options.scene));
}

void check_crop(const Options& options) {
  if (!options.crop) return;
  const CropWindow& crop = *options.crop;
  if (crop.x0 < 0 || crop.y0 < 0 || crop.x0 >= crop.x1 || crop.y0 >= crop.y1 ||
      crop.x1 > options.width || crop.y1 > options.height)
    throw Error(fmt::format("--crop {}: expected pixels of the image of {}x{}",
                            crop_text(options.crop), options.width, options.height));
}

bool has_effect(const OptionEntry& entry, const std::string& value, Mode mode) {
  if (mode == Mode::automatic)
    return has_effect(entry, value, Mode::wavefront) || has_effect(entry, value, Mode::megakernel);
  return std::ranges::all_of(entry.rules, [&](const OptionRule& rule) {
    return !has_value(rule, value) || contains(rule.modes, mode);
  });
}

void fit_mode(Options& options, const GivenOptions& given) {
  if (options.mode != Mode::automatic) return;
  const auto first_without_effect = [&](Mode mode) -> const OptionEntry* {
    for (const OptionEntry& entry : option_list()) {
      if (given.contains(entry.name) && !has_effect(entry, entry.text(options), mode))
        return &entry;
    }
    return nullptr;
  };
  const OptionEntry* const not_in_waves = first_without_effect(Mode::wavefront);
  const OptionEntry* const not_in_megakernel = first_without_effect(Mode::megakernel);
  if (not_in_waves != nullptr && not_in_megakernel != nullptr)
    throw Error(
        fmt::format("--{} and --{}: have no effect in one mode; expected options of the "
                    "megakernel or of the wavefront",
                    not_in_waves->name, not_in_megakernel->name));
  if (not_in_waves != nullptr) options.mode = Mode::megakernel;
  if (not_in_megakernel != nullptr) options.mode = Mode::wavefront;
}

void check_applicable(const Options& options, const GivenOptions& given,
                      std::optional<DeviceChoice::Kind> device) {
  for (const OptionEntry& entry : option_list()) {
    if (!given.contains(entry.name)) continue;
    const std::string value = entry.text(options);
    for (const OptionRule& rule : entry.rules) {
      if (has_value(rule, value)) check_rule(rule, entry.name, value, options.mode, device);
    }
  }
}

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

RenderCommand make_render_command(const std::vector<Setting>& settings) {
  RenderCommand command;
  for (const auto& [entry, value] : settings) {
    entry->set(command.options, value);
    command.given.insert(entry->name);
  }
  fit_mode(command.options, command.given);
  check_consistent(command.options, command.given);
  std::optional<DeviceChoice::Kind> device;
  if (command.options.device.kind != DeviceChoice::Kind::automatic)
    device = command.options.device.kind;
  check_applicable(command.options, command.given, device);
  return command;
}

}  // namespace pt
