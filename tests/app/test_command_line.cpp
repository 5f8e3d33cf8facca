// Parsing: every option, every default, everything that is refused and what is said about it.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "app/options/command_line.h"
#include "app/options/option_list.h"
#include "app/options/option_values.h"
#include "common/options/option_names.h"
#include "temp_folder.h"

namespace pt {
namespace {

/// Split at blanks; '' stands for an empty argument.
Command parse(const std::string& line) {
  std::istringstream words(line);
  std::vector<std::string> arguments;
  for (std::string word; words >> word;) arguments.push_back(word == "''" ? "" : word);
  return parse_command_line(arguments);
}

RenderCommand parse_render(const std::string& line) { return std::get<RenderCommand>(parse(line)); }

Options parse_options(const std::string& line) { return parse_render(line).options; }

/// A value of each option that is not its default, and a mode in which it applies.
const std::map<std::string, std::string>& other_values() {
  static const std::map<std::string, std::string> values{
      {"width", "65535"},
      {"height", "1"},
      {"integrator", "mlt"},
      {"chains", "4096"},
      {"large-step-probability", "0.25"},
      {"mutation-size", "0.125"},
      {"bootstrap", "100000"},
      {"spp", "2147483647"},
      {"max-depth", "65535"},
      {"rr", "5"},
      {"nee", "off"},
      {"light-selection", "power"},
      {"mis", "balance"},
      {"sampling", "cosine"},
      {"sampler", "sobol"},
      {"multiple-scattering", "on"},
      {"stages", "fused"},
      {"wave-rays", "3"},
      {"wave-collisions", "4"},
      {"path-bytes", "48"},
      {"calibration", "none"},
      {"sms", "16"},
      {"shared-memory-max", "64"},
      {"seed", "18446744073709551615"},
      {"output", "a b.png"},
      {"exposure", "-1.5"},
      {"crop", "1,2,30,20"},
      {"filter", "mitchell:0.25:0.5"},
      {"aov", "albedo,depth"},
      {"time-limit", "2.5"},
      {"target-error", "0.125"},
      {"scene", "rtow"},
      {"define", "a=1"},
      {"strict", "on"},
      {"default-lighting", "off"},
      {"volume", "dense"},
      {"time", "-0.25"},
      {"shutter", "0.5"},
      {"animation", "Run 2"},
      {"scene-from-disk", "on"},
      {"checkpoint", "c.exr,20.5"},
      {"part", "3/16"},
      {"spheres", "0"},
      {"create-world", "device"},
      {"look-from", "13,-2,0.1"},
      {"look-at", "0,1e-05,-3e+20"},
      {"up", "0,0,1"},
      {"fov", "20.5"},
      {"aperture", "0"},
      {"focus-distance", "10"},
      {"mode", "megakernel"},
      {"device", "cuda:3"},
      {"threads", "7"},
      {"accel", "bvh2"},
      {"builder", "sbvh"},
      {"work", "sample"},
      {"block", "32x4"},
      {"kernel-set", "general"},
      {"optix-hits", "any-hit"},
      {"reorder", "on"},
      {"order-surfaces", "on"},
      {"kernel", "vote"},
      {"compaction", "cub"},
      {"pool-size", "1048576"},
      {"layout", "aos"},
      {"finish-paths", "1000"},
      {"regenerate", "off"},
      {"persistent", "off"},
      {"schedule", "graph"},
      {"stage-block", "256,intersect=128,shade_surface=64,shadow=1024,accumulate=1"},
      {"scene-memory", "constant"},
      {"branching", "reduced"},
      {"rng", "xorwow"},
      {"repeat", "10"},
      {"warmup", "3"},
      {"counters", "on"},
      {"stats", "run.json"},
      {"csv", "runs.csv"},
      {"explain", "on"},
      {"quiet", "on"}};
  return values;
}

std::vector<std::string> arguments_for(const OptionEntry& entry, const std::string& value) {
  std::vector<std::string> arguments{"--" + entry.name};
  if (entry.form != OptionForm::flag) arguments.push_back(value);
  if (entry.name == "exposure") arguments.insert(arguments.end(), {"--output", "image.png"});
  if (entry.group == OptionGroup::metropolis) {
    arguments.insert(arguments.end(), {"--integrator", "mlt"});
  }
  if (entry.name == "animation" || entry.name == "shutter")
    arguments.insert(arguments.end(), {"--time", "1"});
  if (entry.name == "optix-hits" || entry.name == "reorder")
    arguments.insert(arguments.end(), {"--accel", "optix"});
  if (entry.name == "part") arguments.insert(arguments.end(), {"--checkpoint", "c.exr"});
  if (entry.name == "wave-rays") arguments.insert(arguments.end(), {"--stages", "fused"});
  if (entry.name == "work" || entry.name == "block" || entry.name == "kernel" ||
      entry.name == "reorder")
    arguments.insert(arguments.end(), {"--mode", "megakernel"});
  return arguments;
}

TEST(CommandLine, DefaultsAreThoseOfOptions) {
  const RenderCommand command = parse_render("");
  for (const OptionEntry& entry : option_list())
    EXPECT_EQ(entry.text(command.options), entry.text(Options())) << entry.name;
  EXPECT_TRUE(command.given.empty());
  const Options& options = command.options;
  EXPECT_EQ(options.mode, Mode::automatic);
  EXPECT_EQ(options.width, 600);
  EXPECT_EQ(options.height, 300);
  EXPECT_EQ(options.spp, 50);
  EXPECT_EQ(options.output, "image.exr");
  EXPECT_FALSE(options.camera.look_from);
}

// The documented defaults, by hand; an option that is not here has none, or is off.
TEST(CommandLine, DefaultsAreTheDocumentedOnes) {
  const std::map<std::string, std::string> expected{{"width", "600"},
                                                    {"height", "300"},
                                                    {"spp", "50"},
                                                    {"integrator", "path"},
                                                    {"max-depth", "50"},
                                                    {"rr", "0"},
                                                    {"nee", "on"},
                                                    {"light-selection", "auto"},
                                                    {"mis", "power"},
                                                    {"sampling", "bsdf"},
                                                    {"sampler", "independent"},
                                                    {"seed", "1"},
                                                    {"output", "image.exr"},
                                                    {"chains", "auto"},
                                                    {"large-step-probability", "0.05"},
                                                    {"mutation-size", "0.00390625"},
                                                    {"bootstrap", "auto"},
                                                    {"scene", "spheres"},
                                                    {"default-lighting", "auto"},
                                                    {"volume", "auto"},
                                                    {"spheres", "50"},
                                                    {"create-world", "host"},
                                                    {"mode", "auto"},
                                                    {"device", "auto"},
                                                    {"threads", "0"},
                                                    {"accel", "auto"},
                                                    {"builder", "auto"},
                                                    {"work", "persistent"},
                                                    {"block", "16x16"},
                                                    {"kernel-set", "auto"},
                                                    {"kernel", "auto"},
                                                    {"compaction", "atomic"},
                                                    {"pool-size", "auto"},
                                                    {"layout", "sectors"},
                                                    {"optix-hits", "custom"},
                                                    {"order-surfaces", "auto"},
                                                    {"stages", "auto"},
                                                    {"wave-collisions", "0"},
                                                    {"wave-rays", "2"},
                                                    {"path-bytes", "0"},
                                                    {"calibration", "auto"},
                                                    {"regenerate", "on"},
                                                    {"persistent", "on"},
                                                    {"finish-paths", "auto"},
                                                    {"schedule", "auto"},
                                                    {"stage-block", "256,shade_surface=640"},
                                                    {"scene-memory", "auto"},
                                                    {"branching", "divergent"},
                                                    {"rng", "philox"},
                                                    {"repeat", "1"},
                                                    {"warmup", "0"}};
  std::map<std::string, std::string> found;
  for (const OptionEntry& entry : option_list()) {
    const std::string text = entry.text(Options());
    if (!text.empty() && text != "off") found[entry.name] = text;
  }
  EXPECT_EQ(found, expected);
  EXPECT_EQ(parse_options("--checkpoint c.exr").checkpoint.interval_s, 300);
}

// The samples of two renders may be added if they differ in no other option.
TEST(CommandLine, OptionsThatDetermineTheImage) {
  std::set<std::string> found;
  for (const OptionEntry& entry : option_list())
    if (determines_image(entry)) found.insert(entry.name);
  EXPECT_EQ(found, (std::set<std::string>{"width",
                                          "height",
                                          "integrator",
                                          "max-depth",
                                          "rr",
                                          "nee",
                                          "light-selection",
                                          "mis",
                                          "sampling",
                                          "sampler",
                                          "multiple-scattering",
                                          "seed",
                                          "crop",
                                          "filter",
                                          "aov",
                                          "chains",
                                          "large-step-probability",
                                          "mutation-size",
                                          "bootstrap",
                                          "scene",
                                          "define",
                                          "default-lighting",
                                          "time",
                                          "shutter",
                                          "animation",
                                          "spheres",
                                          "create-world",
                                          "look-from",
                                          "look-at",
                                          "up",
                                          "fov",
                                          "aperture",
                                          "focus-distance",
                                          "kernel-set",
                                          "rng"}));
}

TEST(CommandLine, EveryOptionIsParsedAndWrittenBack) {
  for (const OptionEntry& entry : option_list()) {
    ASSERT_TRUE(other_values().contains(entry.name)) << entry.name << " has no test value";
    const std::string value = other_values().at(entry.name);
    EXPECT_NE(entry.text(Options()), value) << entry.name;
    const auto command = std::get<RenderCommand>(parse_command_line(arguments_for(entry, value)));
    EXPECT_EQ(entry.text(command.options), value) << entry.name;
    EXPECT_TRUE(command.given.contains(entry.name));
  }
}

TEST(CommandLine, AnOptionSetsNoOtherField) {
  for (const OptionEntry& set : option_list()) {
    Options options;
    set.set(options, other_values().at(set.name));
    for (const OptionEntry& entry : option_list())
      if (entry.name != set.name) {
        EXPECT_EQ(entry.text(options), entry.text(Options())) << set.name << " on " << entry.name;
      }
  }
}

TEST(CommandLine, FieldsGetTheValues) {
  Options o = parse_options("--mode megakernel --work pixel --block 8x4 --device cuda:2 --spp 7");
  EXPECT_EQ(o.mode, Mode::megakernel);
  EXPECT_EQ(o.work, Work::pixel);
  EXPECT_EQ(o.block.x, 8);
  EXPECT_EQ(o.block.y, 4);
  EXPECT_EQ(o.device.kind, DeviceChoice::Kind::cuda);
  EXPECT_EQ(o.device.index, 2);
  EXPECT_EQ(o.spp, 7);
  o = parse_options("--compaction none --regenerate off --rng xorwow --branching reduced -q");
  EXPECT_EQ(o.compaction, Compaction::none);
  EXPECT_FALSE(o.regenerate);
  EXPECT_EQ(o.rng, RngKind::xorwow);
  EXPECT_EQ(o.branching, Branching::reduced);
  EXPECT_TRUE(o.quiet);
  o = parse_options("-o x.ppm --exposure .5 --seed 0 --accel brute --aperture 0.25 --fov 179.5");
  EXPECT_EQ(o.output, "x.ppm");
  EXPECT_EQ(o.exposure.stops, 0.5f);
  EXPECT_EQ(o.exposure.kind, ExposureChoice::Kind::fixed);
  EXPECT_EQ(parse_options("-o x.png --exposure auto").exposure.kind,
            ExposureChoice::Kind::measured);
  EXPECT_EQ(o.seed, 0u);
  EXPECT_EQ(o.accel, AccelKind::brute);
  EXPECT_EQ(o.camera.aperture, 0.25f);
  EXPECT_EQ(o.camera.vertical_fov_degrees, 179.5f);
  EXPECT_EQ(parse_options("--device cuda").device.index, 0);
  EXPECT_EQ(parse_options("--spp=9").spp, 9);
}

TEST(CommandLine, VectorsComeInThreeSpellings) {
  const std::array<float, 3> expected{-1.0f, -0.5f, 300.0f};
  for (const char* line : {"--look-from -1 -.5 3e2 --spp 2", "--look-from -1,-.5,3e2 --spp 2",
                           "--spp 2 --look-from=-1,-.5,3e2"}) {
    const Options options = parse_options(line);
    EXPECT_EQ(options.camera.look_from, expected) << line;
    EXPECT_EQ(options.spp, 2) << line;
  }
}

TEST(CommandLine, PoolSizeTakesBinarySuffixes) {
  EXPECT_EQ(parse_options("--pool-size auto").pool_size, 0u);
  EXPECT_EQ(parse_options("--pool-size 1000").pool_size, 1000u);
  EXPECT_EQ(parse_options("--pool-size 512K").pool_size, 524288u);
  EXPECT_EQ(parse_options("--pool-size 2M").pool_size, 2097152u);
  EXPECT_EQ(parse_options("--pool-size 2147483647").pool_size, 2147483647u);
}

TEST(CommandLine, StageBlocksForAllOrByName) {
  const auto all = parse_options("--stage-block 96").stage_block;
  EXPECT_TRUE(std::ranges::all_of(all, [](int threads) { return threads == 96; }));
  const auto some = parse_options("--stage-block intersect=128,shade_surface=64").stage_block;
  for (const StageInfo& stage : stage_table) {
    const int expected = stage.id == StageId::intersect       ? 128
                         : stage.id == StageId::shade_surface ? 64
                                                              : 256;
    EXPECT_EQ(some[static_cast<std::size_t>(stage.id)], expected) << stage.name;
  }
  const auto renamed = parse_options("--stage-block sort_hits=64").stage_block;
  EXPECT_EQ(renamed, parse_options("--stage-block route_hits=64").stage_block);
  const auto both = parse_options("--stage-block 32,shadow=64").stage_block;
  for (const StageInfo& stage : stage_table) {
    EXPECT_EQ(both[static_cast<std::size_t>(stage.id)], stage.id == StageId::shadow ? 64 : 32);
  }
}

// A name of the release before.
TEST(CommandLine, CompactionSortIsAtomicWithSurfacesInOrder) {
  const Options o = parse_options("--compaction sort");
  EXPECT_EQ(o.compaction, Compaction::atomic);
  EXPECT_EQ(o.order_surfaces, SurfaceOrdering::on);
  EXPECT_EQ(parse_options("--compaction cub").order_surfaces, SurfaceOrdering::automatic);
}

TEST(CommandLine, OtherCommands) {
  EXPECT_TRUE(std::holds_alternative<ListScenesCommand>(parse("--list-scenes")));
  EXPECT_TRUE(std::holds_alternative<ListKernelsCommand>(parse("--list-kernels")));
  EXPECT_TRUE(std::holds_alternative<ListDevicesCommand>(parse("--list-devices")));
  EXPECT_TRUE(std::holds_alternative<VersionCommand>(parse("--version")));
  auto compare = std::get<CompareCommand>(parse("compare a.exr b.png"));
  EXPECT_EQ(compare.a, "a.exr");
  EXPECT_EQ(compare.b, "b.png");
  EXPECT_EQ(compare.tolerance, 0);
  compare = std::get<CompareCommand>(parse("compare --tolerance 1e-3 a.exr b.png"));
  EXPECT_EQ(compare.tolerance, 1e-3);
  EXPECT_EQ(std::get<CompareCommand>(parse("compare a b --tolerance 0.1")).tolerance, 0.1);
}

std::string help_text(const std::string& line) { return std::get<HelpCommand>(parse(line)).text; }

/// The options that a help lists, by the last of their names.
std::set<std::string> options_of(const std::string& help) {
  std::set<std::string> options;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  -")) continue;
    const std::string flags = line.substr(2, line.find(' ', 2) - 2);
    EXPECT_TRUE(options.insert(flags.substr(flags.rfind(',') + 1)).second) << flags;
  }
  return options;
}

TEST(CommandLine, HelpListsWhatAUserChooses) {
  const std::string help = help_text("--help");
  const std::set<std::string> few = options_of(help), all = options_of(help_text("--help-all"));
  EXPECT_LE(few.size(), 55u) << "what only an experiment turns is marked by .expert()";
  EXPECT_TRUE(std::ranges::includes(all, few));
  std::set<std::string> rest{"--help",    "--help-all",   "--list-scenes",  "--list-devices",
                             "--version", "--completion", "--list-kernels", "--reference"};
  for (const OptionEntry& entry : option_list()) {
    EXPECT_EQ(few.contains("--" + entry.name), !entry.is_expert) << entry.name;
    rest.insert("--" + entry.name);
  }
  EXPECT_EQ(all, rest);
  const std::size_t last = help.rfind('\n', help.size() - 2);
  EXPECT_NE(help.find("--help-all", last), std::string::npos) << "the last line names it";
  EXPECT_EQ(help_text("--help-all").find("also lists"), std::string::npos);
}

// The subcommands that take options of rendering list these by --help-all alone, without lists of
// scenes and the like, which would be refused.
TEST(CommandLine, HelpOfSubcommands) {
  std::set<std::string> renders{"--help"};
  for (const OptionEntry& entry : option_list()) renders.insert("--" + entry.name);
  const std::map<std::string, std::set<std::string>> own{
      {"view", {"--port"}}, {"verify", {"--share"}}, {"resume", {}}};
  for (const auto& [command, options] : own) {
    std::set<std::string> few{"--help"}, all = renders;
    few.insert(options.begin(), options.end());
    all.insert(options.begin(), options.end());
    const std::string help = help_text(command + " --help");
    EXPECT_EQ(options_of(help), few) << command;
    EXPECT_TRUE(help.ends_with("`ptexp " + command +
                               " --help-all` also lists the options of rendering.\n"));
    EXPECT_EQ(options_of(help_text(command + " --help-all")), all) << command;
  }
  EXPECT_EQ(help_text("trace --help").find("--help-all"), std::string::npos);
  expect_error([] { parse("compare --help-all"); }, "--help-all: no such option");
}

TEST(CommandLine, HelpNamesEveryOptionAndDefault) {
  const std::string help = help_text("--help-all");
  for (const OptionEntry& entry : option_list()) {
    EXPECT_NE(help.find("--" + entry.name + ' '), std::string::npos) << entry.name;
    EXPECT_FALSE(entry.help.empty()) << entry.name;
    const std::string standard = entry.text(Options());
    if (entry.form != OptionForm::flag && !standard.empty()) {
      EXPECT_NE(help.find(entry.placeholder + " [" + standard + "]"), std::string::npos)
          << entry.name;
    }
  }
  std::size_t at = 0;
  for (const char* group : {"\nImage:", "\nScene:", "\nCamera", "\nExecution",
                            "\nThe paper's toggles", "\nMeasurement:", "\nInformation:"}) {
    at = help.find(group, at);
    EXPECT_NE(at, std::string::npos) << group << " is missing or out of order";
  }
  for (const char* option : {"--list-scenes", "--list-devices", "--version", "--help"})
    EXPECT_NE(help.find(option), std::string::npos);
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 115u) << line;
  EXPECT_NE(std::get<HelpCommand>(parse("compare --help")).text.find("--tolerance"),
            std::string::npos);
}

