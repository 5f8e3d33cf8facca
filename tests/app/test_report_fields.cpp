// Every field of JSON and CSV, of a run in which no two numbers are the same, none is 0 or 1, and
// the repeats differ in all that they may: a field that shows another one's number is seen.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "app/options/option_list.h"
#include "app/report/film_header.h"
#include "app/report/report.h"
#include "common/platform/build_info.h"
#include "common/scene/data/scene_facts.h"

namespace pt {
namespace {

RenderRun first_run() {
  RenderRun run;
  run.kernel_ms = 8, run.wall_ms = 10;
  run.devices = {{"cuda:0", 5, 600, 7.25, 7.5}, {"cuda:1", 8, 900, 8.0, 9.5}};
  run.stages = {{"generate", 0.75, 5}, {"intersect", 1.5, 40}, {"denoise", 0.375, 9}};
  run.waves = 21, run.samples_done = 31;
  run.ended_by = RunEnd::target_error, run.relative_error = 0.3125;
  run.metropolis =
      MetropolisStats{4100, 2'100'000, 2200, 0.2, 0.13, 0.31, 0.12, 0.83, 12.25, 3.25e6};
  return run;
}

RenderRun last_run() {
  RenderRun run;
  run.kernel_ms = 3, run.wall_ms = 5;
  run.devices = {{"cuda:1", 3, 1500, 3.0, 4.5}};
  run.stages = {{"generate", 0.25, 7}, {"intersect", 2.75, 46}, {"denoise", 0.875, 11}};
  run.waves = 23, run.samples_done = 37;
  run.ended_by = RunEnd::time_limit, run.relative_error = 0.15625;
  run.metropolis =
      MetropolisStats{5100, 3'100'000, 3200, 0.6, 0.14, 0.32, 0.11, 0.84, 13.75, 4.75e6};
  return run;
}

RenderReport unequal_report() {
  RenderReport report;
  report.device_name = "Device", report.device_kind = "kind", report.driver = "driver 5";
  report.plan = {{"accel", "cwbvh", "a reason"}, {"kernel", "loop", "another"}};
  report.mode = "serial", report.accel = "cwbvh", report.schedule = "graph";
  report.stages = "fused";
  report.calibration = "fedc4321";
  report.pool_size = 1111, report.finish_paths = 77, report.primitives = 51;
  report.scene = {101,
                  102,
                  103,
                  104,
                  105,
                  106,
                  107,
                  108,
                  {{"meshes", 201}, {"textures", 202}},
                  {"sbvh", 301, 302, 303, 304.5, 305.5, 306.5}};
  report.scene_ms = 401.5, report.setup_ms = 402.5, report.load_ms = 403.5;
  report.transfer_ms = 404.5, report.image_write_ms = 405.5;
  report.process_ms = {501.5, 502.5, 503.5, 504.5, 505.5, 506.5, 507.5};
  report.exposure = 2.25f;
  report.counts = {11'000'000, 22'000'000, 5'500'000, 13, {11'000'000, 8'000'000, 3'000'000}};
  report.runs = {first_run(), last_run()};
  report.memory = {{"film", 3000}, {"pool", 72}};
  report.kernels = {{"intersect", 61, 16, 128, 256, 0.78125}, {"shadow", 43, 8, 32, 192, 0.625}};
  return report;
}

Options two_repeats() {
  Options options;
  options.repeat = 2;
  return options;
}

// Medians and rates are of both repeats, numbers of things are the last one's: 64 launches.
constexpr const char* expected_json = R"({
  "device": {"name": "Device", "kind": "kind", "driver": "driver 5"},
  "used": {"mode": "serial", "accel": "cwbvh", "schedule": "graph", "stages": "fused", "pool_size": 1111,
           "finish_paths": 77, "primitives": 51, "calibration": "fedc4321",
           "exposure": 2.25},
  "plan": [{"option": "accel", "value": "cwbvh", "reason": "a reason"},
           {"option": "kernel", "value": "loop", "reason": "another"}],
  "scene": {"triangles": 101, "meshes": 102, "instances": 103, "spheres": 104, "quads": 105,
            "materials": 106, "textures": 107, "lights": 108,
            "memory_bytes": {"meshes": 201, "textures": 202}, "builder": "sbvh",
            "tree_nodes": 301, "tree_references": 302, "tree_depth": 303, "sah_cost": 304.5,
            "bytes_per_triangle": 305.5, "build_ms": 306.5},
  "complete": true, "samples_done": 37, "ended_by": "time_limit", "relative_error": 0.15625,
  "metropolis": {"chains": 5100, "mutations": 3100000, "bootstrap": 3200, "brightness": 0.6,
                 "brightness_error": 0.14, "large_share": 0.32, "large_acceptance": 0.11,
                 "small_acceptance": 0.84, "bootstrap_ms": 13.75, "mmutations_per_s": 4.75},
  "time_ms": {"kernel": {"median": 5.5, "min": 3.0, "max": 8.0},
              "wall": {"median": 7.5, "min": 5.0, "max": 10.0}, "scene": 401.5, "setup": 402.5,
              "load": 403.5, "transfer": 404.5, "image_write": 405.5},
  "process_ms": {"start": 501.5, "devices": 502.5, "scene": 503.5, "prepare": 504.5,
                 "setup": 505.5, "render": 506.5, "image": 507.5, "total": 3531.5},
  "rates": {"mpaths_per_s": 2000.0, "mrays_per_s": 5000.0},
  "waves": 23, "launches": 64,
  "stages": [
    {"stage": "generate", "time_ms": {"median": 0.5, "min": 0.25, "max": 0.75}, "launches": 7},
    {"stage": "intersect", "time_ms": {"median": 2.125, "min": 1.5, "max": 2.75}, "launches": 46},
    {"stage": "denoise", "time_ms": {"median": 0.625, "min": 0.375, "max": 0.875}, "launches": 11}],
  "counts": {"paths": 11000000, "rays": 22000000, "shadow_rays": 5500000, "nonfinite_samples": 13,
             "live_paths": [11000000, 8000000, 3000000]},
  "memory": {"total_bytes": 3072, "buffers": [{"name": "film", "size_bytes": 3000},
                                              {"name": "pool", "size_bytes": 72}]},
  "kernels": [
    {"name": "intersect", "registers": 61, "spill_bytes": 16, "shared_bytes": 128,
     "block_threads": 256, "occupancy": 0.78125},
    {"name": "shadow", "registers": 43, "spill_bytes": 8, "shared_bytes": 32,
     "block_threads": 192, "occupancy": 0.625}],
  "counters": null,
  "runs": [
    {"kernel_ms": 8.0, "wall_ms": 10.0, "devices": [
      {"name": "cuda:0", "units": 5, "samples": 600, "kernel_ms": 7.25, "wall_ms": 7.5},
      {"name": "cuda:1", "units": 8, "samples": 900, "kernel_ms": 8.0, "wall_ms": 9.5}],
     "waves": 21, "samples_done": 31, "ended_by": "target_error",
     "relative_error": 0.3125,
     "metropolis": {"chains": 4100, "mutations": 2100000, "bootstrap": 2200, "brightness": 0.2,
                    "brightness_error": 0.13, "large_share": 0.31, "large_acceptance": 0.12,
                    "small_acceptance": 0.83, "bootstrap_ms": 12.25, "mmutations_per_s": 3.25},
     "stages": [{"stage": "generate", "time_ms": 0.75, "launches": 5},
                {"stage": "intersect", "time_ms": 1.5, "launches": 40},
                {"stage": "denoise", "time_ms": 0.375, "launches": 9}]},
    {"kernel_ms": 3.0, "wall_ms": 5.0, "devices": [
      {"name": "cuda:1", "units": 3, "samples": 1500, "kernel_ms": 3.0, "wall_ms": 4.5}],
     "waves": 23, "samples_done": 37, "ended_by": "time_limit",
     "relative_error": 0.15625,
     "metropolis": {"chains": 5100, "mutations": 3100000, "bootstrap": 3200, "brightness": 0.6,
                    "brightness_error": 0.14, "large_share": 0.32, "large_acceptance": 0.11,
                    "small_acceptance": 0.84, "bootstrap_ms": 13.75, "mmutations_per_s": 4.75},
     "stages": [{"stage": "generate", "time_ms": 0.25, "launches": 7},
                {"stage": "intersect", "time_ms": 2.75, "launches": 46},
                {"stage": "denoise", "time_ms": 0.875, "launches": 11}]}]})";

