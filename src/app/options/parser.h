// The program's options and subcommands as CLI11 has them. CLI11 takes long to compile, so few
// files include this one.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "app/options/command_line.h"
#include "common/error/error.h"
#include "common/options/option_names.h"

namespace pt {

inline CLI::Option* add_flag(CLI::App& app, const std::string& flags, const std::string& help) {
  // As strings: a literal is ambiguous in CLI11 2.1.
  return app.add_flag(flags, help)->disable_flag_override();
}

/// An option with one value, whose text the results keep.
inline CLI::Option* add_text(CLI::App& app, const std::string& flags, const std::string& help) {
  return app
      .add_option_function<std::vector<std::string>>(
          flags, [](const std::vector<std::string>&) {}, help)
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

/// Adds the options to CLI11's subcommand `app`.
template <class Command>
class Subcommand {
 public:
  Subcommand(CLI::App& parent, const std::string& name, const std::string& text,
             std::vector<SubcommandOption<Command>> options)
      : name_(name), options_(std::move(options)), app_(parent.add_subcommand(name, text)) {
    for (const SubcommandOption<Command>& option : options_) {
      const std::string flag = std::string("--") + option.name, help = option.help;
      const bool is_flag = option.placeholder == nullptr;
      CLI::Option* added = is_flag ? add_flag(*app_, flag, help) : add_text(*app_, flag, help);
      if (!is_flag) added->type_name(option.placeholder);
      added_.push_back(added);
    }
    app_->allow_extras();
  }

  const std::string& name() const { return name_; }
  bool is_parsed() const { return app_->parsed(); }

  /// The last value of an option that is given twice. Throws Error for options that are missing or
  /// have bad values.
  Command parse() const {
    Command command;
    for (std::size_t i = 0; i < options_.size(); ++i) {
      const SubcommandOption<Command>& option = options_[i];
      const auto values = added_[i]->results();
      if (option.is_required && values.empty())
        throw Error(fmt::format("{}: expected --{} {}", name_, option.name, option.placeholder));
      if (!values.empty()) option.set(command, values.back());
    }
    return command;
  }

 private:
  std::string name_;
  std::vector<SubcommandOption<Command>> options_;
  CLI::App* app_;
  std::vector<CLI::Option*> added_;
};

template <>
inline constexpr auto enum_names<Shell> = std::to_array<EnumName<Shell>>({{Shell::bash, "bash"},
                                                                          {Shell::zsh, "zsh"},
                                                                          {Shell::fish, "fish"}});
template <>
inline constexpr auto enum_names<ReferencePage> = std::to_array<EnumName<ReferencePage>>(
    {{ReferencePage::man, "man"}, {ReferencePage::markdown, "markdown"}});

/// CLI11 splits the arguments and lays out the help; values are parsed by option_list, because
/// their errors should name the option, the value and what was expected in one line.
struct Parser {
  CLI::App app;
  std::vector<std::pair<const OptionEntry*, CLI::Option*>> options;
  CLI::Option *list_scenes = nullptr, *list_devices = nullptr, *list_kernels = nullptr;
  CLI::Option *version = nullptr, *completion = nullptr, *reference = nullptr;
  Subcommand<TraceCommand> trace;
  Subcommand<RaysCommand> rays;
  Subcommand<CompactCommand> compact;
  Subcommand<DoctorCommand> doctor;
  Subcommand<MeasureCommand> measure;
  Subcommand<CalibrateCommand> calibrate;
  CLI::App *resume = nullptr, *merge = nullptr, *verify = nullptr, *view = nullptr;
  CLI::App* advise = nullptr;
  CLI::Option *checkpoint = nullptr, *merged = nullptr, *parts = nullptr, *verified = nullptr;
  CLI::Option *allow_missing = nullptr, *keep_sums = nullptr, *share = nullptr;
  CLI::Option *viewed = nullptr, *port = nullptr, *advised = nullptr;
  CLI::App* compare = nullptr;
  CLI::Option *image_a = nullptr, *image_b = nullptr, *tolerance = nullptr, *difference = nullptr;

  Parser();

  /// The subcommand that was named if it takes options of rendering, else null.
  const CLI::App* rendering_subcommand() const;
  /// The help of the program or of the subcommand that was named. Changes the options' groups.
  std::string help();
  std::string all_help();
  CommandText describe() const;

 private:
  void add_option(const OptionEntry& entry);
  void add_film_commands();
};

}  // namespace pt
