#include "app/options/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

#include "app/options/option_list.h"
#include "app/options/option_values.h"
#include "app/options/shell_text.h"
#include "app/options/subcommand.h"
#include "common/error/error.h"

namespace pt {

template <>
inline constexpr auto enum_names<Shell> = std::to_array<EnumName<Shell>>({{Shell::bash, "bash"},
                                                                          {Shell::zsh, "zsh"},
                                                                          {Shell::fish, "fish"}});
template <>
inline constexpr auto enum_names<ReferencePage> = std::to_array<EnumName<ReferencePage>>(
    {{ReferencePage::man, "man"}, {ReferencePage::markdown, "markdown"}});

namespace {

constexpr const char* program_text =
    "ptexp renders an image by several execution strategies, to compare their speed.\n"
    "`ptexp --mode wavefront --spp 50` renders the paper's scene to image.exr.";
constexpr const char* compare_text =
    "Prints RMSE, relMSE, FLIP, the largest difference, how many pixels differ.\n"
    "Exit code 0: within the tolerance, 1: beyond it, 2: an image cannot be read.";
constexpr const char* resume_text =
    "Goes on with the render of a checkpoint, by the options of its beginning. Others\n"
    "may be given that do not change what a sample is: --spp, for more of them,\n"
    "--output, and how and where to render.";
constexpr const char* merge_text =
    "Joins the checkpoints of an image's parts (--part). Pixels that several have are\n"
    "compared. Exit code 0: done, 2: something is missing, foreign or differs.";
constexpr const char* verify_text =
    "Renders some of an image's pixels again, by the options in its header, and\n"
    "compares. Exit code 0: the bits are equal, 1: they differ, 2: an error.";
constexpr const char* view_text =
    "Shows the render in progress on a page for the browsers of this machine, where\n"
    "camera, mode and exposure can be changed, until Ctrl-C.";
constexpr const char* trace_text =
    "Traces rays from a file, measures the rate and compares with reference hits.\n"
    "Exit code 0: done, 1: hits differ from the reference, 2: an error.";
constexpr const char* rays_text = "Makes a file of rays for `ptexp trace`.";
constexpr const char* compact_text =
    "Measures the wavefront's compaction strategies alone, and a copy for comparison.\n"
    "Exit code 0: done, 2: an error, or a strategy whose result is wrong.";
constexpr const char* doctor_text =
    "Tells what would run on this machine, what not, and the remedy.\n"
    "Exit code 0: all that it was built for works, 1: something is missing.";
constexpr const char* footer_text =
    "An option that has no effect in the chosen mode or on the chosen device is refused.\n"
    "Exit codes: 0 done, 2 an error (one line on stderr), 130 interrupted by Ctrl-C, 143 by\n"
    "SIGTERM; the image then has the samples that were finished. `ptexp compare --help` tells\n"
    "more.";

/// CLI11 splits the arguments and lays out the help; values are parsed by option_list, because
/// their errors should name the option, the value and what was expected in one line.
struct Parser {
  CLI::App app{program_text, "ptexp"};
  std::vector<std::pair<const OptionEntry*, CLI::Option*>> options;
  CLI::Option *list_scenes = nullptr, *list_devices = nullptr, *list_kernels = nullptr;
  CLI::Option* version = nullptr;
  CLI::Option *completion = nullptr, *reference = nullptr;
  Subcommand<TraceCommand> trace{app, "trace", trace_text, trace_options()};
  Subcommand<RaysCommand> rays{app, "rays", rays_text, rays_options()};
  Subcommand<CompactCommand> compact{app, "compact", compact_text, compact_options()};
  Subcommand<DoctorCommand> doctor{app, "doctor", doctor_text, doctor_options()};
  CLI::App *resume = nullptr, *merge = nullptr, *verify = nullptr, *view = nullptr;
  CLI::Option *checkpoint = nullptr, *merged = nullptr, *parts = nullptr, *verified = nullptr;
  CLI::Option *allow_missing = nullptr, *keep_sums = nullptr, *share = nullptr;
  CLI::Option *viewed = nullptr, *port = nullptr;
  CLI::App* compare = nullptr;
  CLI::Option *image_a = nullptr, *image_b = nullptr, *tolerance = nullptr, *difference = nullptr;

