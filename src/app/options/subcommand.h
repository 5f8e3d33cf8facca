// Parses a subcommand by the table of its options. CLI11 takes long to compile, so few files
// include this one.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "app/options/subcommand_option.h"
#include "common/error/error.h"

namespace pt {

/// Adds the options to CLI11's subcommand `app`.
template <class Command>
class Subcommand {
 public:
  Subcommand(CLI::App& parent, const std::string& name, const std::string& text,
             std::vector<SubcommandOption<Command>> options)
      : name_(name), options_(std::move(options)), app_(parent.add_subcommand(name, text)) {
    for (const SubcommandOption<Command>& option : options_) {
      const std::string flag = std::string("--") + option.name, help = option.help;
      CLI::Option* added = option.placeholder == nullptr
                               ? app_->add_flag(flag, help)->disable_flag_override()
                               : app_->add_option_function<std::vector<std::string>>(
                                         flag, [](const std::vector<std::string>&) {}, help)
                                     ->expected(1)
                                     ->allow_extra_args(false)
                                     ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
                                     ->type_name(option.placeholder);
      added_.push_back(added);
    }
    app_->allow_extras();
  }

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

}  // namespace pt
