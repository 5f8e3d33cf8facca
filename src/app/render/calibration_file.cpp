#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>

#include "app/render/calibration.h"
#include "app/render/rank_setup.h"
#include "common/device/cpu/cpu_renderer.h"
#include "common/error/error.h"
#include "common/image/atomic_file.h"
#include "common/plan/plan_steps.h"
#include "common/platform/build_info.h"
#include "common/scene/load/files/scene_files.h"
#include "common/scene/load/files/whole_file.h"

namespace pt {
namespace {

namespace fs = std::filesystem;
using CalibrationJson = nlohmann::ordered_json;

constexpr int format = 1;  // of the file; raised when a constant changes its meaning

/// Of /proc/cpuinfo; "CPU" where that does not tell.
std::string cpu_model() {
  static const std::string model = [] {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
      const std::size_t colon = line.find(": ");
      if (line.starts_with("model name") && colon != std::string::npos)
        return line.substr(colon + 2);
    }
    return std::string("CPU");
  }();
  return model;
}

/// Letters and digits, and single dashes for all else.
std::string as_file_name(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.';
    if (is_plain || (!name.empty() && name.back() != '-'))
      name += is_plain ? static_cast<char>(std::tolower(static_cast<unsigned char>(c))) : '-';
  }
  return name;
}

std::string key_text(const CalibrationKey& key) {
  std::string text = key.device;
  if (key.multiprocessors > 0) text += fmt::format(", {} multiprocessors", key.multiprocessors);
  text += fmt::format(", {} thread{}", key.threads, key.threads == 1 ? "" : "s");
  if (!key.driver.empty()) text += ", " + key.driver;
  return text + ", ptexp " + key.version;
}

/// The value of an entry. Throws Error.
template <class T>
T value_at(const CalibrationJson& json, const char* name, const char* expected) {
  try {
    return json.at(name).get<T>();
  } catch (const nlohmann::json::exception&) {
    throw Error(fmt::format("{}: expected {}", name, expected));
  }
}

CalibrationKey key_in(const CalibrationJson& json) {
  const auto text = [&](const char* name) { return value_at<std::string>(json, name, "a text"); };
  const auto count = [&](const char* name) { return value_at<int>(json, name, "a number"); };
  return {text("device"), count("multiprocessors"), count("threads"), text("driver"),
          text("version")};
}

Calibration parse_calibration(std::string_view bytes) {
  const CalibrationJson json = CalibrationJson::parse(bytes, nullptr, false);
  if (!json.is_object()) throw Error("expected an object of JSON");
  if (const int found = value_at<int>(json, "format", "a number"); found != format)
    throw Error(fmt::format("format: {}; expected {}", found, format));
  Calibration calibration{.key = key_in(json), .constants = {}};
  calibration.seconds = value_at<double>(json, "seconds", "a number");
  const auto constants = value_at<CalibrationJson>(json, "constants", "an object");
  if (!constants.is_object()) throw Error("constants: expected an object");
  for (const auto& [name, value] : constants.items()) {
    const auto info = std::ranges::find(plan_constant_table, name,
                                        [](const auto& one) { return std::string(one.name); });
    if (info == std::end(plan_constant_table))
      throw Error(fmt::format("{}: this program has no such constant", clipped(name)));
    const double number = value.is_number() ? value.get<double>() : info->lowest - 1;
    if (!(number >= info->lowest && number <= info->highest))
      throw Error(fmt::format("{}: {}; expected a number from {:g} to {:g}", info->name,
                              clipped(value.dump()), info->lowest, info->highest));
    set_measured(calibration.constants, info->value, number);
  }
  calibration.constants.calibration = hash_of(bytes).substr(0, 16);
  return calibration;
}

/// Tells it the first time.
void warn_once(const Warn& warn, const std::string& message) {
  static std::mutex mutex;
  static std::set<std::string> told;
  const std::lock_guard lock(mutex);
  if (warn && told.insert(message).second) warn(message);
}

/// As read_calibration; a file is read again when it has changed.
class ReadFiles {
 public:
  Calibration get(const std::string& file) {
    std::error_code none;  // then reading tells
    const Version version{fs::last_write_time(file, none), fs::file_size(file, none)};
    const std::lock_guard lock(mutex_);
    if (const auto found = files_.find(file);
        found != files_.end() && found->second.first == version)
      return found->second.second;
    Calibration calibration = read_calibration(file);
    files_.insert_or_assign(file, std::pair(version, calibration));
    return calibration;
  }
  /// It has been written.
  void forget(const std::string& file) {
    const std::lock_guard lock(mutex_);
    files_.erase(file);
  }

