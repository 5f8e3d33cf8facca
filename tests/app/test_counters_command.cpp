// ptexp --counters where nothing can be counted: it says so, and the rest goes on.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/commands/commands.h"
#include "app/options/command_line.h"
#include "common/image/codecs/image_io.h"
#include "temp_folder.h"

namespace pt {
namespace {

TEST(CountersCommand, WhatCannotBeCountedLosesNoImage) {
  const TempFolder folder;
  RenderCommand command;
  Options& options = command.options;
  options.width = 8, options.height = 4, options.spp = 1;
  options.device.kind = DeviceChoice::Kind::cpu;  // has no counters
  options.counters = true;                        // not `given`, which would be refused
  options.quiet = true;
  options.output = folder.file("image.ppm");
  options.stats_file = folder.file("run.json");
  options.csv_file = folder.file("runs.csv");
  testing::internal::CaptureStderr();
  Ranks ranks;
  const int status = render_command(command, ranks);
  const std::string warning = testing::internal::GetCapturedStderr();
  EXPECT_EQ(status, 0);
  EXPECT_EQ(warning, "ptexp: warning: --counters: no counters of this device are known\n");
  EXPECT_EQ(read_image(options.output).width, 8);
  const auto json = nlohmann::json::parse(read_text(options.stats_file));
  EXPECT_EQ(json["counters"]["problem"], "no counters of this device are known");
  EXPECT_EQ(json["complete"], true);
  EXPECT_NE(read_text(options.csv_file).find("no counters of this device are known"),
            std::string::npos);
}

TEST(CountersCommand, IsForGpus) {
  const auto refusal = [](std::vector<std::string> arguments) {
    return [arguments] { parse_command_line(arguments); };
  };
  expect_error(refusal({"--counters", "--device", "cpu"}), "--counters");
  expect_error(refusal({"--counters", "--mode", "serial"}), "--counters");
  EXPECT_NO_THROW(parse_command_line({"--counters", "--mode", "megakernel"}));
}

}  // namespace
}  // namespace pt