  Parser();
  void add_option(const OptionEntry& entry);
  void add_film_commands();
};

CLI::Option* add_flag(CLI::App& app, const std::string& flags, const std::string& help) {
  // As strings: a literal is ambiguous in CLI11 2.1.
  return app.add_flag(flags, help)->disable_flag_override();
}

CLI::Option* add_text(CLI::App& app, const std::string& flags, const std::string& help) {
  return app
      .add_option_function<std::vector<std::string>>(
          flags, [](const std::vector<std::string>&) {}, help)
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void Parser::add_option(const OptionEntry& entry) {
  const std::string flags =
      (entry.short_flag.empty() ? "" : entry.short_flag + ",") + "--" + entry.name;
  CLI::Option* option = entry.form == OptionForm::flag ? add_flag(app, flags, entry.help)
                                                       : add_text(app, flags, entry.help);
  option->group(entry.group);
  if (entry.form == OptionForm::vector) option->expected(1, 3);
  if (entry.form != OptionForm::flag) {
    const std::string standard = entry.text(Options());
    option->type_name(entry.placeholder + (standard.empty() ? "" : " [" + standard + "]"));
  }
  options.emplace_back(&entry, option);
}

Parser::Parser() {
  for (const OptionEntry& entry : option_list()) add_option(entry);
  app.set_help_flag("-h,--help", "Prints this help")->group("Information");
  list_scenes = add_flag(app, "--list-scenes", "Names and describes the scenes");
  list_devices = add_flag(app, "--list-devices", "Names the devices that --device can take");
  list_kernels =
      add_flag(app, "--list-kernels", "Prints which kernels there are, for which scenes");
  version = add_flag(app, "--version", "Prints version, commit and build options");
  completion = add_text(app, "--completion", "Prints the completion of options for a shell");
  completion->type_name(joined_names<Shell>("|"));
  reference = add_text(app, "--reference", "Prints all of this help as a page");
  reference->type_name(joined_names<ReferencePage>("|"));
  for (CLI::Option* option :
       {list_scenes, list_devices, list_kernels, version, completion, reference})
    option->group("Information");
  app.allow_extras();

  add_film_commands();
  compare = app.add_subcommand("compare", compare_text);
  image_a = add_text(*compare, "A", "Image, .exr, .png or .ppm");
  image_b = add_text(*compare, "B", "Reference of the same size");
  tolerance = add_text(*compare, "--tolerance", "Largest |A - B| of a value that is accepted");
  tolerance->type_name("T [0]");
  difference = add_text(*compare, "--difference",
                        "Image to write: A - B in an .exr, else FLIP in false colours");
  difference->type_name("FILE");
  compare->allow_extras();
  for (CLI::Option* image : {image_a, image_b})
    image->type_name("")->multi_option_policy(CLI::MultiOptionPolicy::Throw);
  app.footer(footer_text);  // last: a subcommand would inherit it
  app.get_formatter()->column_width(34);
}

/// Options of rendering that stand behind the subcommand's name are the program's.
void Parser::add_film_commands() {
  resume = app.add_subcommand("resume", resume_text);
  checkpoint = add_text(*resume, "FILE", "Checkpoint, an .exr of --checkpoint");
  merge = app.add_subcommand("merge", merge_text);
  merged = add_text(*merge, "OUT", "Image to write");
  parts = merge->add_option_function<std::vector<std::string>>(
      "IN", [](const std::vector<std::string>&) {}, "Checkpoints of parts");
  allow_missing = add_flag(*merge, "--allow-missing", "Pixels without samples are black");
  keep_sums = add_flag(*merge, "--keep-sums", "OUT, an .exr, is a checkpoint, too");
  verify = app.add_subcommand("verify", verify_text);
  verified = add_text(*verify, "IMAGE", "Image to verify, .exr or .png");
  share = add_text(*verify, "--share", "Share of the pixels, above 0, at most 1");
  share->type_name("X [0.01]");
  view = app.add_subcommand("view", view_text);
  viewed = add_text(*view, "SCENE", "Built-in scene or file, as --scene takes it");
  port = add_text(*view, "--port", "Of the page's address; 0: any that is free");
  port->type_name("N [8080]");
  for (CLI::Option* file : {checkpoint, merged, verified, viewed})
    file->type_name("")->multi_option_policy(CLI::MultiOptionPolicy::Throw);
  parts->type_name("");
  for (CLI::App* command : {resume, merge, verify, view}) command->allow_extras()->fallthrough();
}

/// Of an option that is given more than once the last holds, as in other programs: so a script's
/// options can be overridden behind them.
std::string last_value(const CLI::Option& option) { return option.results().back(); }

/// The same for three numbers, which are one argument or three.
std::string last_vector(const CLI::Option& option) {
  const std::string all = CLI::detail::join(option.results(), ",");
  const std::vector<std::string> numbers = CLI::detail::split(all, ',');
  if (numbers.size() <= 3 || numbers.size() % 3 != 0) return all;
  return CLI::detail::join(std::vector<std::string>(numbers.end() - 3, numbers.end()), ",");
}

CompareCommand parse_compare(const Parser& parser) {
  if (parser.image_b->count() == 0)
    throw Error(
        "compare: expected two images, `ptexp compare A B [--tolerance T] [--difference FILE]`");
  CompareCommand command{parser.image_a->results()[0], parser.image_b->results()[0]};
  if (parser.difference->count() > 0) command.difference = last_value(*parser.difference);
  if (parser.tolerance->count() == 0) return command;
  const std::string text = last_value(*parser.tolerance);
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, command.tolerance);
  if (error != std::errc() || stop != end || !(command.tolerance >= 0) ||
      !std::isfinite(command.tolerance))
    throw Error(fmt::format("--tolerance {}: expected a finite number of 0 or more", text));
  return command;
}

/// Of all options that are given, in the order of the table.
std::vector<Setting> given_settings(const Parser& parser) {
  std::vector<Setting> settings;
  for (const auto& [entry, option] : parser.options) {
    if (option->count() == 0) continue;
    if (entry->form == OptionForm::list) {
      for (const std::string& value : option->results()) settings.push_back({entry, value});
    } else {
      const bool is_vector = entry->form == OptionForm::vector;
      settings.push_back({entry, is_vector ? last_vector(*option) : last_value(*option)});
    }
  }
  return settings;
}

/// The one argument of a subcommand.
std::string file_of(const CLI::Option* option, const char* usage) {
  if (option->count() == 0) throw Error(fmt::format("{}: expected {}", usage, option->get_name()));
  return option->results()[0];
}

MergeCommand parse_merge(const Parser& parser) {
  const std::string usage = "ptexp merge OUT IN...";
  for (const Setting& setting : given_settings(parser))
    throw Error(fmt::format("--{}: has no effect together with merge", setting.entry->name));
  MergeCommand command{file_of(parser.merged, usage.c_str()), parser.parts->results()};
  if (command.inputs.empty()) throw Error(usage + ": expected at least one checkpoint");
  command.allow_missing = parser.allow_missing->count() > 0;
  command.keeps_sums = parser.keep_sums->count() > 0;
  if (command.keeps_sums && !command.output.ends_with(".exr"))
    throw Error(fmt::format("--keep-sums: expected an .exr to write, not {}", command.output));
  return command;
}

VerifyCommand parse_verify(const Parser& parser) {
  VerifyCommand command{file_of(parser.verified, "ptexp verify IMAGE"), 0.01,
                        given_settings(parser)};
  if (parser.share->count() > 0) {
    command.share = parse_number("share", last_value(*parser.share), "a number above 0, at most 1",
                                 [](float x) { return x > 0 && x <= 1; });
  }
  return command;
}

/// What a page shows is neither a file nor one render.
ViewCommand parse_view(const Parser& parser) {
  const std::string scene = file_of(parser.viewed, "ptexp view SCENE");
  ViewCommand command;
  if (parser.port->count() > 0)
    command.port = static_cast<int>(parse_integer("port", last_value(*parser.port), 0, 65535));
  command.settings = {{&find_option("scene"), scene}, {&find_option("output"), "page.png"}};
  for (const Setting& setting : given_settings(parser)) {
    const OptionEntry& entry = *setting.entry;
    constexpr std::array refused = {"scene",      "output",     "aov",          "stats",  "csv",
                                    "repeat",     "warmup",     "counters",     "part",   "explain",
                                    "checkpoint", "time-limit", "target-error", "display"};
    if (std::ranges::find(refused, entry.name) != refused.end())
      throw Error(fmt::format("--{}: has no effect together with view", entry.name));
    if (entry.name == "quiet") command.is_quiet = true;
    command.settings.push_back(setting);
  }
  if (make_render_command(command.settings).options.integrator == IntegratorKind::mlt)
    throw Error("--integrator mlt: has no image before it ends; view expects path");
  return command;
}

/// A command other than rendering stands alone: nothing that the user wrote is ignored.
void check_alone(const Parser& parser, const std::string& command, const CLI::Option* self) {
  for (const CLI::Option* option : parser.app.get_options())
    if (option != self && option->count() > 0)
      throw Error(fmt::format("{}: has no effect together with {}", option->get_name(), command));
}

/// CLI11 takes -.5 for a short option, though not -0.5.
std::vector<std::string> with_leading_zeros(std::vector<std::string> arguments) {
  for (std::string& text : arguments)
    if (text.size() > 2 && text.starts_with("-.") && std::isdigit(text[2])) text.insert(1, "0");
  return arguments;
}

/// CLI11 leaves two empty lines between groups.
std::string help_text(const CLI::App& app) {
  std::string text = app.help();
  for (std::size_t at; (at = text.find("\n\n\n")) != std::string::npos;) text.erase(at, 1);
  return text;
}

CommandText describe_program(const Parser& parser) {
  CommandText program = describe(parser.app);
  for (CommandText& one : program.subcommands) {
    for (const CLI::App* renders : {parser.resume, parser.verify, parser.view})
      one.takes_render_options |= one.name == renders->get_name();
  }
  return program;
}

void check_extras(const Parser& parser) {
  const auto extras = parser.app.remaining(true);
  if (extras.empty()) return;
  const bool is_option = extras.front().starts_with('-');
  throw Error(fmt::format("{}: {}, see ptexp --help", extras.front(),
                          is_option ? "no such option" : "an argument without an option"));
}

}  // namespace

RenderCommand make_render_command(const std::vector<Setting>& settings) {
  RenderCommand command;
  for (const auto& [entry, value] : settings) {
    entry->set(command.options, value);
    command.given.insert(entry->name);
  }
  fit_mode(command.options, command.given);
  check_consistent(command.options, command.given);
  std::optional<DeviceChoice::Kind> device;
  if (command.options.device.kind != DeviceChoice::Kind::automatic)
    device = command.options.device.kind;
  check_applicable(command.options, command.given, device);
  return command;
}

Command parse_command_line(const std::vector<std::string>& arguments) {
  Parser parser;
  std::vector<std::string> reversed = with_leading_zeros(arguments);
  std::ranges::reverse(reversed);  // CLI11 takes them from the back
  try {
    parser.app.parse(std::move(reversed));
  } catch (const CLI::CallForHelp&) {
    return HelpCommand{help_text(parser.app)};
  } catch (const CLI::ArgumentMismatch& error) {
    const std::string text = error.what();
    std::string name = text.substr(0, text.find_first_of(": "));
    if (!name.starts_with('-')) name.insert(0, "--");
    throw Error(name + (text.find("override") == std::string::npos ? ": expected a value"
                                                                   : ": takes no value"));
  } catch (const CLI::ParseError& error) {
    throw Error(error.what());
  }
  check_extras(parser);
  if (parser.resume->parsed()) {
    return ResumeCommand{file_of(parser.checkpoint, "ptexp resume FILE"), given_settings(parser)};
  }
  if (parser.merge->parsed()) return parse_merge(parser);
  if (parser.verify->parsed()) return parse_verify(parser);
  if (parser.view->parsed()) return parse_view(parser);
  if (parser.compare->parsed()) {
    check_alone(parser, "compare", nullptr);
    return parse_compare(parser);
  }
  if (parser.trace.is_parsed()) {
    check_alone(parser, "trace", nullptr);
    TraceCommand command = parser.trace.parse();
    command.command_line = shell_text(arguments);
    return command;
  }
  if (parser.rays.is_parsed()) {
    check_alone(parser, "rays", nullptr);
    return parser.rays.parse();
  }
  if (parser.compact.is_parsed()) {
    check_alone(parser, "compact", nullptr);
    CompactCommand command = parser.compact.parse();
    command.command_line = shell_text(arguments);
    return command;
  }
  if (parser.doctor.is_parsed()) {
    check_alone(parser, "doctor", nullptr);
    return parser.doctor.parse();
  }
  const std::pair<const CLI::Option*, Command> information[] = {
      {parser.list_scenes, ListScenesCommand{}},
      {parser.list_devices, ListDevicesCommand{}},
      {parser.list_kernels, ListKernelsCommand{}},
      {parser.version, VersionCommand{}}};
  for (const auto& [option, command] : information) {
    if (option->count() == 0) continue;
    check_alone(parser, option->get_name(), option);
    return command;
  }
  if (parser.completion->count() > 0) {
    check_alone(parser, "--completion", parser.completion);
    const std::string shell = last_value(*parser.completion);
    return CompletionCommand{parse_name<Shell>("completion", shell), describe_program(parser)};
  }
  if (parser.reference->count() > 0) {
    check_alone(parser, "--reference", parser.reference);
    const std::string page = last_value(*parser.reference);
    return ReferenceCommand{parse_name<ReferencePage>("reference", page), describe_program(parser)};
  }
  return make_render_command(given_settings(parser));
}

}  // namespace pt
