// `ptexp compact` as a user runs it, on the CPU.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <tuple>

#include "app/commands/commands.h"
#include "app/options/command_line.h"
#include "app/options/option_values.h"
#include "temp_folder.h"

namespace pt {
namespace {

CompactCommand parse_compact(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "compact");
  return std::get<CompactCommand>(parse_command_line(arguments));
}

TEST(CompactCommandLine, ReadsAllOptions) {
  const CompactCommand c = parse_compact(
      {"--items",  "1,5K,2M", "--density",  "0,0.25,1", "--run",    "2K",     "--queues", "2,1",
       "--cache",  "warm",    "--strategy", "none,cub", "--device", "cuda:1", "--sms",    "16",
       "--repeat", "5",       "--warmup",   "0",        "--csv",    "c",      "--quiet"});
  EXPECT_EQ(c.items, (std::vector<std::uint32_t>{1, 5 << 10, 2 << 20}));
  EXPECT_EQ(c.densities, (std::vector<float>{0.0f, 0.25f, 1.0f}));
  EXPECT_EQ(c.run_length, 2048u);
  EXPECT_EQ(c.queues, (std::vector<int>{2, 1}));
  EXPECT_FALSE(c.runs.cold);
  EXPECT_EQ(c.strategies, (std::vector<Compaction>{Compaction::none, Compaction::cub}));
  EXPECT_EQ(c.device.index, 1);
  EXPECT_EQ(c.limits.sms, 16);
  EXPECT_EQ(c.runs.repeat, 5);
  EXPECT_EQ(c.runs.warmup, 0);
  EXPECT_EQ(c.csv, "c");
  EXPECT_TRUE(c.quiet);
  EXPECT_EQ(parse_compact({"--items", "64K"}).command_line, "compact --items 64K");
}

// What the help says of them.
TEST(CompactCommandLine, HasDefaults) {
  const CompactCommand c = parse_compact({});
  EXPECT_EQ(c.items, (std::vector<std::uint32_t>{1 << 20, 4 << 20, 16 << 20}));
  EXPECT_EQ(c.densities, (std::vector<float>{0.1f, 0.5f, 0.9f}));
  EXPECT_EQ(c.queues, (std::vector<int>{1, 2}));
  EXPECT_EQ(c.strategies, (std::vector<Compaction>{Compaction::cub, Compaction::scan,
                                                   Compaction::atomic, Compaction::none}));
  EXPECT_EQ(c.run_length, 1u);
  EXPECT_TRUE(c.runs.cold);
  EXPECT_EQ(c.runs.repeat, 10);
  EXPECT_EQ(c.runs.warmup, 3);
}

TEST(CompactCommandLine, RefusesWhatItCannotDo) {
  const auto refuse = [](const std::vector<std::string>& arguments, const std::string& part) {
    expect_error([&] { parse_compact(arguments); }, part);
  };
  refuse({"--items", "0"}, "--items 0: expected a number of slots from 1 to 1,073,741,824");
  refuse({"--items", "1M,"}, "--items ''");
  refuse({"--items", "1025M"}, "--items 1025M");
  refuse({"--density", "0.5,1.5"}, "--density 1.5: expected a number from 0 to 1");
  refuse({"--density", "nan"}, "--density nan");
  refuse({"--queues", "3"}, "--queues 3");
  refuse({"--run", "0"}, "--run 0");
  refuse({"--strategy", "cub,fast"}, "--strategy fast: expected one of cub, scan");
  refuse({"--strategy", "sort"}, "--strategy sort: expected one of cub, scan");
  refuse({"--cache", "hot"}, "--cache hot");
  refuse({"--sms", "many"}, "--sms many: expected a whole number");
  expect_error(
      [] {
        compact_command(parse_compact({"--device", "cpu", "--sms", "8"}));
      },
      "--sms 8: has no effect on the device cpu; it applies to cuda");
  refuse({"--repeat", "0"}, "--repeat 0");
  refuse({"--items", "1", "--items", "0"}, "--items 0");  // the last holds
  refuse({"--spp", "5"}, "--spp");
}

using Row = std::map<std::string, std::string>;

/// The commas inside of quotes, as in the name of a toolkit, become blanks.
std::vector<std::string> fields_of(std::string line) {
  bool quoted = false;
  for (char& c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && quoted) c = ' ';
  }
  return split(line, ',');
}

std::vector<Row> read_rows(const std::string& path) {
  std::istringstream text(read_text(path));
  std::vector<Row> rows;
  std::vector<std::string> names;
  for (std::string line; std::getline(text, line);) {
    const std::vector<std::string> fields = fields_of(line);
    if (names.empty()) {
      names = fields;
      continue;
    }
    EXPECT_EQ(fields.size(), names.size()) << line;
    rows.emplace_back();
    for (std::size_t i = 0; i < names.size(); ++i) rows.back()[names[i]] = fields[i];
  }
  return rows;
}