TEST(ReportFields, OfTheJson) {
  auto json = nlohmann::json::parse(report_json(two_repeats(), unequal_report()));
  for (const char* of_build_and_options : {"schema_version", "program", "options"}) {
    EXPECT_EQ(json.erase(of_build_and_options), 1u);
  }
  const auto expected = nlohmann::json::parse(expected_json);
  EXPECT_EQ(json, expected) << nlohmann::json::diff(expected, json).dump(1);
}

TEST(ReportFields, CompleteIsWhatEveryRepeatIs) {
  const auto complete = [](const RenderReport& report) {
    return nlohmann::json::parse(report_json(two_repeats(), report))["complete"].get<bool>();
  };
  RenderReport report = unequal_report();
  report.runs[0].ended_by = RunEnd::interrupted;
  EXPECT_FALSE(complete(report));
  report = unequal_report();
  report.runs[1].ended_by = RunEnd::samples;  // 37 of 50
  EXPECT_FALSE(complete(report));
  report.runs[1].samples_done = two_repeats().spp;
  EXPECT_TRUE(complete(report));
  report.runs.pop_back();
  EXPECT_FALSE(complete(report));
}

// All columns except those of the options and the hardware's counters.
TEST(ReportFields, OfTheCsv) {
  std::map<std::string, std::string> expected{
      {"device_name", "Device"},
      {"device_kind", "kind"},
      {"driver", "driver 5"},
      {"used_mode", "serial"},
      {"used_accel", "cwbvh"},
      {"used_schedule", "graph"},
      {"used_stages", "fused"},
      {"used_pool_size", "1111"},
      {"used_finish_paths", "77"},
      {"primitives", "51"},
      {"used_calibration", "fedc4321"},
      {"used_exposure", "2.25"},
      {"triangles", "101"},
      {"instances", "103"},
      {"lights", "108"},
      {"used_builder", "sbvh"},
      {"tree_nodes", "301"},
      {"tree_references", "302"},
      {"sah_cost", "304.5"},
      {"bytes_per_triangle", "305.5"},
      {"build_ms", "306.500000"},
      {"samples_done", "37"},
      {"ended_by", "time_limit"},
      {"relative_error", "0.15625"},
      {"mlt_chains", "5100"},
      {"mlt_mutations", "3100000"},
      {"mlt_bootstrap", "3200"},
      {"mlt_brightness", "0.6"},
      {"mlt_brightness_error", "0.14"},
      {"mlt_large_share", "0.32"},
      {"mlt_large_acceptance", "0.11"},
      {"mlt_small_acceptance", "0.84"},
      {"mlt_bootstrap_ms", "13.750000"},
      {"mlt_mmutations_per_s", "4.75"},
      {"kernel_ms_median", "5.500000"},
      {"kernel_ms_min", "3.000000"},
      {"kernel_ms_max", "8.000000"},
      {"wall_ms_median", "7.500000"},
      {"wall_ms_min", "5.000000"},
      {"wall_ms_max", "10.000000"},
      {"devices", "cuda:1:3:1500:3.000000:4.500000"},
      {"generate_ms_median", "0.500000"},
      {"generate_ms_min", "0.250000"},
      {"generate_ms_max", "0.750000"},
      {"generate_launches", "7"},
      {"intersect_ms_median", "2.125000"},
      {"intersect_ms_min", "1.500000"},
      {"intersect_ms_max", "2.750000"},
      {"intersect_launches", "46"},
      {"other_ms_median", "0.625000"},
      {"other_ms_min", "0.375000"},
      {"other_ms_max", "0.875000"},
      {"other_launches", "11"},
      {"waves", "23"},
      {"launches", "64"},
      {"mpaths_per_s", "2000"},
      {"mrays_per_s", "5000"},
      {"paths", "11000000"},
      {"rays", "22000000"},
      {"shadow_rays", "5500000"},
      {"nonfinite_samples", "13"},
      {"live_paths", "11000000;8000000;3000000"},
      {"scene_ms", "401.500000"},
      {"setup_ms", "402.500000"},
      {"load_ms", "403.500000"},
      {"transfer_ms", "404.500000"},
      {"image_write_ms", "405.500000"},
      {"process_start_ms", "501.500000"},
      {"process_devices_ms", "502.500000"},
      {"process_scene_ms", "503.500000"},
      {"process_prepare_ms", "504.500000"},
      {"process_setup_ms", "505.500000"},
      {"process_render_ms", "506.500000"},
      {"process_image_ms", "507.500000"},
      {"process_total_ms", "3531.500000"},
      {"memory_bytes", "3072"},
      {"kernels", "intersect:61:16:128:256:0.7812;shadow:43:8:32:192:0.6250"},
      {"counters_problem", ""},
      {"counted_samples", ""},
      {"counted_rays", ""},
      {"counted_kernels", ""}};
  for (const StageInfo& stage : stage_table) {  // those that did not run
    for (const char* suffix : {"_ms_median", "_ms_min", "_ms_max", "_launches"}) {
      expected.try_emplace(std::string(stage.name) + suffix, "");
    }
  }
  for (const auto& field : counter_fields({}, 64)) expected["counted_" + field.first] = "";
  std::map<std::string, std::string> found;
  for (const auto& [name, value] : report_csv_row(two_repeats(), unequal_report())) {
    EXPECT_TRUE(found.emplace(name, value).second) << name;
  }
  const BuildInfo& build = build_info();
  expected.merge(
      std::map<std::string, std::string>{{"schema_version", std::to_string(report_schema_version)},
                                         {"version", build.version},
                                         {"commit", build.commit},
                                         {"build_type", build.build_type},
                                         {"compiler", build.compiler},
                                         {"cuda", build.cuda},
                                         {"fast_math", build.fast_math ? "on" : "off"}});
  for (const OptionEntry& entry : option_list()) EXPECT_EQ(found.erase(option_key(entry)), 1u);
  for (const auto& [name, value] : expected) EXPECT_EQ(found[name], value) << name;
  EXPECT_EQ(found.size(), expected.size());
}