 private:
  using Version = std::pair<fs::file_time_type, std::uintmax_t>;
  std::mutex mutex_;
  std::map<std::string, std::pair<Version, Calibration>> files_;
};

ReadFiles& read_files() {
  static ReadFiles files;
  return files;
}

/// What the cache folder has for this device, or nothing.
std::optional<Calibration> cached_calibration(const CalibrationKey& key, const Warn& warn) {
  const std::string file = calibration_path(key);
  std::error_code missing;
  if (file.empty() || !fs::exists(file, missing)) return std::nullopt;
  try {
    Calibration found = read_files().get(file);
    if (found.key == key) return found;
    throw Error(fmt::format("{}: is of {}; expected {}", file, key_text(found.key), key_text(key)));
  } catch (const Error& error) {
    warn_once(warn, fmt::format("{}; ignored, ptexp calibrate replaces it", error.what()));
    return std::nullopt;
  }
}

}  // namespace

CalibrationKey calibration_key(const DeviceInfo& device, const Options& options) {
  const DeviceProperties p = limit_device(device.properties, options.limits);
  return {p.is_cuda ? device.name : cpu_model(), p.is_cuda ? p.multiprocessors : 0,
          p.is_cuda ? cpu_threads(options.threads) : p.threads, device.driver,
          build_info().version};
}

std::string calibration_path(const CalibrationKey& key) {
  const auto folder = [](const char* variable) {
    const char* const value = std::getenv(variable);
    return value != nullptr && value[0] == '/' ? fs::path(value) : fs::path();
  };
  fs::path cache = folder("XDG_CACHE_HOME");
  if (const fs::path home = folder("HOME"); cache.empty() && !home.empty()) cache = home / ".cache";
  if (cache.empty()) return "";
  return cache / "ptexp" / ("calibration-" + as_file_name(key_text(key)) + ".json");
}

std::string writable_calibration_path(const CalibrationKey& key) {
  const std::string file = calibration_path(key);
  if (file.empty())
    throw Error("calibrate: there is no cache folder; expected HOME or XDG_CACHE_HOME as a path");
  std::error_code error;
  fs::create_directories(fs::path(file).parent_path(), error);
  if (error) throw Error(fmt::format("cannot write {}: {}", file, error.message()));
  check_writable(file);
  return file;
}

std::string store_calibration(const Calibration& calibration) {
  const CalibrationKey& key = calibration.key;
  CalibrationJson json = {{"format", format},
                          {"device", key.device},
                          {"multiprocessors", key.multiprocessors},
                          {"threads", key.threads},
                          {"driver", key.driver},
                          {"version", key.version},
                          {"commit", build_info().commit},
                          {"seconds", calibration.seconds},
                          {"constants", CalibrationJson::object()},
                          {"kept", calibration.kept}};
  for (const PlanConstantInfo& info : plan_constant_table)
    if (is_measured(calibration.constants, info.value))
      json["constants"][info.name] = calibration.constants.*info.value;
  std::string file = writable_calibration_path(key);
  write_file_atomically(file,
                        json.dump(2, ' ', false, CalibrationJson::error_handler_t::replace) + '\n');
  read_files().forget(file);
  return file;
}

Calibration read_calibration(const std::string& file) {
  try {
    return parse_calibration(WholeFile(file).bytes());
  } catch (const Error& error) {
    throw Error(fmt::format("calibration {}: {}", file, error.what()));
  }
}

void apply_calibration(const Options& options, std::vector<DeviceInfo>& devices, const Warn& warn) {
  if (options.calibration == "none") return;
  for (DeviceInfo& device : devices) {
    const CalibrationKey key = calibration_key(device, options);
    std::optional<Calibration> found;
    if (options.calibration == "auto") {
      found = cached_calibration(key, warn);
    } else {
      found = read_files().get(options.calibration);
      if (found->key != key) found->constants.measured_on = found->key.device;
    }
    if (found) device.properties.constants = found->constants;
  }
}

std::vector<DeviceInfo> calibrated_devices(Options& options, const GivenOptions& given,
                                           const Warn& warn, const Ranks* ranks) {
  std::vector<DeviceInfo> devices = choose_render_devices(options, given, ranks);
  apply_calibration(options, devices, warn);
  return devices;
}

}  // namespace pt
