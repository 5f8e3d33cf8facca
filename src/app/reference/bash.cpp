#include <fmt/format.h>

#include "app/reference/reference.h"
#include "app/reference/words.h"

namespace pt {
namespace {

// Words of the line are split at "=", too. A subcommand's options are those behind its name.
constexpr const char* begin = R"(# bash completion for ptexp, made by `ptexp --completion bash`

_ptexp() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]} i
  local command='' words='' files=''
  if [[ $cur == = ]]; then
    cur=''
  elif [[ $prev == = ]]; then
    prev=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  for ((i = 1; i < COMP_CWORD; i++)); do
    case ${COMP_WORDS[i]} in
)";
constexpr const char* end = R"(  if [[ $files == yes || ( $files == maybe && $cur != -* ) ]]; then
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur"; compgen -f -- "$cur")
  else
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur")
  fi
}

complete -F _ptexp ptexp
)";

/// The commands that take the option, as a pattern of $command:$prev.
std::string pattern(const std::vector<std::string>& commands, const OptionText& option) {
  std::vector<std::string> parts;
  for (const std::string& command : commands)
    for (const std::string& flag : option.flags) parts.push_back(command + ":" + flag);
  return join(parts, "|");
}

/// How the values of these options are completed.
std::string values(const std::vector<std::string>& commands,
                   const std::vector<OptionText>& options) {
  std::string text;
  for (const OptionText& option : options) {
    if (option.value.empty()) continue;
    text += fmt::format("    {})\n", pattern(commands, option));
    text += fmt::format("      words='{}' files={}\n      ;;\n", join(words_of(option), " "),
                        option.is_file() ? "yes" : "no");
  }
  return text;
}

std::string flags_of(const CommandText& command) {
  std::vector<std::string> flags;
  for (const OptionText& option : command.options)
    flags.insert(flags.end(), option.flags.begin(), option.flags.end());
  return join(flags, " ");
}

}  // namespace

std::string bash_completion(const CommandText& program) {
  std::vector<std::string> names, renders{""};
  for (const CommandText& one : program.subcommands) {
    names.push_back(one.name);
    if (one.takes_render_options) renders.push_back(one.name);
  }
  std::string text = begin;
  text += fmt::format("      {}) command=${{COMP_WORDS[i]}} ;;\n    esac\n  done\n",
                      join(names, " | "));
  text += "  case $command:$prev in\n" + values(renders, program.options);
  for (const CommandText& one : program.subcommands) text += values({one.name}, one.options);
  text += "    :*)\n      words='" + flags_of(program) + "'\n";
  text += "      [[ $cur == -* ]] || words='" + join(names, " ") + "'\n      ;;\n";
  for (const CommandText& one : program.subcommands) {
    text += fmt::format("    {}:*)\n      words='{}'", one.name, flags_of(one));
    if (one.takes_render_options) text += fmt::format("\n      words+=' {}'", flags_of(program));
    text += one.arguments.empty() ? "\n      ;;\n" : "\n      files=maybe\n      ;;\n";
  }
  return text + "  esac\n" + end;
}

}  // namespace pt
