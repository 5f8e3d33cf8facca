#include "app/options/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>

#include "app/options/option_list.h"
#include "app/options/option_values.h"
#include "app/options/parser.h"
#include "common/error/error.h"
#include "common/scene/builtin/builtin_scenes.h"

namespace pt {
namespace {

/// The last value of an option that is given more than once holds, so that options can override
/// those of a script.
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

/// All options that are given, in the order of the table.
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

/// The settings that were given beside a command that renders without an image as its result, as
/// often as it wants. Throws Error for those of one render, and `more`.
std::vector<Setting> settings_beside(const Parser& parser, const char* command,
                                     std::initializer_list<std::string_view> more) {
  std::vector<Setting> settings = given_settings(parser);
  for (const Setting& setting : settings) {
    const std::string& name = setting.entry->name;
    if (name == "scene" || is_of_one_render(*setting.entry) ||
        std::ranges::find(more, name) != more.end())
      throw Error(fmt::format("--{}: has no effect together with {}", name, command));
  }
  return settings;
}

bool is_quiet(const std::vector<Setting>& settings) {
  return std::ranges::any_of(settings, [](const Setting& s) { return s.entry->name == "quiet"; });
}

ViewCommand parse_view(const Parser& parser) {
  const std::string scene = file_of(parser.viewed, "ptexp view SCENE");
  ViewCommand command;
  if (parser.port->count() > 0)
    command.port = static_cast<int>(parse_integer("port", last_value(*parser.port), 0, 65535));
  command.settings = settings_beside(parser, "view", {"aov", "time-limit", "target-error"});
  command.is_quiet = is_quiet(command.settings);
  command.settings.push_back({&find_option("scene"), scene});
  command.settings.push_back({&find_option("output"), "page.png"});
  if (make_render_command(command.settings).options.integrator == IntegratorKind::mlt)
    throw Error("--integrator mlt: has no image before it ends; view expects path");
  return command;
}

AdviseCommand parse_advise(const Parser& parser) {
  const std::string scene = file_of(parser.advised, "ptexp advise SCENE");
  AdviseCommand command;
  for (const Setting& setting : settings_beside(parser, "advise", {"exposure", "target-error"})) {
    if (setting.entry->name == "time-limit")
      command.limit_s = parse_number("time-limit", setting.value, "seconds above 0",
                                     [](float x) { return x > 0; });
    else
      command.settings.push_back(setting);
  }
  command.is_quiet = is_quiet(command.settings);
  command.settings.push_back({&find_option("scene"), scene});
  (void)make_render_command(command.settings);  // refuses what it can at once
  return command;
}

/// Throws Error where options of rendering stand beside another command, which would ignore them.
void check_alone(const Parser& parser, const std::string& command, const CLI::Option* self) {
  for (const CLI::Option* option : parser.app.get_options())
    if (option != self && option->count() > 0)
      throw Error(fmt::format("{}: has no effect together with {}", option->get_name(), command));
}

template <class AnyCommand>
AnyCommand parse_alone(const Parser& parser, const Subcommand<AnyCommand>& subcommand,
                       const std::vector<std::string>& arguments) {
  check_alone(parser, subcommand.name(), nullptr);
  AnyCommand command = subcommand.parse();
  if constexpr (requires { command.command_line; }) command.command_line = shell_text(arguments);
  return command;
}

/// CLI11 takes -.5 for a short option, though not -0.5.
std::vector<std::string> with_leading_zeros(std::vector<std::string> arguments) {
  for (std::string& text : arguments)
    if (text.size() > 2 && text.starts_with("-.") && std::isdigit(text[2])) text.insert(1, "0");
  return arguments;
}

/// What a user may have meant by an argument that no option takes, as it has to be written; or "".
std::string meant_by(const Parser& parser, const std::string& argument) {
  const auto subcommands = parser.app.get_subcommands();
  const CLI::App* const own = subcommands.empty() ? &parser.app : subcommands.front();
  std::vector<std::string> names;
  if (argument.starts_with('-')) {
    std::vector<const CLI::App*> sources{own};
    if (parser.rendering_subcommand() != nullptr) sources.push_back(&parser.app);
    for (const CLI::App* source : sources)
      for (const CLI::Option* option : source->get_options())
        for (const std::string& name : option->get_lnames()) names.push_back(name);
    const std::size_t begin = std::min(argument.find_first_not_of('-'), argument.size());
    const std::string nearest =
        nearest_name(argument.substr(begin, argument.find('=') - begin), names);
    return nearest.empty() ? "" : "--" + nearest;
  }
  if (own != &parser.app) return "";
  const std::string scene = argument.substr(0, argument.find(':'));
  std::error_code ignored;
  if (std::filesystem::is_regular_file(argument, ignored) ||
      std::ranges::any_of(scene_list(), [&](const auto& info) { return info.name == scene; }))
    return "--scene " + argument;
  for (const CLI::App* command : parser.app.get_subcommands({}))
    names.push_back(command->get_name());
  const std::string nearest = nearest_name(argument, names);
  return nearest.empty() ? "" : "ptexp " + nearest;
}

void check_extras(const Parser& parser) {
  const auto extras = parser.app.remaining(true);
  if (extras.empty()) return;
  const bool is_option = extras.front().starts_with('-');
  const std::string meant = meant_by(parser, extras.front());
  throw Error(fmt::format("{}: {}{}", extras.front(),
                          is_option ? "no such option" : "an argument without an option",
                          meant.empty() ? ", see ptexp --help" : meaning(meant)));
}

}  // namespace

Command parse_command_line(const std::vector<std::string>& arguments) {
  Parser parser;
  std::vector<std::string> reversed = with_leading_zeros(arguments);
  std::ranges::reverse(reversed);  // CLI11 takes them from the back
  try {
    parser.app.parse(std::move(reversed));
  } catch (const CLI::CallForHelp&) {
    return HelpCommand{parser.help()};
  } catch (const CLI::CallForAllHelp&) {
    return HelpCommand{parser.all_help()};
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
  if (parser.advise->parsed()) return parse_advise(parser);
  if (parser.compare->parsed()) {
    check_alone(parser, "compare", nullptr);
    return parse_compare(parser);
  }
  if (parser.trace.is_parsed()) return parse_alone(parser, parser.trace, arguments);
  if (parser.rays.is_parsed()) return parse_alone(parser, parser.rays, arguments);
  if (parser.compact.is_parsed()) return parse_alone(parser, parser.compact, arguments);
  if (parser.doctor.is_parsed()) return parse_alone(parser, parser.doctor, arguments);
  if (parser.measure.is_parsed()) return parse_alone(parser, parser.measure, arguments);
  if (parser.calibrate.is_parsed()) {
    CalibrateCommand command = parse_alone(parser, parser.calibrate, arguments);
    (void)make_render_command(command.settings);  // refuses what it can at once
    return command;
  }
  const std::pair<const CLI::Option*, Command> lists[] = {
      {parser.list_scenes, ListScenesCommand{}},
      {parser.list_devices, ListDevicesCommand{}},
      {parser.list_kernels, ListKernelsCommand{}},
      {parser.version, VersionCommand{}}};
  for (const auto& [option, command] : lists) {
    if (option->count() == 0) continue;
    check_alone(parser, option->get_name(), option);
    return command;
  }
  if (parser.completion->count() > 0) {
    check_alone(parser, "--completion", parser.completion);
    const std::string shell = last_value(*parser.completion);
    return CompletionCommand{parse_name<Shell>("completion", shell), parser.describe()};
  }
  if (parser.reference->count() > 0) {
    check_alone(parser, "--reference", parser.reference);
    const std::string page = last_value(*parser.reference);
    return ReferenceCommand{parse_name<ReferencePage>("reference", page), parser.describe()};
  }
  return make_render_command(given_settings(parser));
}

}  // namespace pt
