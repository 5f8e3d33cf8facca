// What a run reports: medians, JSON, CSV rows and the file they go to, the table, the metadata.
#include <gtest/gtest.h>

#include <latch>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/options/option_list.h"
#include "app/report/csv_file.h"
#include "app/report/film_header.h"
#include "app/report/report.h"
#include "common/platform/build_info.h"
#include "common/platform/lane_counter.h"
#include "temp_folder.h"

namespace pt {
namespace {

RenderRun make_run(double kernel_ms, double intersect_ms) {
  return {kernel_ms,
          {{"generate", 0.5, 2}, {"intersect", intersect_ms, 40}, {"denoise", 0.25, 1}},
          20,
          50,
          RunEnd::samples,
          {},
          {}};
}

/// Three repeats with kernel times 4, 2 and 3 ms.
RenderReport make_report() {
  RenderReport report;
  report.device_name = "CPU, 8 threads";
  report.device_kind = "cpu";
  report.mode = "wavefront";
  report.accel = "bvh2";
  report.schedule = "host";
  report.stages = "split";
  report.pool_size = 1024;
  report.finish_paths = 77;
  report.primitives = 51;
  report.scene_ms = 1.5;
  report.setup_ms = 2.5;
  report.load_ms = 6.5;
  report.transfer_ms = 3.5;
  report.image_write_ms = 4.5;
  report.counts = {9'000'000, 18'000'000, 3'000'000, 7, {9'000'000, 8'000'000, 1'000'000}};
  report.runs = {make_run(4, 1.5), make_run(2, 0.5), make_run(3, 2.5)};
  report.memory = {{"film", 1000}, {"pool", 24}};
  report.kernels = {{"intersect", 61, 16, 128, 256, 0.75}, {"shadow", 40, 0, 0, 128, 1}};
  return report;
}

/// Two launches of one kernel and one of another, in millions of what they count.
HardwareCounters make_counters() {
  const auto launch = [](const char* kernel, int wave, double size) {
    LaunchCounters result{kernel, wave, {}, {}};
    const auto set = [&](Counter counter, double value) {
      result.values[static_cast<std::size_t>(counter)] = 1e6 * size * value;
    };
    using enum Counter;
    set(time_ns, 2), set(thread_instructions, 24), set(warp_instructions, 1);
    set(issue_cycles, 1), set(scheduler_cycles, 4), set(warp_cycles, 32), set(sm_cycles, 1);
    set(l1_sectors, 8), set(l1_hits, 2), set(l2_hits, 3), set(l2_misses, 1);
    set(l2_bytes, 400), set(l2_sectors_to_sm, 2), set(l2_sectors_from_sm, 1);
    set(dram_read_bytes, 5), set(dram_written_bytes, 6);
    result.predicted = {1e6 * size * 40, 1e6 * size * 20};
    return result;
  };
  HardwareCounters counters;
  counters.samples = 50, counters.rays = 4'000'000, counters.passes = 3;
  counters.warps_per_sm = 64;
  counters.launches = {launch("intersect", 0, 1), launch("shadow", 0, 1),
                       launch("intersect", 1, 2)};
  counters.launches[1].predicted = {};
  return counters;
}

Options make_options() {
  Options options;
  options.repeat = 3;
  options.camera.look_from = {13, 2, 3};
  options.camera.vertical_fov_degrees = 20.5f;
  options.csv_file = "a \"b\", c.csv";
  return options;
}

std::map<std::string, std::string> as_map(const CsvRow& row) { return {row.begin(), row.end()}; }

TEST(Spread, MedianMinAndMax) {
  EXPECT_EQ(spread({}).median, 0);
  EXPECT_EQ(spread({5}).median, 5);
  EXPECT_EQ(spread({3, 1}).median, 2);
  const Spread odd = spread({9, 1, 4});
  EXPECT_EQ(odd.median, 4);
  EXPECT_EQ(odd.min, 1);
  EXPECT_EQ(odd.max, 9);
  EXPECT_EQ(spread({4, 1, 100, 2}).median, 3);
}

TEST(RunSummary, ByHand) {
  const RunSummary summary = summarize(make_report());
  EXPECT_EQ(summary.kernel_ms.median, 3);
  EXPECT_EQ(summary.kernel_ms.min, 2);
  EXPECT_EQ(summary.kernel_ms.max, 4);
  ASSERT_EQ(summary.stages.size(), 3u);
  EXPECT_EQ(summary.stages[1].stage, "intersect");
  EXPECT_EQ(summary.stages[1].time_ms.median, 1.5);
  EXPECT_EQ(summary.stages[1].time_ms.min, 0.5);
  EXPECT_EQ(summary.stages[1].time_ms.max, 2.5);
  EXPECT_EQ(summary.stages[1].launches, 40u);
  EXPECT_EQ(summary.launches, 43u);
  EXPECT_EQ(summary.waves, 20u);
  EXPECT_EQ(summary.samples_done, 50);
  EXPECT_DOUBLE_EQ(summary.mpaths_per_s, 3000);  // 9 M in 3 ms
  EXPECT_DOUBLE_EQ(summary.mrays_per_s, 7000);   // 18 M + 3 M in 3 ms
  EXPECT_EQ(memory_bytes(make_report()), 1024u);
}

TEST(RunSummary, NothingMeasuredIsNotADivisionByZero) {
  RenderReport report;
  EXPECT_EQ(summarize(report).mpaths_per_s, 0);
  report.runs = {RenderRun{}};
  report.counts.paths = 1;
  EXPECT_EQ(summarize(report).mpaths_per_s, 0);
  EXPECT_FALSE(report_table(Options(), report).empty());
}

TEST(RunSummary, AStageThatSomeRepeatsLackCountsWhereItRan) {
  RenderReport report = make_report();
  report.runs[0].stages.erase(report.runs[0].stages.begin());
  const RunSummary summary = summarize(report);
  ASSERT_EQ(summary.stages.size(), 3u);
  EXPECT_EQ(summary.stages.back().stage, "generate");
  EXPECT_EQ(summary.stages.back().time_ms.median, 0.5);
}

TEST(Report, CompleteMeansEveryRepeatAndSample) {
  const Options options = make_options();
  RenderReport report = make_report();
  EXPECT_TRUE(is_complete(options, report));
  report.runs[1].samples_done = 49;
  EXPECT_FALSE(is_complete(options, report));
  report = make_report();
  report.runs.pop_back();
  EXPECT_FALSE(is_complete(options, report));
}

TEST(ReportJson, HasEverything) {
  const auto json = nlohmann::json::parse(report_json(make_options(), make_report()));
  EXPECT_EQ(json["schema_version"], report_schema_version);
  EXPECT_EQ(json["program"]["commit"], build_info().commit);
  EXPECT_EQ(json["program"]["fast_math"], build_info().fast_math);
  EXPECT_EQ(json["device"]["name"], "CPU, 8 threads");
  EXPECT_EQ(json["used"]["mode"], "wavefront");
  EXPECT_EQ(json["used"]["accel"], "bvh2");
  EXPECT_EQ(json["used"]["schedule"], "host");
  EXPECT_EQ(json["used"]["stages"], "split");
  EXPECT_EQ(json["used"]["pool_size"], 1024);
  EXPECT_EQ(json["used"]["finish_paths"], 77);
  EXPECT_EQ(json["used"]["primitives"], 51);
  EXPECT_EQ(json["complete"], true);
  EXPECT_EQ(json["samples_done"], 50);
  EXPECT_EQ(json["time_ms"]["kernel"], (nlohmann::json{{"median", 3}, {"min", 2}, {"max", 4}}));
  EXPECT_EQ(json["time_ms"]["scene"], 1.5);
  EXPECT_EQ(json["time_ms"]["setup"], 2.5);
  EXPECT_EQ(json["time_ms"]["transfer"], 3.5);
  EXPECT_EQ(json["time_ms"]["image_write"], 4.5);
  EXPECT_EQ(json["rates"]["mpaths_per_s"], 3000);
  EXPECT_EQ(json["rates"]["mrays_per_s"], 7000);
  EXPECT_EQ(json["waves"], 20);
  EXPECT_EQ(json["launches"], 43);
  EXPECT_EQ(json["stages"][1]["stage"], "intersect");
  EXPECT_EQ(json["stages"][1]["time_ms"]["max"], 2.5);
  EXPECT_EQ(json["stages"][1]["launches"], 40);
  EXPECT_EQ(json["counts"]["paths"], 9'000'000);
  EXPECT_EQ(json["counts"]["rays"], 18'000'000);
  EXPECT_EQ(json["counts"]["shadow_rays"], 3'000'000);
  EXPECT_EQ(json["counts"]["nonfinite_samples"], 7);
  EXPECT_EQ(json["counts"]["live_paths"], (std::vector<int>{9'000'000, 8'000'000, 1'000'000}));
  EXPECT_EQ(json["memory"]["total_bytes"], 1024);
  EXPECT_EQ(json["memory"]["buffers"][1]["name"], "pool");
  EXPECT_EQ(json["kernels"][0]["registers"], 61);
  EXPECT_EQ(json["kernels"][0]["spill_bytes"], 16);
  EXPECT_EQ(json["kernels"][0]["shared_bytes"], 128);
  EXPECT_EQ(json["kernels"][0]["block_threads"], 256);
  EXPECT_EQ(json["kernels"][0]["occupancy"], 0.75);
  ASSERT_EQ(json["runs"].size(), 3u);
  EXPECT_EQ(json["runs"][0]["kernel_ms"], 4);
  EXPECT_EQ(json["runs"][0]["stages"][1]["time_ms"], 1.5);
}

/// Two full groups and one of a lane at a node, then two groups of 3.
RenderReport make_counting_report() {
  RenderReport report = make_report();
  report.divergence = {{"node", 0, {}}, {"bsdf", 4, {}}};
  report.divergence[0].groups[31] = 2;
  report.divergence[0].groups[0] = 1;
  report.divergence[1].groups[2] = 2;
  return report;
}

TEST(ReportJson, HasActiveLanesOnlyWhereTheyAreCounted) {
  const auto json = nlohmann::json::parse(report_json(make_options(), make_counting_report()));
  ASSERT_EQ(json["divergence"].size(), 2u);
  EXPECT_EQ(json["divergence"][0]["point"], "node");
  EXPECT_EQ(json["divergence"][0]["bounce"], 0);
  ASSERT_EQ(json["divergence"][0]["lanes"].size(), 32u);
  EXPECT_EQ(json["divergence"][0]["lanes"][31], 2);
  EXPECT_EQ(json["divergence"][0]["lanes"][0], 1);
  EXPECT_EQ(json["divergence"][1]["bounce"], 4);
  EXPECT_EQ(json["divergence"][1]["lanes"][2], 2);
  const auto other = nlohmann::json::parse(report_json(make_options(), make_report()));
  EXPECT_FALSE(other.contains("divergence"));
}

RenderReport make_metropolis_report() {
  RenderReport report = make_report();
  report.runs.back().metropolis =
      MetropolisStats{4096, 1'000'000, 2000, 0.25, 0.125, 0.3, 0.1, 0.8, 12.5, 3e6};
  return report;
}

TEST(ReportJson, HasWhatChainsDid) {
  const auto json = nlohmann::json::parse(report_json(make_options(), make_metropolis_report()));
  const auto& chains = json["metropolis"];
  EXPECT_EQ(chains["chains"], 4096);
  EXPECT_EQ(chains["mutations"], 1'000'000);
  EXPECT_EQ(chains["bootstrap"], 2000);
  EXPECT_EQ(chains["brightness"], 0.25);
  EXPECT_EQ(chains["brightness_error"], 0.125);
  EXPECT_EQ(chains["large_share"], 0.3);
  EXPECT_EQ(chains["large_acceptance"], 0.1);
  EXPECT_EQ(chains["small_acceptance"], 0.8);
  EXPECT_EQ(chains["bootstrap_ms"], 12.5);
  EXPECT_EQ(chains["mmutations_per_s"], 3);
  EXPECT_EQ(json["runs"].back()["metropolis"], chains);
  EXPECT_TRUE(json["runs"][0]["metropolis"].is_null());
  const auto other = nlohmann::json::parse(report_json(make_options(), make_report()));
  EXPECT_TRUE(other["metropolis"].is_null());
}

TEST(ReportJson, HasEveryOptionWithItsType) {
  const auto json = nlohmann::json::parse(report_json(make_options(), make_report()));
  const auto& options = json["options"];
  EXPECT_EQ(options.size(), option_list().size());
  for (const OptionEntry& entry : option_list())
    EXPECT_TRUE(options.contains(option_key(entry))) << entry.name;
  EXPECT_EQ(options["width"], 600);
  EXPECT_EQ(options["max_depth"], 50);
  EXPECT_EQ(options["mode"], "auto");
  EXPECT_EQ(options["quiet"], false);
  EXPECT_EQ(options["pool_size"], "auto");
  EXPECT_EQ(options["look_from"], "13,2,3");
  EXPECT_EQ(options["fov"], 20.5);
  EXPECT_TRUE(options["aperture"].is_null());
  EXPECT_TRUE(options["stats"].is_null());
  Options large;
  large.seed = UINT64_MAX;
  large.pool_size = 7;
  const auto others = nlohmann::json::parse(report_json(large, {}))["options"];
  EXPECT_EQ(others["seed"], UINT64_MAX);
  EXPECT_EQ(others["pool_size"], 7);
}

TEST(ReportJson, SurvivesNamesThatAreNoUtf8) {
  Options options;
  options.output = "caf\xe9.exr";
  EXPECT_TRUE(nlohmann::json::accept(report_json(options, make_report())));
}

TEST(ReportCsv, Row) {
  const CsvRow row = report_csv_row(make_options(), make_report());
  EXPECT_EQ(row.front().first, "schema_version");
  auto fields = as_map(row);
  EXPECT_EQ(fields.size(), row.size()) << "a column name occurs twice";
  EXPECT_EQ(fields["schema_version"], std::to_string(report_schema_version));
  EXPECT_EQ(fields["commit"], build_info().commit);
  for (const OptionEntry& entry : option_list())
    EXPECT_EQ(fields.at(option_key(entry)), entry.text(make_options())) << entry.name;
  EXPECT_EQ(fields["device_name"], "CPU, 8 threads");
  EXPECT_EQ(fields["used_pool_size"], "1024");
  EXPECT_EQ(fields["kernel_ms_median"], "3.000000");
  EXPECT_EQ(fields["kernel_ms_min"], "2.000000");
  EXPECT_EQ(fields["kernel_ms_max"], "4.000000");
  EXPECT_EQ(fields["intersect_ms_median"], "1.500000");
  EXPECT_EQ(fields["intersect_launches"], "40");
  EXPECT_EQ(fields["shadow_ms_median"], "");
  EXPECT_EQ(fields["compact_launches"], "");
  EXPECT_EQ(fields["other_ms_median"], "0.250000") << "stages without a column are not lost";
  EXPECT_EQ(fields["waves"], "20");
  EXPECT_EQ(fields["launches"], "43");
  EXPECT_EQ(fields["mpaths_per_s"], "3000");
  EXPECT_EQ(fields["mrays_per_s"], "7000");
  EXPECT_EQ(fields["paths"], "9000000");
  EXPECT_EQ(fields["live_paths"], "9000000;8000000;1000000");
  EXPECT_EQ(fields["memory_bytes"], "1024");
  EXPECT_EQ(fields["setup_ms"], "2.500000");
  EXPECT_EQ(fields["load_ms"], "6.500000");
  EXPECT_EQ(fields["kernels"], "intersect:61:16:128:256:0.7500;shadow:40:0:0:128:1.0000");
}

TEST(ReportCsv, OtherStagesAreOne) {
  RenderReport report = make_report();
  for (RenderRun& run : report.runs) run.stages.push_back({"tone", 0.5, 3});
  auto fields = as_map(report_csv_row(make_options(), report));
  EXPECT_EQ(fields["other_ms_median"], "0.750000");
  EXPECT_EQ(fields["other_launches"], "4");
  EXPECT_EQ(fields["launches"], "46");
}

TEST(ReportJson, Counters) {
  RenderReport report = make_report();
  EXPECT_TRUE(nlohmann::json::parse(report_json(Options(), report))["counters"].is_null());
  report.counters = make_counters();
  const auto json = nlohmann::json::parse(report_json(Options(), report))["counters"];
  EXPECT_TRUE(json["problem"].is_null());
  EXPECT_EQ(json["samples"], 50);
  EXPECT_EQ(json["rays"], 4'000'000);
  EXPECT_EQ(json["passes"], 3);
  EXPECT_EQ(json["uncounted_launches"], 0);
  ASSERT_EQ(json["kernels"].size(), 2u);
  const auto& kernel = json["kernels"][0];
  EXPECT_EQ(kernel["kernel"], "intersect");
  EXPECT_EQ(kernel["launches"], 2);
  EXPECT_DOUBLE_EQ(kernel["time_ms"], 6);
  EXPECT_EQ(kernel["threads_per_instruction"], 24);
  EXPECT_EQ(kernel["issue"], 0.25);
  EXPECT_EQ(kernel["occupancy"], 0.5);
  EXPECT_EQ(kernel["l1_hit_rate"], 0.25);
  EXPECT_EQ(kernel["l2_hit_rate"], 0.75);
  EXPECT_EQ(kernel["l2_bytes"], 1.2e9);
  EXPECT_EQ(kernel["l2_read_bytes"], 192e6);
  EXPECT_EQ(kernel["l2_written_bytes"], 96e6);
  EXPECT_EQ(kernel["dram_read_bytes"], 15e6);
  EXPECT_EQ(kernel["dram_written_bytes"], 18e6);
  EXPECT_EQ(kernel["predicted_read_bytes"], 120e6);
  EXPECT_EQ(kernel["predicted_written_bytes"], 60e6);
  EXPECT_EQ(json["total"]["dram_read_bytes"], 20e6);
  ASSERT_EQ(json["launches"].size(), 3u);
  EXPECT_EQ(json["launches"][2]["kernel"], "intersect");
  EXPECT_EQ(json["launches"][2]["wave"], 1);
  EXPECT_EQ(json["launches"][2]["warp_instructions"], 2e6);
}

TEST(ReportJson, CountersThatCouldNotBeRead) {
  RenderReport report = make_report();
  report.counters = HardwareCounters();
  report.counters->problem = "no permission";
  const auto json = nlohmann::json::parse(report_json(Options(), report));
  EXPECT_EQ(json["counters"], (nlohmann::json{{"problem", "no permission"}}));
  auto fields = as_map(report_csv_row(Options(), report));
  EXPECT_EQ(fields["counters_problem"], "no permission");
  EXPECT_EQ(fields["counted_time_ms"], "");
  EXPECT_EQ(report_table(Options(), report).find("hardware counters"), std::string::npos);
}

// A kernel that counted nothing has no ratios, and no number stands for them.
TEST(ReportJson, RatiosOfNothingAreNull) {
  RenderReport report = make_report();
  report.counters = make_counters();
  report.counters->launches = {{"idle", -1, {}, {}}};
  const auto json = nlohmann::json::parse(report_json(Options(), report))["counters"];
  EXPECT_TRUE(json["kernels"][0]["l1_hit_rate"].is_null());
  EXPECT_TRUE(json["launches"][0]["wave"].is_null());
  EXPECT_EQ(as_map(report_csv_row(Options(), report))["counted_l1_hit_rate"], "");
}

TEST(ReportCsv, Counters) {
  RenderReport report = make_report();
  EXPECT_EQ(as_map(report_csv_row(Options(), report))["counted_kernels"], "");
  report.counters = make_counters();
  auto fields = as_map(report_csv_row(Options(), report));
  EXPECT_EQ(fields["counters_problem"], "");
  EXPECT_EQ(fields["counted_samples"], "50");
  EXPECT_EQ(fields["counted_rays"], "4000000");
  EXPECT_EQ(fields["counted_time_ms"], "8");
  EXPECT_EQ(fields["counted_threads_per_instruction"], "24");
  EXPECT_EQ(fields["counted_dram_written_bytes"], "2.4e+07");
  EXPECT_EQ(fields["counted_kernels"],
            "intersect:2:6:24:0.25:0.5:0.25:0.75:1.2e+09:1.92e+08:9.6e+07:1.5e+07:1.8e+07:1.2e+08:"
            "6e+07;shadow:1:2:24:0.25:0.5:0.25:0.75:4e+08:6.4e+07:3.2e+07:5e+06:6e+06:0:0");
}

TEST(ReportCsv, WhatChainsDid) {
  auto fields = as_map(report_csv_row(Options(), make_metropolis_report()));
  EXPECT_EQ(fields["mlt_chains"], "4096");
  EXPECT_EQ(fields["mlt_mutations"], "1000000");
  EXPECT_EQ(fields["mlt_bootstrap"], "2000");
  EXPECT_EQ(fields["mlt_brightness"], "0.25");
  EXPECT_EQ(fields["mlt_brightness_error"], "0.125");
  EXPECT_EQ(fields["mlt_large_share"], "0.3");
  EXPECT_EQ(fields["mlt_large_acceptance"], "0.1");
  EXPECT_EQ(fields["mlt_small_acceptance"], "0.8");
  EXPECT_EQ(fields["mlt_bootstrap_ms"], "12.500000");
  EXPECT_EQ(fields["mlt_mmutations_per_s"], "3");
  EXPECT_EQ(as_map(report_csv_row(Options(), make_report())).at("mlt_chains"), "");
}

TEST(ReportTable, HasWhatChainsDid) {
  const std::string table = report_table(make_options(), make_metropolis_report());
  for (const char* part :
       {"mutations                1,000,000        3.00 Mmutations/s",
        "chains                       4,096  after 2,000 bootstrap paths (12.5 ms)",
        "brightness b                  0.25  +- 0.12 mean luminance",
        "large steps                30.00 %", "  accepted                 10.00 %",
        "small accepted             80.00 %"})
    EXPECT_NE(table.find(part), std::string::npos) << part << " is not in\n" << table;
  EXPECT_EQ(report_table(make_options(), make_report()).find("chains"), std::string::npos);
}

TEST(ReportTable, Counters) {
  RenderReport report = make_report();
  report.counters = make_counters();
  report.counters->launches.push_back({"begin_wave", 0, {}, {}});  // takes no time
  const std::string table = report_table(make_options(), report);
  for (const char* part :
       {"intersect                       2     6.000     24.0    25.0    50.0    25.0    75.0    "
        "192.00     96.00    120.00     60.00     33.00",
        "shadow                          1     2.000     24.0    25.0    50.0    25.0    75.0     "
        "64.00     32.00         -         -     11.00",
        "bytes per ray: 96 between multiprocessors and L2, 45 predicted, 11 DRAM"})
    EXPECT_NE(table.find(part), std::string::npos) << part << " is not in\n" << table;
  EXPECT_EQ(table.find("begin_wave"), std::string::npos);
  EXPECT_EQ(table.find("not counted"), std::string::npos);
  for (const auto& [name, ns] : {std::pair{"just_shown", 9e3}, {"too_short", 7e3}}) {  // of 8 ms
    LaunchCounters& launch = report.counters->launches.emplace_back();
    launch.kernel = name;
    launch.values[static_cast<std::size_t>(Counter::time_ns)] = ns;
  }
  const std::string more = report_table(make_options(), report);
  EXPECT_NE(more.find("\njust_shown                      1     0.009"), std::string::npos) << more;
  EXPECT_EQ(more.find("too_short"), std::string::npos);
  report.counters->uncounted_launches = 7;
  EXPECT_NE(report_table(make_options(), report).find("the last 7 launches were not counted"),
            std::string::npos);
}

TEST(ReportCsv, ColumnsDoNotDependOnTheRun) {
  const CsvRow full = report_csv_row(make_options(), make_report());
  const CsvRow empty = report_csv_row(Options(), RenderReport());
  ASSERT_EQ(full.size(), empty.size());
  for (std::size_t i = 0; i < full.size(); ++i) EXPECT_EQ(full[i].first, empty[i].first);
}

TEST(CsvFile, HeaderOnceAndQuoting) {
  const TempFolder folder;
  const std::string path = folder.file("runs.csv");
  append_csv_row(path, {{"a", "1"}, {"b", "x, \"y\"\nz"}});
  append_csv_row(path, {{"a", ""}, {"b", "2"}});
  append_csv_row(path, {{"a", "c\rd"}, {"b", "e\"f"}});
  EXPECT_EQ(read_text(path), "a,b\n1,\"x, \"\"y\"\"\nz\"\n,2\n\"c\rd\",\"e\"\"f\"\n");
}

TEST(CsvFile, AnEmptyFileGetsTheHeader) {
  const TempFolder folder;
  write_text(folder.file("runs.csv"), "");
  append_csv_row(folder.file("runs.csv"), {{"a", "1"}});
  EXPECT_EQ(read_text(folder.file("runs.csv")), "a\n1\n");
}

TEST(CsvFile, OtherColumnsAreRefusedAndUntouched) {
  const TempFolder folder;
  const std::string path = folder.file("runs.csv");
  for (const char* text : {"a,c\n1,2\n", "a\n", "a,b,c\n", "a,b", "\n", "1,2\n"}) {
    write_text(path, text);
    const CsvRow row{{"a", "1"}, {"b", "2"}};
    expect_error([&] { check_csv(path, row); }, path + ": has other columns");
    expect_error([&] { append_csv_row(path, row); }, path + ": has other columns");
    EXPECT_EQ(read_text(path), text);
  }
}

TEST(CsvFile, ARowLeftOpenIsEnded) {
  const TempFolder folder;
  write_text(folder.file("runs.csv"), "a,b\n1,2");
  append_csv_row(folder.file("runs.csv"), {{"a", "3"}, {"b", "4"}});
  EXPECT_EQ(read_text(folder.file("runs.csv")), "a,b\n1,2\n3,4\n");
}

TEST(CsvFile, CheckCreatesAndChangesNothing) {
  const TempFolder folder;
  const CsvRow row{{"a", "1"}};
  EXPECT_NO_THROW(check_csv(folder.file("new.csv"), row));
  EXPECT_TRUE(folder.entries().empty());
  write_text(folder.file("old.csv"), "a\n7\n");
  EXPECT_NO_THROW(check_csv(folder.file("old.csv"), row));
  EXPECT_EQ(read_text(folder.file("old.csv")), "a\n7\n");
  expect_error([&] { check_csv(folder.file("none/x.csv"), row); }, "none/x.csv: cannot be created");
  expect_error([&] { check_csv(folder.file(""), row); }, "cannot be appended to");
  expect_error([&] { append_csv_row(folder.file("none/x.csv"), row); }, "cannot be appended to");
}

TEST(CsvFile, ParallelRunsNeitherInterleaveNorRepeatTheHeader) {
  const TempFolder folder;
  const std::string value(5000, 'x');
  for (int round = 0; round < 100; ++round) {  // many new files: the first rows race
    const std::string path = folder.file(std::to_string(round));
    std::latch start(4);
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&] {
        start.arrive_and_wait();
        for (int i = 0; i < 3; ++i) append_csv_row(path, {{"a", value}, {"b", "1"}});
      });
    }
    threads.clear();  // joins them
    std::string expected = "a,b\n";
    for (int i = 0; i < 12; ++i) expected += value + ",1\n";
    ASSERT_TRUE(read_text(path) == expected) << "in round " << round;
  }
}

