#include "app/options/command_text.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "app/options/option_values.h"

namespace pt {
namespace {

/// Joins lines; a word that was split at its hyphen becomes one again.
std::string in_one_line(const std::string& text) {
  std::string line;
  for (const std::string& part : split(text, '\n')) {
    const bool joins = line.empty() || line.ends_with('-');
    line += (joins ? "" : " ") + part;
  }
  return line;
}

OptionText describe(const CLI::Option& option) {
  OptionText text;
  for (const std::string& name : option.get_snames()) text.flags.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) text.flags.push_back("--" + name);
  text.group = option.get_group();
  text.help = in_one_line(option.get_description());
  if (option.get_positional()) {
    text.value = option.get_name(true);
  } else if (option.get_items_expected_max() > 0) {
    text.value = option.get_type_name();
    const std::size_t standard = text.value.find(" [");
    if (standard != std::string::npos) {
      text.standard = text.value.substr(standard + 2, text.value.rfind(']') - standard - 2);
      text.value.resize(standard);
    }
  }
  return text;
}

bool is_plain(char c) {
  const bool is_alphanumeric =
      (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  return is_alphanumeric || std::string("-_./:,=+@%").find(c) != std::string::npos;
}

std::string quoted(const std::string& text) {
  if (!text.empty() && std::all_of(text.begin(), text.end(), is_plain)) return text;
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

/// "auto|cuda[:N,..|:all]" -> "auto|cuda"
std::string without_brackets(const std::string& text) {
  std::string result;
  int depth = 0;
  for (const char c : text) {
    if (c == '[') ++depth;
    if (depth == 0) result += c;
    if (c == ']') --depth;
  }
  return result;
}

}  // namespace

std::vector<std::string> OptionText::choices() const {
  const auto is_word = [](const std::string& text) {
    return !text.empty() && std::ranges::all_of(text, [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    });
  };
  std::vector<std::string> words = split(without_brackets(value), '|');
  std::erase_if(words, [&](const std::string& word) { return !is_word(word); });
  return words;
}

CommandText describe(const CLI::App& app) {
  CommandText text;
  text.name = app.get_name();
  text.help = in_one_line(app.get_description());
  text.footer = in_one_line(app.get_footer());
  for (const CLI::Option* option : app.get_options()) {
    (option->get_positional() ? text.arguments : text.options).push_back(describe(*option));
  }
  for (const CLI::App* one : app.get_subcommands({})) text.subcommands.push_back(describe(*one));
  return text;
}

std::string shell_text(const std::vector<std::string>& arguments) {
  std::string text;
  for (const std::string& argument : arguments)
    text += (text.empty() ? "" : " ") + quoted(argument);
  return text;
}

}  // namespace pt
