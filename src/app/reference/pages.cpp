// The man page, and the page of options on the site.
#include <fmt/format.h>

#include "app/options/option_values.h"
#include "app/reference/reference.h"
#include "common/platform/build_info.h"

namespace pt {
namespace {

/// As text of roff: hyphens that can be copied.
std::string roff(const std::string& text) {
  return replaced(replaced(text, "\\", "\\e"), "-", "\\-");
}

/// Lines of a page's source: short, a sentence begins one, and none is a request.
std::string lines(const std::string& text) {
  constexpr std::size_t most = 78;
  std::string all, line;
  for (const std::string& word : split(roff(text), ' ')) {
    if (!line.empty() && (line.size() + 1 + word.size() > most || line.ends_with('.'))) {
      all += line + "\n";
      line.clear();
    }
    if (line.empty() && (word.starts_with('.') || word.starts_with('\''))) line = "\\&";
    line += (line.empty() || line == "\\&" ? "" : " ") + word;
  }
  return all + line;
}

std::string roff_entry(const OptionText& option) {
  std::string text = ".TP\n";
  std::vector<std::string> flags;
  for (const std::string& flag : option.flags) flags.push_back("\\fB" + roff(flag) + "\\fR");
  text += join(flags, ", ");
  if (!option.value.empty())
    text += (flags.empty() ? "" : " ") + std::string("\\fI") + roff(option.value) + "\\fR";
  text += "\n" + lines(option.help) + (option.help.ends_with('.') ? "" : ".");
  if (!option.standard.empty()) text += "\nDefault: \\fB" + roff(option.standard) + "\\fR.";
  return text + "\n";
}

std::string usage(const CommandText& command) {
  std::string text = "\n.B ptexp " + command.name + "\n";
  for (const OptionText& one : command.arguments) text += ".I " + roff(one.value) + "\n";
  return text + (command.options.size() > 1 ? "[\\fIoptions\\fR]\n" : "");
}

constexpr const char* environment =
    ".SH ENVIRONMENT\n"
    ".TP\n.B PTEXP_LAUNCHER\n\\fBoff\\fR: processes that a launcher has started render alone.\n"
    ".TP\n.B PTEXP_MPI_TIMEOUT\nSeconds after which a silent process of an MPI job is lost.\n"
    ".TP\n.B PTEXP_MPI_CHUNK\nBytes of the parts in which long messages are sent.\n"
    ".TP\n.B PTEXP_CUPTI\nThe library libcupti for \\fB\\-\\-counters\\fR.\n";
constexpr const char* examples =
    ".SH EXAMPLES\n.nf\n"
    "ptexp \\-\\-scene cornell \\-\\-spp 64 \\-\\-output cornell.png\n"
    "ptexp \\-\\-mode megakernel \\-\\-device cuda \\-\\-repeat 10 \\-\\-stats run.json\n"
    "ptexp compare megakernel.exr wavefront.exr\n"
    "ptexp doctor\n.fi\n"
    ".SH SEE ALSO\nThe documentation in \\fI/usr/share/doc/ptexp\\fR.\n";

std::string man_page(const CommandText& program) {
  const BuildInfo& build = build_info();
  std::string text =
      fmt::format(".TH PTEXP 1 {} \"ptexp {}\" \"User Commands\"\n", build.date, build.version);
  text += ".SH NAME\nptexp \\- path tracer that renders by several execution strategies\n";
  text += ".SH SYNOPSIS\n.B ptexp\n[\\fIoptions\\fR]\n";
  for (const CommandText& one : program.subcommands) text += ".br" + usage(one);
  text += ".SH DESCRIPTION\n" + lines(program.help) + "\n.SH OPTIONS\n";
  std::string group;
  for (const OptionText& option : program.options) {
    if (option.group != group) text += ".SS " + roff(group = option.group) + "\n";
    text += roff_entry(option);
  }
  text += ".SH COMMANDS\n";
  for (const CommandText& one : program.subcommands) {
    text += ".SS ptexp " + one.name + "\n" + lines(one.help) + "\n";
    for (const OptionText& argument : one.arguments) text += roff_entry(argument);
    for (const OptionText& option : one.options) text += roff_entry(option);
  }
  text += ".SH EXIT STATUS\n" + lines(program.footer) + "\n";
  return text + environment + examples;
}

/// Nothing of a help's text is meant as Markdown but what is in backticks.
std::string plain(std::string text) {
  for (const char* c : {"\\", "*", "_", "<", "[", "]"})
    text = replaced(text, c, std::string("\\") + c);
  return text;
}

std::string markdown_entry(const std::string& anchor, const OptionText& option) {
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

std::string markdown_page(const CommandText& program) {
  std::string text = "# Options\n\n" + plain(program.help) + "\n\n";
  std::string group;
  for (const OptionText& option : program.options) {
    if (option.group != group) text += "## " + plain(group = option.group) + "\n\n";
    text += markdown_entry(anchor_of(option), option);
  }
  for (const CommandText& one : program.subcommands) {
    text += "## ptexp " + one.name + " {#" + one.name + "}\n\n" + plain(one.help) + "\n\n";
    for (const auto* list : {&one.arguments, &one.options})
      for (const OptionText& option : *list)
        text += markdown_entry(one.name + "-" + anchor_of(option), option);
  }
  return text + "## Exit codes\n\n" + plain(program.footer) + "\n";
}

}  // namespace

std::string join(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

std::string reference_text(const ReferenceCommand& command) {
  const bool is_man = command.page == ReferencePage::man;
  return is_man ? man_page(command.program) : markdown_page(command.program);
}

}  // namespace pt
