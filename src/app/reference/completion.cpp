// Completion scripts for bash, fish and zsh.
#include <fmt/format.h>

#include "app/options/option_values.h"
#include "app/reference/reference.h"
#include "common/scene/builtin/builtin_scenes.h"

namespace pt {
namespace {

/// What a value completes to: the option's choices; the built-in scenes for --scene.
std::vector<std::string> words_of(const OptionText& option) {
  std::vector<std::string> words = option.choices();
  if (option.is_scene()) {
    for (const SceneInfo& scene : scene_list()) words.push_back(scene.name);
  }
  return words;
}

/// The first sentence of a help, cut where it is long.
std::string short_help(const std::string& help) {
  constexpr std::size_t most = 76;
  std::string text = help.substr(0, help.find(". "));
  if (text.ends_with('.')) text.pop_back();
  if (text.size() <= most) return text;
  return text.substr(0, text.rfind(' ', most - 3)) + "...";
}

// Words of the line are split at "=", too. A subcommand's options are those behind its name.
constexpr const char* bash_begin = R"(# bash completion for ptexp, made by `ptexp --completion bash`

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
constexpr const char* bash_end =
    R"(  if [[ $files == yes || ( $files == maybe && $cur != -* ) ]]; then
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur"; compgen -f -- "$cur")
  else
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur")
  fi
}

complete -F _ptexp ptexp
)";

/// The commands that take the option, as a pattern of $command:$prev.
std::string bash_pattern(const std::vector<std::string>& commands, const OptionText& option) {
  std::vector<std::string> parts;
  for (const std::string& command : commands)
    for (const std::string& flag : option.flags) parts.push_back(command + ":" + flag);
  return join(parts, "|");
}

