// `ptexp calibrate`: fitting planted times, and the file in the cache folder.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <string>

#include "app/render/calibration.h"
#include "common/error/error.h"
#include "render_words.h"
#include "temp_folder.h"

namespace pt {
namespace {

using C = PlanConstants;

/// The cache folder is a temporary one.
class Cache {
 public:
  Cache() {
    if (const char* value = std::getenv("XDG_CACHE_HOME")) before_ = value;
    ::setenv("XDG_CACHE_HOME", folder_.file("").c_str(), 1);
  }
  Cache(const Cache&) = delete;
  Cache& operator=(const Cache&) = delete;
  ~Cache() {
    before_.empty() ? ::unsetenv("XDG_CACHE_HOME") : ::setenv("XDG_CACHE_HOME", before_.c_str(), 1);
  }

 private:
  TempFolder folder_;
  std::string before_;
};

DeviceInfo planted_gpu(int multiprocessors = 132) {
  DeviceInfo device;
  device.choice.kind = DeviceChoice::Kind::cuda;
  device.name = "NVIDIA H100 80GB HBM3", device.driver = "CUDA 13.0";
  device.properties.is_cuda = true, device.properties.multiprocessors = multiprocessors;
  return device;
}

Calibration planted_calibration(const CalibrationKey& key) {
  Calibration calibration{.key = key, .constants = {}};
  set_measured(calibration.constants, &C::scan_primitives, 33);
  set_measured(calibration.constants, &C::ray_s_thread, 1.25e-7);
  calibration.kept = {"few_paths_multiprocessor: the times do not tell"};
  calibration.seconds = 12.5;
  return calibration;
}

PlanConstants applied(const DeviceInfo& device, const std::string& choice,
                      std::vector<std::string>* warnings = nullptr) {
  Options options;
  options.calibration = choice, options.threads = 2;
  std::vector<DeviceInfo> devices{device};
  apply_calibration(options, devices, [&](const std::string& text) {
    if (warnings != nullptr) warnings->push_back(text);
  });
  return devices.front().properties.constants;
}

TEST(Calibration, ATurnIsWhereTheRatioIsOne) {
  const TurnPoint points[] = {{16, 0.5}, {64, 0.8}, {256, 1.25}, {1024, 2}};
  EXPECT_NEAR(fit_turn(points, 1000).value(), 128, 1);
  EXPECT_EQ(fit_turn(points, 130).value(), 130);  // loses no more than the best one
  const TurnPoint first[] = {{16, 0.5}, {64, 0.8}, {256, 0.9}};
  EXPECT_EQ(fit_turn(first, 20).value(), 256);
  const TurnPoint second[] = {{16, 1.5}, {64, 1.8}, {256, 1.9}};
  EXPECT_EQ(fit_turn(second, 1000).value(), 8);
}

TEST(Calibration, ATurnThatIsNotThereIsNotFound) {
  const TurnPoint up_and_down[] = {{16, 1.5}, {64, 0.6}, {256, 1.5}, {1024, 0.6}};
  EXPECT_FALSE(fit_turn(up_and_down, 64));
  const TurnPoint noise[] = {{16, 1.01}, {64, 0.99}, {256, 1.01}, {1024, 0.995}};
  EXPECT_EQ(fit_turn(noise, 77).value(), 77);
}

TEST(Calibration, ARatioNeedsScenesThatAgree) {
  EXPECT_NEAR(fit_ratio(std::vector{0.5, 2.0 / 9}).value(), 1.0 / 3, 1e-9);
  EXPECT_NEAR(fit_ratio(std::vector{1.5, 1.01}).value(), std::sqrt(1.5 * 1.01), 1e-9);
  EXPECT_NEAR(fit_ratio(std::vector{1.5, 0.99}).value(), std::sqrt(1.5 * 0.99), 1e-9);
  EXPECT_FALSE(fit_ratio(std::vector{1.5, 0.9}));
  EXPECT_FALSE(fit_ratio(std::vector{1.01, 0.99}));
}

TEST(Calibration, ASizeChangesWhereItIsClearlyBetter) {
  const auto fitted = [](double at_1, double at_2, double at_4) {
    const SizePoint points[] = {{1, at_1}, {2, at_2}, {4, at_4}};
    return fit_size(points, 2);
  };
  EXPECT_EQ(fitted(10, 10, 10), 2);
  EXPECT_EQ(fitted(9.9, 10, 12), 2);
  EXPECT_EQ(fitted(9.5, 10, 12), 1);
  EXPECT_EQ(fitted(12, 10, 8), 4);
}

Options with_threads(int threads) {
  Options options;
  options.threads = threads;
  return options;
}

/// A device on which renders take planted times, by the values of options.
struct PlantedRenders {
  std::function<double(std::map<std::string, std::string>&)> ms;
  double left = 1e9;  ///< renders, until the time is over
  std::set<std::string> scenes{};