// The header of an image: options apart, whose texts are those of the command line.
TEST(ReportFields, OfTheHeader) {
  std::map<std::string, std::string> header =
      image_header(two_repeats(), unequal_report(), "0123abcd");
  std::erase_if(header, [](const auto& entry) { return entry.first.starts_with("ptexp.option."); });
  const BuildInfo& build = build_info();
  EXPECT_EQ(header.at("ptexp.build").substr(0, build.build_type.size() + 2),
            build.build_type + ", ");
  header.erase("ptexp.build");
  const std::map<std::string, std::string> expected{
      {"ptexp.version", build.version}, {"ptexp.commit", build.commit},
      {"ptexp.device", "Device"},       {"ptexp.samples_done", "37"},
      {"ptexp.ended_by", "time_limit"}, {"ptexp.relative_error", "0.15625"},
      {"ptexp.paths", "11000000"},      {"ptexp.rays", "22000000"},
      {"ptexp.exposure", "2.25"},       {"ptexp.kernel_ms", "5.500000"},
      {"ptexp.scene_ms", "401.500000"}, {"ptexp.setup_ms", "402.500000"},
      {"ptexp.load_ms", "403.500000"},  {"ptexp.transfer_ms", "404.500000"},
      {"ptexp.film_version", "1"},      {"ptexp.device_kind", unequal_report().device_kind},
      {"ptexp.scene_hash", "0123abcd"}};
  EXPECT_EQ(header, expected);
  RenderReport plain = unequal_report();
  plain.exposure.reset(), plain.runs.back().relative_error.reset();
  header = image_header(two_repeats(), plain, "");
  EXPECT_FALSE(header.contains("ptexp.relative_error") || header.contains("ptexp.exposure") ||
               header.contains("ptexp.scene_hash"));
}

