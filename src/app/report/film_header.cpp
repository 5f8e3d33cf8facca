#include "app/report/film_header.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/options/option_values.h"
#include "app/report/report.h"
#include "common/error/error.h"
#include "common/options/option_names.h"
#include "common/platform/build_info.h"

namespace pt {
namespace {

const char* const version_key = "ptexp.film_version";
const char* const scene_key = "ptexp.scene_hash";
const char* const device_key = "ptexp.device_kind";

std::string key_of(const OptionEntry& entry) { return "ptexp.option." + option_key(entry); }

/// Empty where the header lacks the key, as it lacks options that the scene decides.
std::string value_in(const ImageMetadata& header, const std::string& key) {
  const auto found = header.find(key);
  return found == header.end() ? "" : found->second;
}

std::string shown(const std::string& value) { return value.empty() ? "none" : value; }

/// Options of earlier programs that never changed an image.
constexpr std::string_view former_options[] = {"ptexp.option.display", "ptexp.option.shade"};

/// Whether OptiX's own hits are in the film, which may have other bits than ours.
bool has_foreign_hits(const Options& options) {
  return options.accel == AccelKind::optix && options.optix_hits == OptixHits::built_in;
}
bool has_foreign_hits(const ImageMetadata& header) {
  return value_in(header, "ptexp.option.accel") == to_string(AccelKind::optix) &&
         value_in(header, "ptexp.option.optix_hits") == to_string(OptixHits::built_in);
}

}  // namespace

ImageMetadata film_header(const Options& options, const std::string& scene_hash,
                          const std::string& device_kind) {
  ImageMetadata header{{"ptexp.version", build_info().version},
                       {"ptexp.commit", build_info().commit},
                       {version_key, std::to_string(film_version)},
                       {device_key, device_kind}};
  if (!scene_hash.empty()) header[scene_key] = scene_hash;
  for (const OptionEntry& entry : option_list()) {
    if (const std::string text = entry.text(options); !text.empty()) header[key_of(entry)] = text;
  }
  return header;
}

ImageMetadata image_header(const Options& options, const RenderReport& report,
                           const std::string& scene_hash) {
  const BuildInfo& build = build_info();
  const RunSummary summary = summarize(report);
  const auto ms = [](double time) { return fmt::format("{:.6f}", time); };
  ImageMetadata header = film_header(options, scene_hash, report.device_kind);
  header["ptexp.build"] = fmt::format("{}, {}, CUDA {}{}", build.build_type, build.compiler,
                                      build.cuda, build.fast_math ? ", fast math" : "");
  header["ptexp.device"] = report.device_name;
  header["ptexp.samples_done"] = std::to_string(summary.samples_done);
  header["ptexp.ended_by"] = to_string(summary.ended_by);
  header["ptexp.paths"] = std::to_string(report.counts.paths);
  header["ptexp.rays"] = std::to_string(report.counts.rays);
  header["ptexp.kernel_ms"] = ms(summary.kernel_ms.median);
  header["ptexp.scene_ms"] = ms(report.scene_ms);
  header["ptexp.setup_ms"] = ms(report.setup_ms);
  header["ptexp.load_ms"] = ms(report.load_ms);
  header["ptexp.transfer_ms"] = ms(report.transfer_ms);
  if (summary.relative_error)
    header["ptexp.relative_error"] = fmt::format("{:.6g}", *summary.relative_error);
  if (report.exposure) header["ptexp.exposure"] = fmt::format("{}", *report.exposure);
  return header;
}

Options options_in_header(const ImageMetadata& header, const std::string& file) {
  const std::string version = value_in(header, version_key);
  if (version.empty()) {
    throw Error(
        fmt::format("{}: no attribute {}; expected an image of ptexp, in a format that "
                    "keeps what is known of it",
                    file, version_key));
  }
  if (version != std::to_string(film_version)) {
    throw Error(fmt::format("{}: {} {}, of ptexp {}; this program, {}, has {} and gives other bits",
                            file, version_key, version, shown(value_in(header, "ptexp.version")),
                            build_info().version, film_version));
  }
  Options options;
  for (const auto& [key, value] : header) {
    if (!key.starts_with("ptexp.option.")) continue;
    const auto& list = option_list();
    const auto entry = std::ranges::find(list, key, key_of);
    if (entry == list.end()) {
      if (std::ranges::find(former_options, key) != std::end(former_options)) continue;
      throw Error(fmt::format("{}: {}: this program has no such option", file, key));
    }
    if (entry->name == "calibration") continue;  // of the machine that began
    if (entry->form == OptionForm::flag && value != "on") continue;
    if (entry->form != OptionForm::list) {
      entry->set(options, value);
      continue;
    }
    for (const std::string& one : split_definitions(value)) entry->set(options, one);
  }
  return options;
}

void check_same_render(const ImageMetadata& a, const std::string& file_a, const ImageMetadata& b,
                       const std::string& file_b) {
  const auto check = [&](const std::string& key, const std::string& name) {
    const std::string in_a = value_in(a, key), in_b = value_in(b, key);
    if (in_a == in_b) return;
    throw Error(fmt::format("{}: {} {}, but {} has {}; expected films of one render", file_b, name,
                            shown(in_b), file_a, shown(in_a)));
  };
  check(version_key, version_key);
  check(device_key, "device kind");
  check(scene_key, "scene hash");
  for (const OptionEntry& entry : option_list()) {
    if (determines_image(entry)) check(key_of(entry), "--" + entry.name);
  }
  if (has_foreign_hits(a) != has_foreign_hits(b)) {
    throw Error(fmt::format(
        "{}: --accel optix --optix-hits built-in, but {} has other hits; expected films of one "
        "render",
        has_foreign_hits(a) ? file_a : file_b, has_foreign_hits(a) ? file_b : file_a));
  }
}

void apply_settings(const std::vector<Setting>& settings, const std::string& file,
                    Options& options) {
  const bool foreign = has_foreign_hits(options);
  for (const auto& [entry, value] : settings) {
    const std::string before = entry->text(options);
    entry->set(options, value);
    const std::string after = entry->text(options);
    if (after == before || !determines_image(*entry)) continue;
    throw Error(
        fmt::format("--{} {}: {} was begun with {}, and its samples are of that; expected "
                    "the same, or a new render",
                    entry->name, value, file, shown(before)));
  }
  if (has_foreign_hits(options) == foreign) return;
  throw Error(
      fmt::format("{} was begun {} --accel optix --optix-hits built-in, whose hits may have other "
                  "bits; expected the same, or a new render",
                  file, foreign ? "with" : "without"));
}

}  // namespace pt