template <typename E>
void expect_round_trip(const char* option) {
  std::set<std::string> names;
  for (const auto& [value, name] : enum_names<E>) {
    EXPECT_EQ(to_string(value), name);
    EXPECT_TRUE(names.insert(std::string(name)).second) << name;
    Options options;
    find_option(option).set(options, std::string(name));
    EXPECT_EQ(find_option(option).text(options), name);
  }
  expect_error(
      [&] {
        parse_command_line({std::string("--") + option, "nonsense"});
      },
      std::string("--") + option + " nonsense: expected one of " + joined_names<E>(", "));
}

TEST(OptionNames, RoundTrip) {
  expect_round_trip<Mode>("mode");
  expect_round_trip<Work>("work");
  expect_round_trip<MegakernelKind>("kernel");
  expect_round_trip<Compaction>("compaction");
  expect_round_trip<Schedule>("schedule");
  expect_round_trip<Stages>("stages");
  expect_round_trip<SceneMemory>("scene-memory");
  expect_round_trip<Branching>("branching");
  expect_round_trip<RngKind>("rng");
  expect_round_trip<AccelKind>("accel");
  expect_round_trip<WorldBuilder>("create-world");
  EXPECT_EQ(to_string(StageId::shade_surface), "shade_surface");
  EXPECT_EQ(to_string(DeviceChoice{DeviceChoice::Kind::automatic, 0}), "auto");
  EXPECT_EQ(to_string(DeviceChoice{DeviceChoice::Kind::cuda, 1}), "cuda:1");
  for (const char* text : {"cpu", "cpu:4", "cuda:0", "cuda:2,0,1", "cuda:0,0", "cuda:all"})
    EXPECT_EQ(to_string(parse_devices("device", text)), text);
}

