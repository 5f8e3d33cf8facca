#include <fmt/format.h>

#include "app/options/option_values.h"
#include "app/reference/reference.h"
#include "app/reference/words.h"
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

std::string entry(const OptionText& option) {
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

}  // namespace

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
    text += entry(option);
  }
  text += ".SH COMMANDS\n";
  for (const CommandText& one : program.subcommands) {
    text += ".SS ptexp " + one.name + "\n" + lines(one.help) + "\n";
    for (const OptionText& argument : one.arguments) text += entry(argument);
    for (const OptionText& option : one.options) text += entry(option);
  }
  text += ".SH EXIT STATUS\n" + lines(program.footer) + "\n";
  return text + environment + examples;
}

}  // namespace pt
