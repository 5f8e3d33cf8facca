// `ptexp trace` and `ptexp rays` as a user runs them, on the CPU.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <sstream>

#include "app/commands/commands.h"
#include "app/options/command_line.h"
#include "app/options/option_values.h"
#include "app/report/csv_file.h"
#include "common/error/terminal.h"
#include "common/options/option_names.h"
#include "common/scene/builtin/generated_scenes.h"
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

TEST(TraceCommandLine, KindsOfRays) {
  const auto kind_of = [](const std::string& kind) {
    return parse<RaysCommand>({"rays", "--mesh", "m", "--output", "r", "--kind", kind});
  };
  EXPECT_EQ(kind_of("ao").kind, RayKind::ao);
  EXPECT_EQ(kind_of("bounce:3").kind, RayKind::bounce);
  EXPECT_EQ(kind_of("bounce:3").bounces, 3);
  expect_error([&] { kind_of("bounce:-1"); }, "--kind -1: expected a whole number");
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
  hits.type = RayType::any;
  write_hits(command_.hits, hits);
  expect_error([&] { trace_command(command_); }, "is not of the rays");
  hits.type = RayType::closest;
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
  DeviceInfo device = choose_device({DeviceChoice::Kind::cpu, 0});
  const auto column = [&](const char* name) {
    for (const auto& [key, value] : origin_columns("", device, 7))
      if (key == name) return value;
    return std::string("missing");
  };
  EXPECT_EQ(column("threads"), "7");
  EXPECT_EQ(column("driver"), "");
  device.choice.kind = DeviceChoice::Kind::cuda;
  EXPECT_EQ(column("threads"), "");
}

TEST_F(TraceFiles, AreTracedOnAPartOfAGpuAlone) {
  command_.limits.sms = 16;
  command_.device = {DeviceChoice::Kind::cpu, 0};
  expect_error([&] { trace_command(command_); },
               "--sms 16: has no effect on the device cpu; it applies to cuda");
  DeviceInfo gpu;
  gpu.choice.kind = DeviceChoice::Kind::cuda, gpu.name = "GPU", gpu.properties.is_cuda = true;
  gpu.properties.multiprocessors = 40;
  const DeviceInfo part = limited(gpu, command_.limits);
  EXPECT_EQ(part.name, "GPU, 16 of 40 multiprocessors");
  EXPECT_EQ(part.properties.multiprocessors, 16);
  EXPECT_EQ(part.sms, 16);
  EXPECT_EQ(limited(gpu, {40, 0}).name, "GPU");
  expect_error([&] { limited(gpu, {41, 0}); }, "--sms 41: the GPU has 40 multiprocessors");
}

TEST_F(TraceFiles, ReplaceNothingThatIsRead) {
  command_.hits = folder_.file("h");
  TraceCommand first = command_;
  std::swap(first.output, first.hits);
  EXPECT_EQ(trace_command(first), 0);
  for (const std::string& read : {command_.mesh, command_.rays, command_.hits}) {
    const std::string before = read_text(read), link = folder_.file("link");
    std::filesystem::remove(link);
    std::filesystem::create_symlink(read, link);
    for (const std::string& name : {read, link}) {
      TraceCommand to_output = command_, to_csv = command_;
      to_output.output = name, to_csv.csv = name;
      expect_error([&] { trace_command(to_output); }, "--output " + name + ": is the file " + read);
      expect_error([&] { trace_command(to_csv); }, name + ": ");
    }
    EXPECT_EQ(read_text(read), before);
  }
  RaysCommand rays;
  rays.size = 16;
  rays.scene = command_.mesh, rays.output = folder_.file("few");
  flush_printed();
  testing::internal::CaptureStdout();
  rays_command(rays);
  flush_printed();
  EXPECT_EQ(testing::internal::GetCapturedStdout(),
            fmt::format("wrote {}: {} rays\n", rays.output, read_rays(rays.output).rays.size()));
  rays.scene = rays.output = command_.mesh;
  expect_error([&] { rays_command(rays); }, "--output " + command_.mesh + ": is the file");
}

// By their values: what is printed, and what the row has of it.
TEST_F(TraceFiles, PrintTheNumbersOfTheRow) {
  command_.csv = folder_.file("c");
  command_.runs.repeat = 16;
  command_.quiet = false;
  flush_printed();
  testing::internal::CaptureStdout();
  EXPECT_EQ(trace_command(command_), 0);
  flush_printed();
  const std::string text = testing::internal::GetCapturedStdout();
  std::istringstream file(read_text(command_.csv));
  std::map<std::string, std::string> row;
  std::string names, values;
  std::getline(file, names), std::getline(file, values);
  const auto cells = [](const std::string& line) {
    std::vector<std::string> result(1);
    bool is_quoted = false;  // then a comma, as in "13.0.88, architectures 90", is no border
    for (const char c : line) {
      if (c == '"') is_quoted = !is_quoted;
      if (c == ',' && !is_quoted) {
        result.emplace_back();
      } else {
        result.back() += c;
      }
    }
    return result;
  };
  const auto all_names = cells(names), all_values = cells(values);
  ASSERT_EQ(all_names.size(), all_values.size());
  for (std::size_t i = 0; i < all_names.size(); ++i) row[all_names[i]] = all_values[i];
  const auto number = [&](const char* name) { return std::stod(row.at(name)); };
  std::smatch found;
  ASSERT_TRUE(std::regex_search(
      text, found,
      std::regex("time +([0-9.]+) ms, ([0-9.]+) to ([0-9.]+) in 16 runs\nrate +([0-9.]+) Mrays/s")))
      << text;
  const char* const columns[] = {"time_ms", "time_min_ms", "time_max_ms", "mrays_per_s"};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(std::stod(found[i + 1]), number(columns[i]), i == 3 ? 0.051 : 6e-5) << columns[i];
  // Two runs of a few microseconds may take the same time.
  EXPECT_LE(number("time_min_ms"), number("time_ms"));
  EXPECT_LE(number("time_ms"), number("time_max_ms"));
  EXPECT_LT(number("time_min_ms"), number("time_max_ms"));
  EXPECT_NEAR(number("mrays_per_s"), number("rays") / number("time_ms") / 1e3,
              1e-4 * number("mrays_per_s"));
  EXPECT_NE(
      text.find(fmt::format("{} nodes, {:.1f} bytes per triangle\n",
                            grouped(std::stoull(row.at("nodes"))), number("bytes_per_triangle"))),
      std::string::npos)
      << text;
  const auto is_printed = [&](const std::string& line) {
    EXPECT_NE(text.find(line), std::string::npos) << line << " in\n" << text;
  };
  const auto whole = [&](const char* name) { return grouped(std::stoull(row.at(name))); };
  is_printed(fmt::format("SAH cost {:.2f}\n", number("sah_cost")));
  // The row has six digits of a time: what they round to may differ from what the time rounds to.
  ASSERT_TRUE(std::regex_search(text, found, std::regex("built in   ([0-9.]+) ms"))) << text;
  EXPECT_NEAR(std::stod(found[1]), number("build_ms"), 0.0501);
  is_printed(fmt::format("tree       {} by {}: {} triangles, ", row.at("accel"), row.at("builder"),
                         whole("triangles")));
  is_printed(
      fmt::format("rays       {}, {} hit, {}\n", whole("rays"), row.at("type"), row.at("variant")));
  is_printed("device     cpu: " + row.at("device") + "\n");
  EXPECT_NE(row.at("rays"), row.at("triangles"));
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
