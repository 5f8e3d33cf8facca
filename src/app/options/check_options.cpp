#include "app/options/check_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "app/options/option_list.h"
#include "app/options/option_values.h"
#include "common/error.h"
#include "common/render/option_names.h"

namespace pt {
namespace {

using Kind = DeviceChoice::Kind;

/// Where an option, or one value of it, has an effect.
struct Rule {
  const char* option;
  const char* value;  ///< nullptr: any value
  std::vector<Mode> modes;
  std::vector<Kind> devices;
};

/// The whole policy. What stands in no rule applies everywhere.
const std::vector<Rule>& rules() {
  static const std::vector<Mode> parallel{Mode::megakernel, Mode::wavefront};
  static const std::vector<Mode> megakernel{Mode::megakernel}, wavefront{Mode::wavefront};
  static const std::vector<Kind> cpu{Kind::cpu}, cuda{Kind::cuda}, any{Kind::cpu, Kind::cuda};
  // clang-format off
  static const std::vector<Rule> list{
      {"device",       "cuda",     parallel,   cuda},
      {"threads",      nullptr,    parallel,   cpu},
      {"work",         nullptr,    megakernel, any},
      {"block",        nullptr,    megakernel, cuda},
      {"compaction",   nullptr,    wavefront,  any},
      {"pool-size",    nullptr,    wavefront,  any},
      {"finish-paths", nullptr,    wavefront,  any},
      {"regenerate",   nullptr,    wavefront,  any},
      {"schedule",     nullptr,    wavefront,  any},
      {"schedule",     "graph",    wavefront,  cuda},
      {"stage-block",  nullptr,    wavefront,  cuda},
      {"create-world", "device",   parallel,   cuda},
      {"scene-memory", "shared",   parallel,   cuda},
      {"scene-memory", "constant", parallel,   cuda},
      {"branching",    "reduced",  parallel,   any},
  };
  // clang-format on
  return list;
}

template <typename E>
bool contains(const std::vector<E>& list, E value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

template <typename E>
std::string joined(const std::vector<E>& list) {
  std::string text;
  for (const E value : list) text += (text.empty() ? "" : " or ") + to_string(value);
  return text;
}

/// "cuda:1" is the value "cuda".
bool has_value(const Rule& rule, const std::string& text) {
  return rule.value == nullptr || text.substr(0, text.find(':')) == rule.value;
}

bool same_file(const std::string& a, const std::string& b) {
  namespace fs = std::filesystem;
  return !a.empty() && !b.empty() &&
         fs::absolute(a).lexically_normal() == fs::absolute(b).lexically_normal();
}

void check_files(const Options& o, const GivenOptions& given) {
  const std::pair<const char*, std::string> files[] = {
      {"output", o.output}, {"stats", o.stats_file}, {"csv", o.csv_file}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j)
      if (same_file(files[i].second, files[j].second))
        throw Error(fmt::format("--{} {}: is the file of --{} too", files[i].first, files[i].second,
                                files[j].first));
  if (given.contains("exposure") && o.output.ends_with(".exr"))
    throw Error(fmt::format("--exposure {}: applies to .png and .ppm; {} holds linear radiance",
                            exposure_text(o.exposure), o.output));
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

}  // namespace

void check_consistent(const Options& options, const GivenOptions& given) {
  check_files(options, given);
  check_camera(options.camera);
  if (given.contains("spheres") && options.scene != "spheres")
    throw Error(fmt::format("--spheres {}: has no effect on the scene '{}', only on 'spheres'",
                            options.spheres, options.scene));
}

void check_applicable(const Options& options, const GivenOptions& given,
                      std::optional<DeviceChoice::Kind> device) {
  for (const Rule& rule : rules()) {
    const std::string value = find_option(rule.option).text(options);
    if (!given.contains(rule.option) || !has_value(rule, value)) continue;
    if (!contains(rule.modes, options.mode))
      throw Error(fmt::format("--{} {}: has no effect with --mode {}; it applies to {}",
                              rule.option, value, to_string(options.mode), joined(rule.modes)));
    if (device && !contains(rule.devices, *device))
      throw Error(fmt::format("--{} {}: has no effect on the device {}; it applies to {}",
                              rule.option, value, to_string(*device), joined(rule.devices)));
  }
}

}  // namespace pt