// Medians are of both repeats; rates are by the median of the kernel times, 5.5 ms, shares by that
// of the sums over devices.
TEST(ReportFields, OfTheTable) {
  RenderReport report = unequal_report();
  report.runs.back().devices.push_back({"cuda:0", 5, 22'000, 2.0, 4.25});
  report.memory.clear();
  Options options = two_repeats();
  options.target_error = 0.078125f;  // half of what was reached
  EXPECT_EQ(report_table(options, report),
            R"(serial of 'spheres', 600x300, 37 samples per pixel, on Device, 2 repeats

stage              median ms      min ms      max ms    share   launches
generate               0.500       0.250       0.750    4.9 %          7
intersect              2.125       1.500       2.750   21.0 %         46
denoise                0.625       0.375       0.875    6.2 %         11
all devices           10.125       5.000      15.250
kernel time            5.500       3.000       8.000                  64

device             kernel ms     wall ms    units           samples
cuda:1                 3.000       4.500        3             1,500
cuda:0                 2.000       4.250        5            22,000

paths                   11,000,000     2000.00 Mpaths/s
rays                    27,500,000     5000.00 Mrays/s
  of them shadow         5,500,000
waves                           23
NaN, Inf samples                13  left out of the image
mutations                3,100,000        4.75 Mmutations/s
chains                       5,100  after 3,200 bootstrap paths (13.8 ms)
brightness b                   0.6  +- 0.14 mean luminance
large steps                32.00 %
  accepted                 11.00 %
small accepted             84.00 %
ended by                time_limit
standard error            0.156250  of the image's mean luminance
--target-error            0.078125  would take about 4 times the samples

not in the kernel time: scene 401.5 ms, set-up 402.5 ms, loading kernels 403.5 ms, transfer 404.5 ms, writing the image 405.5 ms
process 3532 ms: start 502, devices 502, scene 504, preparing 504, set-up 506, rendering 506, image 508
)");
}

TEST(ReportFields, OfTheSceneThatIsPrinted) {
  EXPECT_EQ(scene_text(unequal_report().scene),
            "scene: 101 triangles, 103 instances, 104 spheres, 106 materials, 108 lights, "
            "107 textures\nmemory: meshes 0.2 KB, textures 0.2 KB\n"
            "tree: sbvh, 301 nodes, depth 303, SAH cost 304.5, 305.5 bytes per triangle, built in "
            "306 ms\n");
  SceneFacts one;
  one.triangles = one.lights = 1;
  one.tree = {"sah", 2, 3, 4, 5.25, 6.75, 9.94};
  EXPECT_EQ(scene_text(one),
            "scene: 1 triangle, 1 light\ntree: sah, 2 nodes, depth 4, SAH cost 5.2, 6.8 bytes per "
            "triangle, built in 9.9 ms\n");
  EXPECT_EQ(scene_text({}), "") << "of spheres alone nothing is said";
}

}  // namespace
}  // namespace pt