struct Refusal {
  std::string line;
  std::string message;  ///< a part of it
};

void expect_refused(const std::vector<Refusal>& refusals) {
  for (const auto& [line, message] : refusals) {
    SCOPED_TRACE("ptexp " + line);
    expect_error([&line = line] { parse(line); }, message);
  }
}

TEST(Refused, ChainsAndTheirMutations) {
  expect_refused({
      {"--integrator mlt --chains 0", "--chains 0: expected auto or a number of chains from 1 to"},
      {"--integrator mlt --bootstrap 2G", "--bootstrap 2G: expected auto or a number of paths"},
      {"--integrator mlt --large-step-probability 0",
       "--large-step-probability 0: expected a number above 0, at most 1"},
      {"--integrator mlt --large-step-probability 1.01", "expected a number above 0, at most 1"},
      {"--integrator mlt --mutation-size 0.6", "--mutation-size 0.6: expected a number above 0"},
      {"--chains 100", "--chains 100: has no effect with --integrator path; it applies to mlt"},
      {"--bootstrap 1M", "has no effect with --integrator path; it applies to mlt"},
  });
}

TEST(Refused, WholeNumbers) {
  for (const char* option : {"width", "height", "max-depth"})
    for (const char* value : {"0", "65536", "-1", "1.5", "ten", "1e3", "+4", "0x10", "''"})
      expect_refused({{std::string("--") + option + " " + value,
                       std::string("--") + option + " " + value +
                           ": expected a whole number from 1 to 65,535"}});
  expect_refused({
      {"--spp 0", "--spp 0: expected a whole number from 1 to 2,147,483,647"},
      {"--spp 2147483648", "--spp 2147483648: expected a whole number from 1"},
      {"--seed 18446744073709551616", "from 0 to 18,446,744,073,709,551,615"},
      {"--seed -1", "--seed -1: expected a whole number"},
      {"--spheres -1", "--spheres -1: expected a whole number from 0"},
      {"--spheres 100000001", "from 0 to 100,000,000"},
      {"--threads -1 --device cpu", "--threads -1: expected a whole number from 0"},
      {"--threads 65536 --device cpu", "from 0 to 65,535"},
      {"--repeat 0", "--repeat 0: expected a whole number from 1 to 1,000,000"},
      {"--warmup -1", "--warmup -1: expected a whole number from 0"},
  });
  expect_error([] { parse_command_line({"--spp", " 4"}); }, "--spp  4: expected a whole");
}

