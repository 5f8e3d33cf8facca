// `ptexp trace` and `ptexp rays` as a user runs them, on the CPU.
#include <gtest/gtest.h>

#include "app/options/command_line.h"
#include "app/trace_command.h"
#include "common/options/option_names.h"
#include "common/scene/builtin/generated/generate_terrain.h"
#include "temp_folder.h"

namespace pt {
namespace {

template <class T>
T parse(const std::vector<std::string>& arguments) {
  return std::get<T>(parse_command_line(arguments));
}

TEST(TraceCommandLine, ReadsAllOptions) {
  const auto c = parse<TraceCommand>(
      {"trace",   "--mesh",    "m",        "--rays",   "r",     "--accel",  "bvh2",     "--hits",
       "h",       "--builder", "sbvh",     "--repeat", "5",     "--warmup", "2",        "--variant",
       "threads", "--quiet",   "--device", "cuda:1",   "--csv", "c",        "--output", "o"});
  EXPECT_EQ(c.mesh + c.rays + c.hits + c.csv + c.output, "mrhco");
  EXPECT_EQ(c.accel, AccelKind::bvh2);
  EXPECT_EQ(c.builder, TreeBuilder::sbvh);
  EXPECT_EQ(c.runs.repeat, 5);
  EXPECT_EQ(c.runs.warmup, 2);
  EXPECT_EQ(c.runs.variant, TraceVariant::threads);
  EXPECT_EQ(c.device.index, 1);
  EXPECT_TRUE(c.quiet);
}

TEST(TraceCommandLine, IsKeptForTheRecord) {
  const auto c = parse<TraceCommand>({"trace", "--mesh", "a b", "--rays", "it's", "--hits", ""});
  EXPECT_EQ(c.command_line, "trace --mesh 'a b' --rays 'it'\\''s' --hits ''");
}

TEST(TraceCommandLine, RefusesWhatItCannotDo) {
  const auto refuse = [](std::vector<std::string> arguments, const std::string& part) {
    expect_error([&] { parse_command_line(arguments); }, part);
  };
  refuse({"trace", "--mesh", "m"}, "--rays");
  refuse({"trace", "--mesh", "m", "--rays", "r", "--accel", "embree"}, "--accel embree");
  refuse({"trace", "--mesh", "m", "--rays", "r", "--variant", "fast"}, "--variant fast");
  refuse({"trace", "--mesh", "m", "--rays", "r", "--repeat", "0"}, "--repeat 0");
  refuse({"trace", "--accel", "bvh2", "--mesh", "m", "--rays", "r", "--accel", "embree"},
         "--accel embree");  // the last holds
  refuse({"rays", "--mesh", "m", "--output", "r", "--size", "100"}, "--size 100");
  refuse({"rays", "--mesh", "m"}, "--output");
  refuse({"rays", "--scene", "s", "--mesh", "m", "--output", "r"},
         "--scene s: expected either --scene or --mesh m");
}

class TraceFiles : public testing::Test {
 protected:
  void SetUp() override {
    write_trace_mesh(folder_.file("m.mesh"), generate_terrain(2000));
    RaysCommand rays;
    rays.scene = folder_.file("m.mesh");
    rays.output = folder_.file("r");
    rays.size = 16;
    rays.camera.look_from = {-490, 175, 490};
    rays.camera.look_at = {0, 10, 0};
    rays_command(rays);
    command_.mesh = folder_.file("m.mesh");
    command_.rays = folder_.file("r");
    command_.device = {DeviceChoice::Kind::cpu, 0};
    command_.quiet = true;
  }

  TempFolder folder_;
  TraceCommand command_;
};

TEST_F(TraceFiles, ComparesWithAReference) {
  command_.accel = AccelKind::brute;
  command_.output = folder_.file("h");
  EXPECT_EQ(trace_command(command_), 0);
  command_.output.clear();
  command_.hits = folder_.file("h");
  for (const AccelKind accel : {AccelKind::bvh2, AccelKind::cwbvh}) {
    command_.accel = accel;
    EXPECT_EQ(trace_command(command_), 0);
  }
  HitSet hits = read_hits(command_.hits);
  for (HitRecord& hit : hits.hits) hit.t *= 1.001f;
  write_hits(command_.hits, hits);
  EXPECT_EQ(trace_command(command_), 1);
  hits.hits.pop_back();
  write_hits(command_.hits, hits);
  expect_error([&] { trace_command(command_); }, "is not of the rays");
}

TEST_F(TraceFiles, AppendsRows) {
  command_.csv = folder_.file("c");
  command_.runs.repeat = 2;
  command_.command_line = "trace --mesh m,n";
  trace_command(command_);
  trace_command(command_);
  const std::string text = read_text(command_.csv);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
  EXPECT_NE(text.find(",fast_math,command,device,device_kind,threads,driver,"), std::string::npos);
  EXPECT_NE(text.find(",\"trace --mesh m,n\",CPU,cpu,"), std::string::npos) << text;
}

TEST_F(TraceFiles, BuildersOfTheDeviceNeedOne) {
  for (const TreeBuilder builder :
       {TreeBuilder::lbvh, TreeBuilder::hploc, TreeBuilder::hploc_reinsert}) {
    command_.builder = builder;
    expect_error([&] { trace_command(command_); },
                 "--builder " + to_string(builder) + ": needs a CUDA device");
  }
}

TEST_F(TraceFiles, NoBuilderWithoutATree) {
  command_.accel = AccelKind::brute;
  command_.builder = TreeBuilder::sbvh;
  expect_error([&] { trace_command(command_); },
               "--builder sbvh: has no effect with --accel brute");
  command_.builder = TreeBuilder::automatic;
  EXPECT_EQ(trace_command(command_), 0);
}

TEST_F(TraceFiles, VariantsAreCudas) {
  command_.runs.variant = TraceVariant::beam;
  expect_error([&] { trace_command(command_); }, "--variant");
}

}  // namespace
}  // namespace pt
