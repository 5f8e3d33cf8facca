#include <fmt/format.h>

#include "app/reference/reference.h"
#include "app/reference/words.h"

namespace pt {
namespace {

/// Nothing of a help's text is meant as Markdown but what is in backticks.
std::string plain(std::string text) {
  for (const char* c : {"\\", "*", "_", "<", "[", "]"})
    text = replaced(text, c, std::string("\\") + c);
  return text;
}

std::string entry(const std::string& anchor, const OptionText& option) {
  std::string text = "`" + join(option.flags, "`, `");
  if (!option.value.empty()) text += (option.flags.empty() ? "" : " ") + option.value;
  text = "### " + text + "` {#" + anchor + "}\n\n" + plain(option.help);
  if (!option.help.ends_with('.')) text += ".";
  if (!option.standard.empty()) text += " Default: `" + option.standard + "`.";
  return text + "\n\n";
}

/// "--spp" -> "spp"
std::string anchor_of(const OptionText& option) {
  return option.flags.empty() ? option.value : option.long_flag().substr(2);
}

}  // namespace

std::string markdown_page(const CommandText& program) {
  std::string text = "# Options\n\n" + plain(program.help) + "\n\n";
  std::string group;
  for (const OptionText& option : program.options) {
    if (option.group != group) text += "## " + plain(group = option.group) + "\n\n";
    text += entry(anchor_of(option), option);
  }
  for (const CommandText& one : program.subcommands) {
    text += "## ptexp " + one.name + " {#" + one.name + "}\n\n" + plain(one.help) + "\n\n";
    for (const auto* list : {&one.arguments, &one.options})
      for (const OptionText& option : *list)
        text += entry(one.name + "-" + anchor_of(option), option);
  }
  return text + "## Exit codes\n\n" + plain(program.footer) + "\n";
}

}  // namespace pt
