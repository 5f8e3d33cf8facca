// The tables of stages and of compaction strategies, and what is made of each of their lines.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "app/options/option_list.h"
#include "app/report/report.h"
#include "common/error/error.h"
#include "common/options/option_names.h"
#include "wavefront/stages.h"

namespace pt {
namespace {

TEST(StageTable, EveryStageHasItsPlaceItsNameAndItsQueue) {
  std::set<std::string_view> names;
  int queues = 0;
  for (const StageInfo& stage : stage_table) {
    SCOPED_TRACE(stage.name);
    EXPECT_EQ(&stage_info(stage.id), &stage);
    EXPECT_EQ(to_string(stage.id), stage.name);
    EXPECT_EQ(stage.name.data()[stage.name.size()], '\0');
    EXPECT_TRUE(names.insert(stage.name).second);
    if (stage.has_own_queue()) {
      EXPECT_EQ(queue_index(stage.id), queues++);
    } else if (stage.queue != StageId::idle) {
      EXPECT_TRUE(stage_info(stage.queue).has_own_queue());
      EXPECT_EQ(queue_index(stage.id), queue_index(stage.queue));
    }
  }
  EXPECT_EQ(queues, queue_count);
}

TEST(StageTable, StageBlockHasTheStagesThatSayIt) {
  const OptionEntry& option = find_option("stage-block");
  for (const StageInfo& stage : stage_table) {
    SCOPED_TRACE(stage.name);
    Options options;
    const std::string text = std::string(stage.name) + "=64";
    if (stage.has_block) {
      option.set(options, text);
      for (const StageInfo& other : stage_table) {
        const auto i = static_cast<std::size_t>(other.id);
        EXPECT_EQ(options.stage_block[i], other.id == stage.id ? 64 : Options().stage_block[i]);
      }
      Options again;
      option.set(again, option.text(options));
      EXPECT_EQ(again.stage_block, options.stage_block);
    } else {
      EXPECT_THROW(option.set(options, text), Error);
    }
  }
}

TEST(StageTable, EveryStageHasColumns) {
  RenderReport report;
  report.runs.emplace_back();
  double time_ms = 1;
  for (const StageInfo& stage : stage_table) {
    report.runs[0].stages.push_back({std::string(stage.name), time_ms++, 1});
  }
  std::map<std::string, std::string> fields;
  for (const auto& [name, value] : report_csv_row(Options(), report)) fields[name] = value;
  time_ms = 1;
  for (const StageInfo& stage : stage_table) {
    const std::string column = std::string(stage.name) + "_ms_median";
    EXPECT_EQ(fields[column].empty() ? 0 : std::stod(fields[column]), time_ms++) << stage.name;
  }
}

TEST(StageTable, AWaveBeginsWithTheQueuesOfFreeSlotsAndRaysAlone) {
  WaveCounters counters{};
  for (std::uint32_t& count : counters.waiting) count = 7;
  EXPECT_TRUE(begin_wave(counters, 100, true, 0));
  for (const StageInfo& stage : stage_table) {
    if (!stage.has_own_queue()) continue;
    EXPECT_EQ(counters.waiting[queue_index(stage.id)], 0u) << stage.name;
  }
  EXPECT_EQ(counters.live, 7u);
  EXPECT_EQ(counters.generate, 7u);
  EXPECT_EQ(counters.intersect, 14u);
}

TEST(CompactionTable, EveryStrategyHasItsPlaceAndItsName) {
  for (const CompactionInfo& strategy : compaction_table) {
    EXPECT_EQ(&compaction_info(strategy.id), &strategy);
    EXPECT_EQ(to_string(strategy.id), strategy.name);
    // Somebody must count what waits, and queues must be filled.
    EXPECT_NE(strategy.appends, strategy.pass != TagPass::none) << strategy.name;
    EXPECT_EQ(strategy.has_queues, strategy.pass != TagPass::count) << strategy.name;
  }
}

}  // namespace
}  // namespace pt
