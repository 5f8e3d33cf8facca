#include <fmt/format.h>

#include "app/options/option_values.h"
#include "app/reference/reference.h"
#include "app/reference/words.h"

namespace pt {
namespace {

std::string zsh_quoted(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

/// In a message or a description of _arguments.
std::string escaped(std::string text) {
  for (const char* c : {"\\", ":", "[", "]"}) text = replaced(text, c, std::string("\\") + c);
  return text;
}

/// ":FILE:_files", ":MODE:(a b)"; of "X Y Z" three, of which the later may be missing.
std::string value_of(const OptionText& option) {
  if (option.value.empty()) return "";
  const std::vector<std::string> words = words_of(option);
  std::string action = words.empty() ? "" : "(" + join(words, " ") + ")";
  if (option.is_file())
    action = words.empty() ? "_files" : " _ptexp_word_or_file " + join(words, " ");
  std::string text;
  for (const std::string& one : split(option.value, ' ')) {
    text += fmt::format("{}:{}:{}", text.empty() ? "" : ":", escaped(one),
                        action.empty() ? " " : action);
  }
  return text.empty() ? "" : ":" + text.substr(1);
}

/// Any option may be given again.
std::string specs(const std::vector<OptionText>& options) {
  std::string text;
  for (const OptionText& option : options) {
    for (const std::string& flag : option.flags) {
      const bool is_long = flag.starts_with("--") && !option.value.empty();
      text += "    " +
              zsh_quoted(fmt::format("*{}{}[{}]{}", flag, is_long ? "=" : "",
                                     escaped(short_help(option.help)), value_of(option))) +
              "\n";
    }
  }
  return text;
}

std::string array(const std::string& name, const CommandText& command) {
  return "  local -a " + name + "=(\n" + specs(command.options) + "  )\n";
}

}  // namespace

std::string zsh_completion(const CommandText& program) {
  std::string text =
      "#compdef ptexp\n# zsh completion for ptexp, made by `ptexp --completion zsh`\n\n"
      "_ptexp() {\n  local context state state_descr line\n  typeset -A opt_args\n";
  text += array("render", program) + "  local -a commands=(\n";
  for (const CommandText& one : program.subcommands)
    text += "    " + zsh_quoted(one.name + ":" + escaped(short_help(one.help))) + "\n";
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
    text += "_ptexp_" + one.name + "() {\n" + array("own", one);
    if (one.takes_render_options) text += array("render", program);
    text += std::string("  _arguments -S $own") + (one.takes_render_options ? " $render" : "") +
            (one.arguments.empty() ? "" : " '*:file:_files'") + "\n}\n\n";
  }
  text += "_ptexp_word_or_file() { _alternative \"word:word:($*)\" 'file:file:_files' }\n\n";
  return text + "_ptexp \"$@\"\n";
}

}  // namespace pt
