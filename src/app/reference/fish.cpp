#include <fmt/format.h>

#include "app/reference/reference.h"
#include "app/reference/words.h"

namespace pt {
namespace {

std::string fish_quoted(const std::string& text) {
  return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

std::string line(const std::string& condition, const OptionText& option) {
  std::string text = "complete -c ptexp -n " + fish_quoted(condition);
  for (const std::string& flag : option.flags)
    text += flag.starts_with("--") ? " -l " + flag.substr(2) : " -s " + flag.substr(1);
  if (!option.value.empty()) text += option.is_file() ? " -r -F" : " -x";
  if (const auto words = words_of(option); !words.empty())
    text += " -a " + fish_quoted(join(words, " "));
  return text + " -d " + fish_quoted(short_help(option.help)) + "\n";
}

}  // namespace

std::string fish_completion(const CommandText& program) {
  std::string text =
      "# fish completion for ptexp, made by `ptexp --completion fish`\n"
      "complete -c ptexp -f\n";
  std::vector<std::string> others;  // which do not take the program's options
  for (const CommandText& one : program.subcommands) {
    if (!one.takes_render_options) others.push_back(one.name);
    text += fmt::format("complete -c ptexp -n __fish_use_subcommand -a {} -d {}\n", one.name,
                        fish_quoted(short_help(one.help)));
  }
  const std::string renders = "not __fish_seen_subcommand_from " + join(others, " ");
  for (const OptionText& option : program.options) text += line(renders, option);
  for (const CommandText& one : program.subcommands) {
    const std::string condition = "__fish_seen_subcommand_from " + one.name;
    for (const OptionText& option : one.options) text += line(condition, option);
    if (!one.arguments.empty())
      text += fmt::format("complete -c ptexp -n {} -F\n", fish_quoted(condition));
  }
  return text;
}

}  // namespace pt