// The last values on either side that are taken, and the first that are not.
TEST(Refused, NothingWithinTheLimits) {
  const auto is_taken = [](const std::string& name, const std::string& value) {
    Options options;
    try {
      find_option(name).set(options, value);
    } catch (const Error&) {
      return false;
    }
    return true;
  };
  struct Limits {
    const char* name;
    std::vector<std::string> taken, refused;
  };
  const auto devices = [](int count) {
    std::string text = "cuda:0";
    for (int i = 1; i < count; ++i) text += "," + std::to_string(i);
    return text;
  };
  const Limits table[] = {
      {"width", {"1", "65535"}, {"0", "65536"}},
      {"height", {"1", "65535"}, {"0", "65536"}},
      {"spp", {"1", "2147483647"}, {"0", "2147483648"}},
      {"max-depth", {"1", "65535"}, {"0", "65536"}},
      {"rr", {"0", "65535"}, {"65536"}},
      {"chains", {"1", "134217728", "128M"}, {"0", "134217729", "129M"}},
      {"bootstrap", {"1", "1073741824", "1024M"}, {"0", "1073741825", "1025M"}},
      {"large-step-probability", {"1e-6", "1"}, {"0", "1.0001", "-0.1"}},
      {"mutation-size", {"1e-6", "0.5"}, {"0", "0.5001", "-0.1"}},
      {"time-limit", {"1e-3"}, {"0", "-1"}},
      {"target-error", {"1e-6", "2"}, {"0", "-1"}},
      {"exposure", {"-100", "100"}, {"-100.1", "100.1"}},
      {"fov", {"1e-3", "179.99"}, {"0", "180"}},
      {"aperture", {"0", "1e9"}, {"-1e-6"}},
      {"focus-distance", {"1e-6"}, {"0", "-1"}},
      {"spheres", {"0", "100000000"}, {"100000001"}},
      {"threads", {"0", "65535"}, {"65536"}},
      {"pool-size", {"1", "2147483647", "2047M"}, {"0", "2147483648", "2048M"}},
      {"wave-collisions", {"0", "65535"}, {"65536"}},
      {"sms", {"8", "65535"}, {"65536", "-1", "half"}},
      {"shared-memory-max", {"48", "227"}, {"65536", "64K"}},
      {"wave-rays", {"1", "65535"}, {"0", "65536"}},
      {"path-bytes", {"0", "16", "256"}, {"8", "257", "272"}},
      {"finish-paths", {"0", "1073741824"}, {"1073741825"}},
      {"device", {devices(64)}, {devices(65)}},
      {"stage-block", {"1", "1024", "shadow=1024"}, {"0", "1025", "shadow=1025"}},
      {"block", {"1x1", "1024x1", "32x32"}, {"0x1", "1025x1", "33x32"}},
      {"repeat", {"1", "1000000"}, {"0", "1000001"}},
      {"warmup", {"0", "1000000"}, {"1000001"}},
      {"part", {"1/1", "65535/65535"}, {"0/1", "2/1", "1/65536"}},
      {"crop", {"0,0,1,1"}, {"0,0,0,1", "0,0,1,0", "-1,0,1,1"}},
      {"device", {"cpu:1", "cpu:64", "cuda:0"}, {"cpu:0", "cpu:65", "cuda:-1"}},
      {"checkpoint", {"a.exr,1e-3"}, {"a.exr,0", "a.exr,-1"}},
  };
  for (const auto& [name, taken, refused] : table) {
    for (const std::string& value : taken) EXPECT_TRUE(is_taken(name, value)) << name << value;
    for (const std::string& value : refused) EXPECT_FALSE(is_taken(name, value)) << name << value;
  }
}