  Calibration calibrated(const DeviceInfo& device) {
    CalibrationTimer timer;
    timer.is_over = [this] { return left <= 0; };
    timer.render = [this](const WayOptions& options) {
      std::map<std::string, std::string> values(options.begin(), options.end());
      scenes.insert(values["scene"]);
      left--;
      WayRun run;
      run.kernel_ms = ms(values);
      run.build_ms = values["builder"] == "sah" ? 100 : values["builder"] == "sbvh" ? 400 : 150;
      run.counts.rays = 1000, run.counts.shadow_rays = 500;
      return std::optional(run);
    };
    return calibrate(timer, calibration_key(device, with_threads(2)), device.properties);
  }
};

/// Grows with the spheres; a tree takes as long as `turn` of them.
double scan_ms(std::map<std::string, std::string>& options, double turn) {
  if (options["accel"] == "bvh2") return turn;
  return options["accel"] == "brute" ? std::stod(options["spheres"]) + 1 : 10;
}

TEST(Calibration, OfACpuFindsPlantedConstants) {
  DeviceInfo cpu;
  cpu.properties = cpu_properties(2);
  PlantedRenders renders{[](auto& options) {
    if (options.contains("accel")) return scan_ms(options, 30);
    if (options["pool-size"] == "4096") return 8.0;
    return options["mode"] == "megakernel" ? 5.0 : 10.0;
  }};
  const Calibration found = renders.calibrated(cpu);
  const PlanConstants& c = found.constants;
  EXPECT_NEAR(c.megakernel_cpu, 0.5, 1e-9);
  EXPECT_NEAR(c.scan_primitives, 30, 1);
  EXPECT_EQ(c.pool_thread, 2048);
  EXPECT_NEAR(c.ray_s_thread, 1e-3 * 10 * 2 / 1500, 1e-12);
  EXPECT_TRUE(is_measured(c, &C::sah_s));
  EXPECT_TRUE(found.kept.empty()) << found.kept.front();
  EXPECT_FALSE(is_measured(c, &C::few_paths_multiprocessor));
  EXPECT_EQ(found.key, calibration_key(cpu, with_threads(2)));
  // A plan by it follows paths alone.
  cpu.properties.constants = c;
  SceneProperties spheres;
  spheres.spheres = 51, spheres.is_primitive_only = true;
  const ExecutionPlan plan = plan_execution({}, spheres, cpu.properties);
  EXPECT_EQ(plan.mode, Mode::megakernel);
  EXPECT_EQ(plan.accel, Accel::bvh2);
}

TEST(Calibration, OfAGpuFindsPlantedConstants) {
  const DeviceInfo gpu = planted_gpu(16);
  PlantedRenders renders{[](auto& options) {
    const bool is_mega = options["mode"] == "megakernel";
    const auto number = [&](const char* name) { return std::stod(options[name]); };
    if (options.contains("scene-memory"))
      return options["scene-memory"] == "constant" ? number("spheres") + 1 : 100.0;
    if (options.contains("accel")) return scan_ms(options, is_mega ? 400 : 600);
    if (options.contains("finish-paths"))
      return std::abs(std::log2(number("finish-paths")) - 15.4) + 10;
    if (options["scene"] == "cornell" && options["spp"] == "4")
      return is_mega ? 100 / number("max-depth") : 10.0;  // turns at 10
    if (options["scene"] == "cornell") return is_mega ? 1000 / number("width") : 4.0;  // at 250^2
    if (options["scene"].starts_with("dial")) return is_mega ? 12.0 : 10.0;
    return is_mega ? 8.0 : 10.0;
  }};
  const Calibration found = renders.calibrated(gpu);
  const PlanConstants& c = found.constants;
  EXPECT_NEAR(c.megakernel_spheres, 0.8, 1e-9);
  EXPECT_NEAR(c.megakernel_sorting, 1.2, 1e-9);
  EXPECT_NEAR(c.megakernel_mesh, 0.8, 1e-9);
  EXPECT_NEAR(c.short_depth, 10, 1);
  EXPECT_NEAR(std::sqrt(c.few_paths_multiprocessor * gpu.properties.multiprocessors), 250, 5);
  EXPECT_NEAR(c.scan_spheres_wavefront, 600, 5);
  EXPECT_NEAR(c.scan_spheres_megakernel, 400, 5);
  EXPECT_NEAR(c.constant_spheres, 100, 2);
  EXPECT_EQ(c.finish_lean, 1 << 15);
  EXPECT_EQ(c.finish_blocks, 1 << 16);
  EXPECT_NEAR(c.ray_s_multiprocessor, 1e-3 * 10 * 16 / 1500, 1e-12);
  EXPECT_TRUE(found.kept.empty()) << found.kept.front();
}

TEST(Calibration, WhatTheTimesDoNotTellKeepsItsDefault) {
  PlantedRenders renders{[](auto&) { return 10.0; }};
  const Calibration found = renders.calibrated(planted_gpu());
  EXPECT_FALSE(is_measured(found.constants, &C::megakernel_spheres));
  EXPECT_EQ(found.constants.megakernel_spheres, C().megakernel_spheres);
  EXPECT_EQ(found.constants.few_paths_multiprocessor, C().few_paths_multiprocessor);
  EXPECT_NE(std::ranges::find(found.kept, "megakernel_spheres: the times do not tell"),
            found.kept.end());
  EXPECT_NE(calibration_text(found).find("kept: megakernel_spheres"), std::string::npos);
}

TEST(Calibration, WithoutTimeTheRestKeepsItsDefaults) {
  PlantedRenders renders{[](auto& options) { return options["mode"] == "megakernel" ? 5.0 : 10; },
                         13};
  DeviceInfo cpu;
  cpu.properties = cpu_properties(2);
  const Calibration found = renders.calibrated(cpu);
  EXPECT_TRUE(is_measured(found.constants, &C::megakernel_cpu));
  for (const char* name : {"scan_primitives", "sah_s", "pool_thread"})
    EXPECT_NE(std::ranges::find(found.kept, std::string(name) + ": no time was left"),
              found.kept.end())
        << name;
}

TEST(Calibration, AWayThatDoesNotExistIsNoReasonToEnd) {
  PlantedRenders renders{[](auto& options) -> double {
    if (options["scene"] == "rtow") throw Error("no such scene");
    return 10;
  }};
  const Calibration found = renders.calibrated(planted_gpu());
  EXPECT_NE(std::ranges::find(found.kept, "megakernel_spheres: no such scene"), found.kept.end());
  EXPECT_TRUE(is_measured(found.constants, &C::ray_s_multiprocessor));
}

TEST(Calibration, TheFileIsOfDeviceThreadsDriverAndVersion) {
  const Cache cache;
  std::set<std::string> files;
  const auto add = [&](const DeviceInfo& device, int threads) {
    return files.insert(calibration_path(calibration_key(device, with_threads(threads)))).second;
  };
  EXPECT_TRUE(add(planted_gpu(), 2));
  EXPECT_FALSE(add(planted_gpu(), 2));
  EXPECT_TRUE(add(planted_gpu(), 1));
  EXPECT_TRUE(add(planted_gpu(64), 2));
  Options part = with_threads(2);
  part.limits.sms = 64;
  EXPECT_FALSE(files.insert(calibration_path(calibration_key(planted_gpu(), part))).second)
      << "of as many multiprocessors";
  DeviceInfo other = planted_gpu();
  other.driver = "CUDA 12.4";
  EXPECT_TRUE(add(other, 2));
  other = planted_gpu(), other.name = "NVIDIA H200";
  EXPECT_TRUE(add(other, 2));
  other.properties = cpu_properties(2), other.driver = "";
  EXPECT_TRUE(add(other, 0));
  other.properties = cpu_properties(3);
  EXPECT_TRUE(add(other, 0));
  CalibrationKey key = calibration_key(planted_gpu(), with_threads(2));
  key.version = "0.0.1";
  EXPECT_TRUE(files.insert(calibration_path(key)).second);
  for (const std::string& file : files) {
    EXPECT_NE(file.find("/ptexp/calibration-"), std::string::npos) << file;
    EXPECT_TRUE(file.ends_with(".json")) << file;
    EXPECT_EQ(file.find(' '), std::string::npos) << file;
  }
}

TEST(Calibration, WhatIsStoredIsAppliedToItsDeviceAlone) {
  const Cache cache;
  const DeviceInfo gpu = planted_gpu();
  EXPECT_EQ(applied(gpu, "auto"), PlanConstants());
  const Calibration stored = planted_calibration(calibration_key(gpu, with_threads(2)));
  const std::string file = store_calibration(stored);
  std::vector<std::string> warnings;
  const PlanConstants found = applied(gpu, "auto", &warnings);
  EXPECT_EQ(found.scan_primitives, 33);
  EXPECT_EQ(found.ray_s_thread, 1.25e-7);
  EXPECT_EQ(found.measured, stored.constants.measured);
  EXPECT_EQ(found.calibration.size(), 16u);
  EXPECT_EQ(origin_of(found, {&C::scan_primitives}), "measured here");
  EXPECT_EQ(applied(planted_gpu(64), "auto", &warnings), PlanConstants());
  EXPECT_EQ(applied(gpu, "none", &warnings), PlanConstants());
  // A file that is named holds for any device, and the plan says so.
  const PlanConstants foreign = applied(planted_gpu(64), file, &warnings);
  EXPECT_EQ(foreign.scan_primitives, 33);
  EXPECT_EQ(origin_of(foreign, {&C::scan_primitives}), "measured on NVIDIA H100 80GB HBM3");
  EXPECT_TRUE(warnings.empty());
}

TEST(Calibration, AFileIsReplacedAtOnce) {
  const Cache cache;
  const DeviceInfo gpu = planted_gpu();
  Calibration calibration = planted_calibration(calibration_key(gpu, with_threads(2)));
  const std::string file = store_calibration(calibration);
  const std::string hash = applied(gpu, "auto").calibration;
  set_measured(calibration.constants, &C::scan_primitives, 34);
  EXPECT_EQ(store_calibration(calibration), file);
  EXPECT_EQ(applied(gpu, "auto").scan_primitives, 34);
  EXPECT_NE(applied(gpu, "auto").calibration, hash);
  const auto folder = std::filesystem::path(file).parent_path();
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  // No folder can be made below a file.
  ::setenv("XDG_CACHE_HOME", file.c_str(), 1);
  expect_error([&] { store_calibration(calibration); }, file);
}

// A session renders often: the file's time and size tell that it is the one that was read.
TEST(Calibration, AFileIsReadAgainWhenItHasChanged) {
  const Cache cache;
  const DeviceInfo gpu = planted_gpu();
  const std::string file =
      store_calibration(planted_calibration(calibration_key(gpu, with_threads(2))));
  EXPECT_EQ(applied(gpu, "auto").scan_primitives, 33);
  const std::string text = read_text(file);
  const auto time = std::filesystem::last_write_time(file);
  write_text(file, std::string(text.size(), ' '));
  std::filesystem::last_write_time(file, time);
  EXPECT_EQ(applied(gpu, "auto").scan_primitives, 33) << "read again";
  std::filesystem::last_write_time(file, time + std::chrono::seconds(1));
  EXPECT_EQ(applied(gpu, "auto"), PlanConstants()) << "not read again";
  write_text(file, text + ' ');
  std::filesystem::last_write_time(file, time);
  EXPECT_EQ(applied(gpu, "auto").scan_primitives, 33);
  std::filesystem::remove(file);
  EXPECT_EQ(applied(gpu, "auto"), PlanConstants());
}

TEST(Calibration, ABrokenFileIsIgnoredWithOneWarning) {
  const Cache cache;
  const DeviceInfo gpu = planted_gpu();
  const std::string file =
      store_calibration(planted_calibration(calibration_key(gpu, with_threads(2))));
  const std::string whole = read_text(file);
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  const std::pair<std::string, std::string> cases[] = {
      {"", "expected an object of JSON"},
      {whole.substr(0, whole.size() / 2), "expected an object of JSON"},
      {"[1, 2]", "expected an object of JSON"},
      {"{}", "format: expected a number"},
      {changed("\"format\": 1", "\"format\": 99"), "format: 99; expected 1"},
      {changed("\"threads\": 2", "\"threads\": []"), "threads: expected a number"},
      {changed("\"threads\": 2", "\"threads\": 3"), "3 threads"},
      {changed("H100", "A100"), "is of NVIDIA A100 80GB HBM3, 132 multiprocessors"},
      {changed("scan_primitives", "scan_primitive"), "scan_primitive: this program has no such"},
      {changed("33.0", "-33.0"), "scan_primitives: -33.0; expected a number from 0 to 1e+06"},
      {changed("33.0", "\"many\""), "scan_primitives: \"many\"; expected"},
      {changed("33.0", "1e999"), ""}};
  for (const auto& [text, words] : cases) {
    write_text(file, text);
    std::vector<std::string> warnings;
    EXPECT_EQ(applied(gpu, "auto", &warnings), PlanConstants()) << text;
    EXPECT_EQ(applied(gpu, "auto", &warnings), PlanConstants());
    ASSERT_LE(warnings.size(), 1u);
    if (warnings.empty()) continue;  // said for the case before
    EXPECT_NE(warnings[0].find(words), std::string::npos) << warnings[0];
    EXPECT_NE(warnings[0].find(file), std::string::npos) << warnings[0];
    EXPECT_EQ(warnings[0].find('\n'), std::string::npos) << warnings[0];
    EXPECT_NE(warnings[0].find("; ignored"), std::string::npos) << warnings[0];
  }
  std::filesystem::remove(file);
  std::filesystem::create_directory(file);
  std::vector<std::string> warnings;
  EXPECT_EQ(applied(gpu, "auto", &warnings), PlanConstants());
  EXPECT_EQ(warnings.size(), 1u);
  // One that the user names is an error.
  expect_error([&] { applied(gpu, file); }, file);
  expect_error([&] { applied(gpu, "/absent.json"); }, "/absent.json");
}

TEST(Calibration, OfARenderIsInItsReportAndItsPlan) {
  const Cache cache;
  const RenderCommand command = command_from({{"scene", "spheres"},
                                              {"spheres", "40"},
                                              {"device", "cpu"},
                                              {"threads", "2"},
                                              {"width", "8"},
                                              {"height", "8"},
                                              {"spp", "1"}});
  RenderSession session(command, {});
  const RenderResult before = render_now(session, command);
  EXPECT_EQ(before.report.calibration, "");
  EXPECT_EQ(before.report.accel, "brute");
  DeviceInfo cpu;
  cpu.properties = cpu_properties(2);
  store_calibration(planted_calibration(calibration_key(cpu, with_threads(2))));
  const RenderResult after = render_now(session, command);  // of the same session
  EXPECT_EQ(after.report.calibration.size(), 16u);
  EXPECT_EQ(after.report.accel, "bvh2");
  EXPECT_EQ(before.image.rgb, after.image.rgb);
  const auto plan = session.plan(command);
  const auto accel = std::ranges::find(plan, "accel", &Decision::option);
  EXPECT_EQ(accel->reason,
            "41 primitives: up to 33 are scanned faster than a tree is walked (measured here)");
}

}  // namespace
}  // namespace pt