class CompactFiles : public testing::Test {
 protected:
  void SetUp() override {
    command_.items = {1000, 70'000};
    command_.densities = {0.0f, 0.5f};
    command_.runs = {1, 3, false};
    command_.device = {DeviceChoice::Kind::cpu, 0};
    command_.csv = folder_.file("c");
    command_.command_line = "compact";
    command_.quiet = true;
  }

  TempFolder folder_;
  CompactCommand command_;
};

TEST_F(CompactFiles, HaveARowForEachMeasurement) {
  EXPECT_EQ(compact_command(command_), 0);
  const std::vector<Row> rows = read_rows(command_.csv);
  ASSERT_EQ(rows.size(), 2u * 2 * 2 * 4);
  for (Row row : rows) {
    const auto number = [&](const std::string& name) { return std::stod(row.at(name)); };
    SCOPED_TRACE(row["strategy"] + ", " + row["items"] + ", " + row["density"]);
    EXPECT_EQ(row["device_kind"], "cpu");
    EXPECT_EQ(row["cache"], "warm");
    EXPECT_EQ(row["sets"], "1");
    const double gathered = row["strategy"] == "none" ? 0 : number("waiting");
    EXPECT_EQ(number("bytes"), number("items") + 4 * gathered);
    EXPECT_NEAR(number("waiting") / number("items"), number("density"), 0.08);
    EXPECT_LE(number("time_min_ms"), number("time_ms"));
    EXPECT_LE(number("time_ms"), number("time_max_ms"));
    EXPECT_GT(number("time_min_ms"), 0);
    EXPECT_NEAR(number("gb_per_s") * number("time_ms") * 1e6 / number("bytes"), 1, 1e-4);
    EXPECT_EQ(row["kernel_gb_per_s"], "");
    EXPECT_EQ(row["copy_gb_per_s"], row["memcpy_gb_per_s"]);
    EXPECT_NEAR(number("gb_per_s") / number("copy_gb_per_s") / number("copy_share"), 1, 1e-4);
  }
  EXPECT_EQ(rows[0].at("strategy"), "cub");
  EXPECT_EQ(rows[1].at("strategy"), "scan");
  EXPECT_EQ(rows[2].at("strategy"), "atomic");
  EXPECT_EQ(rows[3].at("strategy"), "none");
  EXPECT_EQ(rows[0].at("queues") + rows.back().at("queues"), "12");
}

// By their values: each line that is printed, and its row.
TEST_F(CompactFiles, HaveTheNumbersThatArePrinted) {
  command_.quiet = false;
  testing::internal::CaptureStdout();
  EXPECT_EQ(compact_command(command_), 0);
  std::istringstream text(testing::internal::GetCapturedStdout());
  const std::vector<Row> rows = read_rows(command_.csv);
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(line, "device     cpu: " + rows[0].at("device"));
  std::getline(text, line);
  for (const Row& row : rows) {
    SCOPED_TRACE(row.at("strategy"));
    ASSERT_TRUE(std::getline(text, line));
    std::erase(line, ',');
    std::istringstream words(line);
    std::string word;
    const std::tuple<const char*, double, double> columns[] = {{"queues", 1, 0},
                                                               {"items", 1, 0},
                                                               {"density", 1, 1e-4},
                                                               {"time_ms", 1e3, 0.006},
                                                               {"time_min_ms", 1e3, 0.006},
                                                               {"time_max_ms", 1e3, 0.006},
                                                               {"gb_per_s", 1, 0.051},
                                                               {"copy_gb_per_s", 1, 0.051},
                                                               {"copy_share", 1, 0.00051}};
    words >> word;
    EXPECT_EQ(word, row.at("strategy"));
    for (const auto& [name, scale, tolerance] : columns) {
      words >> word;
      // The row has six digits.
      const double right = scale * std::stod(row.at(name));
      EXPECT_NEAR(std::stod(word), right, tolerance + 1e-5 * right) << name << " in " << line;
    }
    EXPECT_FALSE(words >> word);
  }
}

TEST_F(CompactFiles, OfOtherColumnsAreRefusedBeforeAnythingIsMeasured) {
  write_text(command_.csv, "a,b\n1,2\n");
  expect_error([&] { compact_command(command_); }, command_.csv);
  EXPECT_EQ(read_text(command_.csv), "a,b\n1,2\n");
}

TEST_F(CompactFiles, AreNotNeededForTheTable) {
  command_.csv.clear();
  command_.quiet = false;
  command_.items = {2048};
  command_.strategies = {Compaction::atomic};
  testing::internal::CaptureStdout();
  compact_command(command_);
  const std::string text = testing::internal::GetCapturedStdout();
  EXPECT_EQ(std::ranges::count(text, '\n'), 2 + 2 * 2) << text;
  for (const char* part : {"device     cpu", "us a pass", "share", "atomic", "2,048"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " is not in\n" << text;
  }
  command_.quiet = true;
  testing::internal::CaptureStdout();
  compact_command(command_);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace pt