TEST(Refused, NumbersAndVectors) {
  for (const char* value : {"nan", "inf", "-inf", "x", "1e50", "''", "1,5"})
    expect_refused({{std::string("--exposure ") + value + " -o a.png", "--exposure"},
                    {std::string("--fov ") + value, "an angle above 0 and below 180 degrees"},
                    {std::string("--aperture ") + value, "a length of 0 or more"},
                    {std::string("--focus-distance ") + value, "a length above 0"}});
  expect_refused({
      {"--exposure 101 -o a.png", "--exposure 101: expected auto or a number from -100 to 100"},
      {"--fov 0", "--fov 0: expected an angle"},
      {"--fov 180", "--fov 180: expected an angle"},
      {"--aperture -0.1", "--aperture -0.1: expected a length of 0 or more"},
      {"--focus-distance 0", "--focus-distance 0: expected a length above 0"},
      {"--look-from 1 2", "--look-from 1,2: expected three finite numbers, X Y Z or X,Y,Z"},
      {"--look-from 1,2,3,4", "--look-from 1,2,3,4: expected three finite numbers"},
      {"--look-at 1,nan,3", "--look-at 1,nan,3: expected three finite numbers"},
      {"--look-at 1,,3", "--look-at 1,,3: expected three finite numbers"},
      {"--up 0 0 0", "--up 0,0,0: expected a direction, not zero"},
      {"--look-from 1 2 3 --look-at 1,2,3", "--look-at 1,2,3: expected a point other than"},
      {"--look-from 0 0 0 --look-at 0 1 0 --up 0 -2 0", "--up 0,-2,0: expected a direction other"},
  });
}

