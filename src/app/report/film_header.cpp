#include "app/report/film_header.h"

#include <fmt/format.h>

#include "app/options/option_values.h"
#include "common/error/error.h"
#include "common/platform/build_info.h"

namespace pt {
namespace {

const char* const version_key = "ptexp.film_version";
const char* const scene_key = "ptexp.scene_hash";
const char* const device_key = "ptexp.device_kind";

std::string key_of(const OptionEntry& entry) { return "ptexp.option." + option_key(entry); }

/// Empty where there is none: options that the scene decides are left out of headers.
std::string value_in(const ImageMetadata& header, const std::string& key) {
  const auto found = header.find(key);
  return found == header.end() ? "" : found->second;
}

std::string shown(const std::string& value) { return value.empty() ? "none" : value; }

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
    const auto entry = std::find_if(
        list.begin(), list.end(), [&key = key](const OptionEntry& e) { return key_of(e) == key; });
    if (entry == list.end()) {
      throw Error(fmt::format("{}: {}: this program has no such option", file, key));
    }
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
}

void apply_settings(const std::vector<Setting>& settings, const std::string& file,
                    Options& options) {
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
}

}  // namespace pt