TEST(ReportTable, NamesWhatWasMeasured) {
  const std::string table = report_table(make_options(), make_report());
  for (const char* part :
       {"wavefront of 'spheres', 600x300, 50 samples per pixel, on CPU, 8 threads, 3 repeats",
        "intersect              1.500       0.500       2.500   50.0 %         40", "kernel time",
        "9,000,000     3000.00 Mpaths/s", "21,000,000     7000.00 Mrays/s", "scene 1.5 ms",
        "set-up 2.5 ms", "transfer 3.5 ms", "image 4.5 ms", "waves", "left out of the image"})
    EXPECT_NE(table.find(part), std::string::npos) << part << " is not in\n" << table;
  EXPECT_EQ(table.back(), '\n');
}

TEST(ReportTable, WarnsOfTimesWhereLanesAreCounted) {
  const std::string table = report_table(make_options(), make_counting_report());
  for (const char* part :
       {"This build counts lanes: its times tell nothing.",
        "node                         21.67            67.7 %                 3",
        "bsdf                          3.00             9.4 %                 2"})
    EXPECT_NE(table.find(part), std::string::npos) << part << " is not in\n" << table;
  EXPECT_EQ(report_table(make_options(), make_report()).find("lanes"), std::string::npos);
}

TEST(Build, NamesItsDivergenceCounters) {
  const bool is_named = build_info().build_type.find("divergence counters") != std::string::npos;
  EXPECT_EQ(is_named, counts_lanes);
}

TEST(ReportMetadata, HasOptionsDeviceBuildAndTimes) {
  auto metadata = image_header(make_options(), make_report(), "");
  EXPECT_EQ(metadata["ptexp.commit"], build_info().commit);
  EXPECT_EQ(metadata["ptexp.device"], "CPU, 8 threads");
  EXPECT_EQ(metadata["ptexp.kernel_ms"], "3.000000");
  EXPECT_EQ(metadata["ptexp.samples_done"], "50");
  EXPECT_EQ(metadata["ptexp.option.seed"], "1");
  EXPECT_EQ(metadata["ptexp.option.look_from"], "13,2,3");
  EXPECT_FALSE(metadata.contains("ptexp.option.look_at"));
  for (const auto& [name, value] : metadata) {
    EXPECT_LE(name.size(), 79u) << "the longest keyword of a PNG";
    EXPECT_FALSE(value.empty()) << name;
  }
}

}  // namespace
}  // namespace pt