TEST(Refused, NamesAndForms) {
  expect_refused({
      {"--device gpu",
       "--device gpu: expected auto, cpu, cpu:N for N devices that share its threads, cuda, "},
      {"--device cuda:", "--device cuda:: expected auto"},
      {"--device cuda:-1", "--device cuda:-1: expected auto"},
      {"--device cuda:1x", "--device cuda:1x: expected auto"},
      {"--mode ''", "--mode '': expected one of auto, serial"},
      {"--scene ''", "--scene '': expected a name"},
      {"--output ''", "--output"},
      {"--stats --quiet", "--stats --quiet: expected a name"},
      {"--regenerate yes", "--regenerate yes: expected on or off"},
      {"--pool-size 0",
       "--pool-size 0: expected auto or a number of paths from 1 to 2,147,483,647"},
      {"--pool-size 0K", "--pool-size 0K: expected auto"},
      {"--pool-size 2048M", "--pool-size 2048M: expected auto"},
      {"--pool-size K", "--pool-size K: expected auto"},
      {"--pool-size 1G", "--pool-size 1G: expected auto"},
      {"--pool-size 18014398509481985K", "--pool-size 18014398509481985K: expected auto"},
  });
}

TEST(Refused, Blocks) {
  expect_refused({
      {"--block 64x64", "--block 64x64: a block has at most 1,024 threads, 64x64 has 4,096"},
      {"--mode serial --block 64x64", "a block has at most 1,024 threads, 64x64 has 4,096"},
      {"--mode megakernel --block 33x32", "at most 1,024 threads, 33x32 has 1,056"},
      {"--block 65535x65535", "65535x65535 has 4,294,836,225"},
      {"--stage-block 0", "--stage-block 0: expected a whole number of threads from 1 to 1,024"},
      {"--stage-block 1025", "--stage-block 1025: expected a whole number of threads"},
      {"--stage-block intersect=0", "--stage-block 0: expected a whole number of threads"},
      {"--stage-block trace=64", "--stage-block trace: expected one of generate, mutate"},
      {"--stage-block shadow=64,64", "--stage-block shadow=64,64: expected a number"},
      {"--stage-block shadow=64,shadow=32", "names shadow twice"},
  });
  for (const char* value : {"0x4", "4x0", "4", "4x", "x4", "4x4x4", "-4x4", "4X4", "65536x1", "''"})
    expect_refused({{std::string("--block ") + value,
                     "--block " + std::string(value) + ": expected WIDTHxHEIGHT in threads"}});
}

TEST(CommandLine, TheLastOfAnOptionHolds) {
  EXPECT_EQ(parse_options("--spp 3 --spp 4").spp, 4);
  EXPECT_EQ(parse_options("--output a.png -o b.png").output, "b.png");
  EXPECT_TRUE(parse_options("-q --quiet").quiet);
  using Vector = std::array<float, 3>;
  const std::string vectors[] = {"--look-from 1,2,3 --look-from 4,5,6",
                                 "--look-from 1 2 3 --look-from 4,5,6",
                                 "--look-from 1,2,3 --look-from 4 5 6"};
  for (const std::string& text : vectors) {
    EXPECT_EQ(parse_options(text).camera.look_from, (Vector{4, 5, 6})) << text;
  }
  const auto compare = std::get<CompareCommand>(
      parse_command_line({"compare", "a", "b", "--tolerance", "1", "--tolerance", "2"}));
  EXPECT_EQ(compare.tolerance, 2.0);
}

TEST(Refused, WhatIsNoOption) {
  expect_refused({
      {"--frobnicate", "--frobnicate: no such option, see ptexp --help"},
      {"--frobnicate 3", "--frobnicate: no such option"},
      {"--spp=3 -x", "-x: no such option"},
      {"--wid 3", "--wid: no such option"},
      {"image.exr", "image.exr: an argument without an option"},
      {"--spp", "--spp: expected a value"},
      {"--look-at", "--look-at: expected a value"},
      {"--spp 3 4", "4: an argument without an option"},
      {"--quiet=off", "--quiet: takes no value"},
      {"--tolerance 3", "--tolerance: no such option"},
  });
}

TEST(Refused, MisspeltNamesWithWhatWasMeant) {
  expect_refused({
      {"--ssp 8", "--ssp: no such option; did you mean --spp?"},
      {"-spp 8", "-spp: no such option; did you mean --spp?"},
      {"--max_depth=3", "--max_depth=3: no such option; did you mean --max-depth?"},
      {"--wid 3", "--wid: no such option; did you mean --width?"},
      {"--hegiht 3", "--hegiht: no such option; did you mean --height?"},
      {"--Scene cornell", "--Scene: no such option; did you mean --scene?"},
      {"compare a b --tolerence 3", "--tolerence: no such option; did you mean --tolerance?"},
      {"view cornell --prot 3", "--prot: no such option; did you mean --port?"},
      {"view cornell --spheers 3", "--spheers: no such option; did you mean --spheres?"},
      {"--frobnicate", "--frobnicate: no such option, see ptexp --help"},
      {"--s 3", "--s: no such option, see ptexp --help"},  // many begin so
      {"comapre a b", "comapre: an argument without an option; did you mean ptexp compare?"},
      {"cornell", "cornell: an argument without an option; did you mean --scene cornell?"},
      {"statue:1K", "statue:1K: an argument without an option; did you mean --scene statue:1K?"},
      {"absent.xml", "absent.xml: an argument without an option, see ptexp --help"},
      {"--mode megakernal",
       "--mode megakernal: expected one of auto, serial, megakernel, wavefront; did you mean "
       "megakernel?"},
      {"--mode wave", "; did you mean wavefront?"},
      {"--mode CPU", "--mode CPU: expected one of auto, serial, megakernel, wavefront"},
      {"--accel CWBVH", "; did you mean cwbvh?"},
      {"--aov albedo,depht", "; did you mean depth?"},
      {"--filter gausian:0.5", "--filter gausian: expected one of box, "},
      {"--filter gausian:0.5", "; did you mean gaussian?"},
      {"trace --mesh a --rays b --accel bvh", "; did you mean bvh2?"},
  });
  const std::vector<std::string> names{"on", "off", "automatic", "auto"};
  EXPECT_EQ(nearest_name("of", names), "off");
  EXPECT_EQ(nearest_name("autmoatic", names), "automatic");
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name("nothing", names), "");
  EXPECT_EQ(nearest_name(std::string(1 << 20, 'o'), names), "");
  const TempFolder folder;
  const std::string file = folder.file("scene.xml");
  std::ofstream(file) << "<scene/>";
  expect_error([&] { parse_command_line({file}); }, "; did you mean --scene " + file + "?");
}