/// How the values of these options are completed.
std::string bash_values(const std::vector<std::string>& commands,
                        const std::vector<OptionText>& options) {
  std::string text;
  for (const OptionText& option : options) {
    if (option.value.empty()) continue;
    text += fmt::format("    {})\n", bash_pattern(commands, option));
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

std::string bash_completion(const CommandText& program) {
  std::vector<std::string> names, renders{""};
  for (const CommandText& one : program.subcommands) {
    names.push_back(one.name);
    if (one.takes_render_options) renders.push_back(one.name);
  }
  std::string text = bash_begin;
  text += fmt::format("      {}) command=${{COMP_WORDS[i]}} ;;\n    esac\n  done\n",
                      join(names, " | "));
  text += "  case $command:$prev in\n" + bash_values(renders, program.options);
  for (const CommandText& one : program.subcommands) text += bash_values({one.name}, one.options);
  text += "    :*)\n      words='" + flags_of(program) + "'\n";
  text += "      [[ $cur == -* ]] || words='" + join(names, " ") + "'\n      ;;\n";
  for (const CommandText& one : program.subcommands) {
    text += fmt::format("    {}:*)\n      words='{}'", one.name, flags_of(one));
    if (one.takes_render_options) text += fmt::format("\n      words+=' {}'", flags_of(program));
    text += one.arguments.empty() ? "\n      ;;\n" : "\n      files=maybe\n      ;;\n";
  }
  return text + "  esac\n" + bash_end;
}

std::string fish_quoted(const std::string& text) {
  return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

std::string fish_line(const std::string& condition, const OptionText& option) {
  std::string text = "complete -c ptexp -n " + fish_quoted(condition);
  for (const std::string& flag : option.flags)
    text += flag.starts_with("--") ? " -l " + flag.substr(2) : " -s " + flag.substr(1);
  if (!option.value.empty()) text += option.is_file() ? " -r -F" : " -x";
  if (const auto words = words_of(option); !words.empty())
    text += " -a " + fish_quoted(join(words, " "));
  return text + " -d " + fish_quoted(short_help(option.help)) + "\n";
}

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
  for (const OptionText& option : program.options) text += fish_line(renders, option);
  for (const CommandText& one : program.subcommands) {
    const std::string condition = "__fish_seen_subcommand_from " + one.name;
    for (const OptionText& option : one.options) text += fish_line(condition, option);
    if (!one.arguments.empty())
      text += fmt::format("complete -c ptexp -n {} -F\n", fish_quoted(condition));
  }
  return text;
}

std::string zsh_quoted(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

/// In a message or a description of _arguments.
std::string zsh_escaped(std::string text) {
  for (const char* c : {"\\", ":", "[", "]"}) text = replaced(text, c, std::string("\\") + c);
  return text;
}

/// ":FILE:_files", ":MODE:(a b)"; of "X Y Z" three, of which the later may be missing.
std::string zsh_value(const OptionText& option) {
  if (option.value.empty()) return "";
  const std::vector<std::string> words = words_of(option);
  std::string action = words.empty() ? "" : "(" + join(words, " ") + ")";
  if (option.is_file())
    action = words.empty() ? "_files" : " _ptexp_word_or_file " + join(words, " ");
  std::string text;
  for (const std::string& one : split(option.value, ' ')) {
    text += fmt::format("{}:{}:{}", text.empty() ? "" : ":", zsh_escaped(one),
                        action.empty() ? " " : action);
  }
  return text.empty() ? "" : ":" + text.substr(1);
}

/// Any option may be given again.
std::string zsh_specs(const std::vector<OptionText>& options) {
  std::string text;
  for (const OptionText& option : options) {
    for (const std::string& flag : option.flags) {
      const bool is_long = flag.starts_with("--") && !option.value.empty();
      text += "    " +
              zsh_quoted(fmt::format("*{}{}[{}]{}", flag, is_long ? "=" : "",
                                     zsh_escaped(short_help(option.help)), zsh_value(option))) +
              "\n";
    }
  }
  return text;
}

std::string zsh_array(const std::string& name, const CommandText& command) {
  return "  local -a " + name + "=(\n" + zsh_specs(command.options) + "  )\n";
}

std::string zsh_completion(const CommandText& program) {
  std::string text =
      "#compdef ptexp\n# zsh completion for ptexp, made by `ptexp --completion zsh`\n\n"
      "_ptexp() {\n  local context state state_descr line\n  typeset -A opt_args\n";
  text += zsh_array("render", program) + "  local -a commands=(\n";
  for (const CommandText& one : program.subcommands)
    text += "    " + zsh_quoted(one.name + ":" + zsh_escaped(short_help(one.help))) + "\n";
  text += "  )\n";
  text +=
      "  _arguments -S $render '1:command:->command' '*::argument:->argument' && return\n"
      "  case $state in\n    command) _describe command commands ;;\n"
      "    argument)\n      case $words[1] in\n";
  for (const CommandText& one : program.subcommands) {
    text += fmt::format("        {}) _ptexp_{} ;;\n", one.name, one.name);
  }
  text += "      esac\n      ;;\n  esac\n}\n\n";
  for (const CommandText& one : program.subcommands) {
    text += "_ptexp_" + one.name + "() {\n" + zsh_array("own", one);
    if (one.takes_render_options) text += zsh_array("render", program);
    text += std::string("  _arguments -S $own") + (one.takes_render_options ? " $render" : "") +
            (one.arguments.empty() ? "" : " '*:file:_files'") + "\n}\n\n";
  }
  text += "_ptexp_word_or_file() { _alternative \"word:word:($*)\" 'file:file:_files' }\n\n";
  return text + "_ptexp \"$@\"\n";
}

}  // namespace

std::string completion_text(const CompletionCommand& command) {
  switch (command.shell) {
    case Shell::zsh:
      return zsh_completion(command.program);
    case Shell::fish:
      return fish_completion(command.program);
    case Shell::bash:
      break;
  }
  return bash_completion(command.program);
}

}  // namespace pt