TEST(Refused, CompareAndInformation) {
  expect_refused({
      {"compare", "compare: expected two images"},
      {"compare a.exr", "compare: expected two images"},
      {"compare a b c", "c: an argument without an option"},
      {"compare a b --tolerance", "--tolerance: expected a value"},
      {"compare a b --tolerance -1", "--tolerance -1: expected a finite number of 0 or more"},
      {"compare a b --tolerance nan", "--tolerance nan: expected a finite number"},
      {"compare a b --tolerance inf", "--tolerance inf: expected a finite number"},
      {"compare a b --spp 3", "--spp: no such option"},
      {"--spp 3 compare a b", "--spp: has no effect together with compare"},
      {"--list-scenes --spp 3", "--spp: has no effect together with --list-scenes"},
      {"--version --list-devices", "has no effect together with"},
  });
}

TEST(Refused, Contradictions) {
  expect_refused({
      {"--scene cornell --spheres 3", "--spheres 3: has no effect on the scene 'cornell'"},
      {"--exposure 1", "--exposure 1: applies to .png and .ppm; image.exr holds linear radiance"},
      {"--stats a --csv ./a", "--csv ./a: is the file of --stats too"},
      {"--output a.png --csv a.png", "--csv a.png: is the file of --output too"},
      {"--checkpoint a.exr --output a.exr", "--checkpoint a.exr: is the file of --output too"},
      {"--checkpoint a.exr --stats a.exr", "a.exr: is the file of --stats too"},
      {"--checkpoint a.exr --repeat 2", "is of one render; expected neither --repeat nor --warmup"},
      {"--checkpoint a.exr --warmup 1", "is of one render; expected neither --repeat nor --warmup"},
      {"--width 8 --height 4 --crop 0,0,9,4",
       "--crop 0,0,9,4: expected pixels of the image of 8x4"},
      {"--width 8 --height 4 --crop 0,0,8,5", "--crop 0,0,8,5: expected pixels"},
      {"--sms 16 --counters", "--counters: reads those of a whole GPU; expected no --sms"},
      {"--sms -8", "--sms -8: expected a whole number"},
      {"--shared-memory-max 64K", "--shared-memory-max 64K: expected a whole number"},
  });
}

TEST(Refused, VotesWithoutWholeWarpsThatFetch) {
  expect_refused({
      {"--mode megakernel --kernel vote --work pixel",
       "--kernel vote: its warps fetch paths; expected --work persistent, not pixel"},
      {"--mode megakernel --kernel vote --accel bvh2",
       "--kernel vote: traces wide trees; expected --accel cwbvh or auto, not bvh2"},
      {"--mode megakernel --kernel vote --block 5x3",
       "--kernel vote: whole warps vote; expected a --block of a multiple of 32 threads, 5x3 has "
       "15"},
      {"--mode megakernel --kernel sort --work sample",
       "--kernel sort: its warps fetch paths; expected --work persistent, not sample"},
      {"--mode megakernel --kernel sort --accel brute",
       "--kernel sort: traces wide trees; expected --accel cwbvh or auto, not brute"},
      {"--mode megakernel --kernel sort --block 8x8",
       "--block 8x8: has no effect with --kernel sort, whose blocks are as large as "
       "multiprocessors"},
      {"--mode megakernel --kernel warp", "--kernel warp: expected one of auto, loop, vote, sort"},
  });
  for (const char* line : {"--kernel vote --accel cwbvh --block 8x8", "--kernel sort --accel cwbvh",
                           "--kernel loop --work pixel", "--kernel auto --accel bvh2 --block 5x3"})
    EXPECT_NO_THROW(parse(std::string("--mode megakernel ") + line)) << line;
}

TEST(Refused, WithoutEffectInTheMode) {
  expect_refused({
      {"--mode wavefront --work pixel",
       "--work pixel: has no effect with --mode wavefront; it applies to megakernel"},
      {"--mode wavefront --accel optix --reorder on",
       "--reorder on: has no effect with --mode wavefront; it applies to megakernel"},
      {"--mode megakernel --reorder on", "--reorder on: has no effect without --accel optix"},
      {"--mode wavefront --block 8x8", "--block 8x8: has no effect with --mode wavefront"},
      {"--mode wavefront --kernel loop", "--kernel loop: has no effect with --mode wavefront"},
      {"--kernel loop --compaction cub",
       "--kernel and --compaction: have no effect in one mode; expected options of the megakernel "
       "or of the wavefront"},
      {"--mode serial --threads 2", "--threads 2: has no effect with --mode serial"},
      {"--mode serial --sms 8", "--sms 8: has no effect with --mode serial"},
      {"--mode serial --device cuda:1", "--device cuda:1: has no effect with --mode serial"},
      {"--mode serial --scene-memory shared", "--scene-memory shared: has no effect"},
      {"--mode serial --branching reduced", "--branching reduced: has no effect"},
      {"--mode serial --create-world device", "--create-world device: has no effect"},
  });
  for (const char* mode : {"serial", "megakernel"})
    for (const char* option : {"compaction none", "pool-size auto", "regenerate on",
                               "schedule host", "stage-block 128", "layout aos", "stages split"})
      expect_refused({{std::string("--mode ") + mode + " --" + option,
                       std::string("--") + option + ": has no effect with --mode " + mode}});
}

TEST(CommandLine, TakesTheModeThatItsOptionsAreFor) {
  const auto mode_of = [](const char* line) { return parse_render(line).options.mode; };
  EXPECT_EQ(mode_of("--spp 7"), Mode::automatic);
  EXPECT_EQ(mode_of("--accel bvh2 --threads 2"), Mode::automatic);
  EXPECT_EQ(mode_of("--kernel loop"), Mode::megakernel);
  EXPECT_EQ(mode_of("--block 8x8 --spp 7"), Mode::megakernel);
  EXPECT_EQ(mode_of("--compaction none"), Mode::wavefront);
  EXPECT_EQ(mode_of("--mode auto --finish-paths 0"), Mode::wavefront);
}

TEST(Refused, WhatFusedOrSplitStagesDoNotKnow) {
  expect_refused({
      {"--stages fused --persistent off", "--persistent off: has no effect with --stages fused"},
      {"--stages fused --order-surfaces on",
       "--order-surfaces on: has no effect with --stages fused"},
      {"--order-surfaces on --compaction none", "--order-surfaces on: sorts a queue"},
      {"--stages fused --branching reduced", "--branching reduced: has no effect with --stages"},
      {"--wave-rays 2", "--wave-rays 2: has no effect with --stages auto; it applies to fused"},
      {"--stages split --wave-rays 1", "--wave-rays 1: has no effect with --stages split"},
      {"--stages fused --wave-rays 0", "--wave-rays 0: expected"},
  });
  for (const char* line : {"--stages fused --wave-rays 3 --compaction cub", "--stages split",
                           "--stages auto --branching reduced", "--stages fused"})
    EXPECT_NO_THROW(parse(line)) << line;
}

TEST(Refused, WhatAnotherOptionLeavesNothingToDo) {
  expect_refused({
      {"--nee off --mis balance", "--mis balance: has no effect with --nee off"},
      {"--nee off --mis none", "--mis none: has no effect with --nee off"},
      {"--light-selection tree --nee off", "--light-selection tree: has no effect with --nee off"},
      {"--integrator mlt --large-step-probability 1 --mutation-size 0.1",
       "--mutation-size 0.1: has no effect with --large-step-probability 1"},
      {"--integrator mlt --finish-paths 7",
       "--finish-paths 7: has no effect with --integrator mlt"},
      {"--aperture 0 --focus-distance 3", "--focus-distance 3: has no effect with --aperture 0"},
      {"--accel brute --builder sah", "--builder sah: has no effect with --accel brute"},
      {"--builder sbvh --accel embree", "--builder sbvh: has no effect with --accel embree"},
  });
  for (const char* line :
       {"--nee off --mis power --light-selection auto", "--nee on --mis none", "--mis none",
        "--nee off --sampling uniform", "--integrator mlt --mutation-size 0.1",
        "--integrator mlt --finish-paths auto", "--aperture 0.1 --focus-distance 3",
        "--focus-distance 3", "--device cuda --accel bvh2 --scene-memory constant",
        "--accel brute --builder auto", "--accel bvh2 --builder sbvh", "--builder sah"})
    EXPECT_NO_THROW(parse(line)) << line;
}

TEST(Refused, WithoutEffectOnTheDevice) {
  expect_refused({
      {"--device cpu --schedule graph",
       "--schedule graph: has no effect on the device cpu; it applies to cuda"},
      {"--device cpu --stage-block 64", "--stage-block 64: has no effect on the device cpu"},
      {"--device cpu --mode megakernel --block 8x8", "--block 8x8: has no effect on the device"},
      {"--device cpu --mode megakernel --kernel vote",
       "--kernel vote: has no effect on the device"},
      {"--device cpu --scene-memory constant", "--scene-memory constant: has no effect"},
      {"--device cpu --scene-memory shared", "--scene-memory shared: has no effect"},
      {"--device cpu --create-world device", "--create-world device: has no effect"},
      {"--device cuda --threads 3", "--threads 3: has no effect on the device cuda"},
      {"--device cpu --sms 16",
       "--sms 16: has no effect on the device cpu; it applies to cuda; on a CPU, --threads sets "
       "the size"},
      {"--device cpu --shared-memory-max 64",
       "--shared-memory-max 64: has no effect on the device"},
      {"--device cpu --mode megakernel --counters",
       "has no effect on the device cpu; it applies to cuda; on a CPU `perf stat"},
  });
}

TEST(Applicable, TheDeviceIsCheckedWhenItIsKnown) {
  using Kind = DeviceChoice::Kind;
  const RenderCommand graph = parse_render("--schedule graph");
  EXPECT_NO_THROW(check_applicable(graph.options, graph.given, std::nullopt));
  EXPECT_NO_THROW(check_applicable(graph.options, graph.given, Kind::cuda));
  expect_error([&] { check_applicable(graph.options, graph.given, Kind::cpu); },
               "--schedule graph: has no effect on the device cpu");
  const RenderCommand threads = parse_render("--threads 2");
  EXPECT_NO_THROW(check_applicable(threads.options, threads.given, Kind::cpu));
  EXPECT_THROW(check_applicable(threads.options, threads.given, Kind::cuda), Error);
}

TEST(Applicable, DefaultsAreNeverRefused) {
  using Kind = DeviceChoice::Kind;
  for (const auto& [mode, name] : enum_names<Mode>) {
    Options options;
    options.mode = mode;
    EXPECT_NO_THROW(check_applicable(options, {}, Kind::cpu)) << name;
    EXPECT_NO_THROW(check_applicable(options, {}, Kind::cuda)) << name;
  }
}

TEST(Applicable, ValuesThatMeanTheSameOnTheCpuAreAccepted) {
  for (const char* line :
       {"--device cpu --scene-memory global", "--device cpu --schedule host",
        "--device cpu --schedule auto", "--device cpu --compaction none --pool-size 7",
        "--device cpu --create-world host", "--device cpu --rng xorwow --branching reduced",
        "--device cpu --mode megakernel --work sample", "--device cpu --mode serial --accel bvh2"})
    EXPECT_NO_THROW(parse(line)) << line;
}

}  // namespace
}  // namespace pt
