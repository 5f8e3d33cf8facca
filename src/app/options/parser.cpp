#include "app/options/parser.h"

#include "app/options/option_list.h"

namespace pt {
namespace {

constexpr const char* program_text =
    "ptexp renders an image by several execution strategies, to compare their speed.\n"
    "`ptexp --mode wavefront --spp 50` renders the paper's scene to image.exr.";
constexpr const char* compare_text =
    "Prints RMSE, relMSE, FLIP, the largest difference, how many pixels differ.\n"
    "Exit code 0: within the tolerance, 1: beyond it, 2: an image cannot be read.";
constexpr const char* resume_text =
    "Goes on with the render of a checkpoint, by the options of its beginning. Others\n"
    "may be given that do not change what a sample is: --spp, for more of them,\n"
    "--output, and how and where to render.";
constexpr const char* merge_text =
    "Joins the checkpoints of an image's parts (--part). Pixels that several have are\n"
    "compared. Exit code 0: done, 2: something is missing, foreign or differs.";
constexpr const char* verify_text =
    "Renders some of an image's pixels again, by the options in its header, and\n"
    "compares. Exit code 0: the bits are equal, 1: they differ, 2: an error.";
constexpr const char* view_text =
    "Shows the render in progress on a page for the browsers of this machine, where\n"
    "camera, mode and exposure can be changed, until Ctrl-C.";
constexpr const char* advise_text =
    "Renders the scene by both modes and by the options that matter, in turns, and\n"
    "prints which is the fastest here, how sure that is, and why. Takes --time-limit\n"
    "seconds, by default 60, and writes no image.";
constexpr const char* trace_text =
    "Traces rays from a file, measures the rate and compares with reference hits.\n"
    "Exit code 0: done, 1: hits differ from the reference, 2: an error.";
constexpr const char* rays_text = "Makes a file of rays for `ptexp trace`.";
constexpr const char* compact_text =
    "Measures the wavefront's compaction strategies alone, and a copy for comparison.\n"
    "Exit code 0: done, 2: an error, or a strategy whose result is wrong.";
constexpr const char* doctor_text =
    "Tells what would run on this machine, what not, and the remedy.\n"
    "Exit code 0: all that it was built for works, 1: something is missing.";
constexpr const char* calibrate_text =
    "Measures in at most 30 s the numbers by which auto decides on this device, and\n"
    "stores them in the user's cache folder, where later runs find them.";
constexpr const char* measure_text =
    "Measures one configuration after the other: reads their options as lines of JSON,\n"
    "{\"arguments\": [\"--mode\", \"wavefront\", ...]}, and answers each with a line.";
constexpr const char* footer_text =
    "An option that has no effect in the chosen mode or on the chosen device is refused.\n"
    "Exit codes: 0 done, 2 an error (one line on stderr), 130 interrupted by Ctrl-C, 143 by\n"
    "SIGTERM; the image then has the samples that were finished. `ptexp compare --help` tells\n"
    "more.";

constexpr const char* information = "Information";  // heading in the help
constexpr std::size_t help_column = 34;

/// CLI11 leaves two empty lines between groups.
std::string without_double_gaps(std::string text) {
  for (std::size_t at; (at = text.find("\n\n\n")) != std::string::npos;) text.erase(at, 1);
  return text;
}

}  // namespace

void Parser::add_option(const OptionEntry& entry) {
  const std::string flags =
      (entry.short_flag.empty() ? "" : entry.short_flag + ",") + "--" + entry.name;
  CLI::Option* option = entry.form == OptionForm::flag ? add_flag(app, flags, entry.help)
                                                       : add_text(app, flags, entry.help);
  option->group(heading(entry.group));
  if (entry.form == OptionForm::vector) option->expected(1, 3);
  if (entry.form != OptionForm::flag) {
    const std::string standard = entry.text(Options());
    option->type_name(entry.placeholder + (standard.empty() ? "" : " [" + standard + "]"));
  }
  options.emplace_back(&entry, option);
}

Parser::Parser()
    : app(program_text, "ptexp"),
      trace(app, "trace", trace_text, trace_options()),
      rays(app, "rays", rays_text, rays_options()),
      compact(app, "compact", compact_text, compact_options()),
      doctor(app, "doctor", doctor_text, doctor_options()),
      measure(app, "measure", measure_text, {}),
      calibrate(app, "calibrate", calibrate_text, calibrate_options()) {
  for (const OptionEntry& entry : option_list()) add_option(entry);
  app.set_help_flag("-h,--help", "Prints this help")->group(information);
  list_scenes = add_flag(app, "--list-scenes", "Names and describes the scenes");
  list_devices = add_flag(app, "--list-devices", "Names the devices that --device can take");
  list_kernels =
      add_flag(app, "--list-kernels", "Prints which kernels there are, for which scenes");
  version = add_flag(app, "--version", "Prints version, commit and build options");
  completion = add_text(app, "--completion", "Prints the completion of options for a shell");
  completion->type_name(joined_names<Shell>("|"));
  reference = add_text(app, "--reference", "Prints all of this help as a page");
  reference->type_name(joined_names<ReferencePage>("|"));
  for (CLI::Option* option :
       {list_scenes, list_devices, list_kernels, version, completion, reference})
    option->group(information);
  app.allow_extras();

  add_film_commands();
  compare = app.add_subcommand("compare", compare_text);
  image_a = add_text(*compare, "A", "Image, .exr, .png or .ppm");
  image_b = add_text(*compare, "B", "Reference of the same size");
  tolerance = add_text(*compare, "--tolerance", "Largest |A - B| of a value that is accepted");
  tolerance->type_name("T [0]");
  difference = add_text(*compare, "--difference",
                        "Image to write: A - B in an .exr, else FLIP in false colours");
  difference->type_name("FILE");
  compare->allow_extras();
  for (CLI::Option* image : {image_a, image_b})
    image->type_name("")->multi_option_policy(CLI::MultiOptionPolicy::Throw);
  // Last: a subcommand would inherit these.
  app.set_help_all_flag("--help-all", "Prints the help of all options")->group(information);
  app.footer(footer_text);
  app.get_formatter()->column_width(help_column);
}

/// Options of rendering may follow the names resume, verify, view and advise: these fall through to
/// the program's.
void Parser::add_film_commands() {
  resume = app.add_subcommand("resume", resume_text);
  checkpoint = add_text(*resume, "FILE", "Checkpoint, an .exr of --checkpoint");
  merge = app.add_subcommand("merge", merge_text);
  merged = add_text(*merge, "OUT", "Image to write");
  parts = merge->add_option_function<std::vector<std::string>>(
      "IN", [](const std::vector<std::string>&) {}, "Checkpoints of parts");
  allow_missing = add_flag(*merge, "--allow-missing", "Pixels without samples are black");
  keep_sums = add_flag(*merge, "--keep-sums", "OUT, an .exr, is a checkpoint, too");
  verify = app.add_subcommand("verify", verify_text);
  verified = add_text(*verify, "IMAGE", "Image to verify, .exr or .png");
  share = add_text(*verify, "--share", "Share of the pixels, above 0, at most 1");
  share->type_name("X [0.01]");
  view = app.add_subcommand("view", view_text);
  viewed = add_text(*view, "SCENE", "Built-in scene or file, as --scene takes it");
  port = add_text(*view, "--port", "Port of the page; 0: any free one");
  port->type_name("N [8080]");
  advise = app.add_subcommand("advise", advise_text);
  advised = add_text(*advise, "SCENE", "Built-in scene or file, as --scene takes it");
  for (CLI::Option* file : {checkpoint, merged, verified, viewed, advised})
    file->type_name("")->multi_option_policy(CLI::MultiOptionPolicy::Throw);
  parts->type_name("");
  for (CLI::App* command : {resume, merge, verify, view, advise})
    command->allow_extras()->fallthrough();
}

const CLI::App* Parser::rendering_subcommand() const {
  for (const CLI::App* command : {resume, verify, view, advise})
    if (command->parsed()) return command;
  return nullptr;
}

// CLI11 prints no option without a group.
std::string Parser::help() {
  for (const auto& [entry, option] : options)
    if (entry->is_expert) option->group("");
  for (CLI::Option* option : {list_kernels, reference}) option->group("");
  std::string text = app.help();
  if (const CLI::App* command = rendering_subcommand())
    text += fmt::format("`ptexp {} --help-all` also lists the options of rendering.\n",
                        command->get_name());
  else if (app.get_subcommands().empty())
    text += "`ptexp --help-all` also lists the options that only experiments need.\n";
  return without_double_gaps(text);
}

std::string Parser::all_help() {
  std::string text = app.help();
  if (rendering_subcommand() != nullptr) {
    for (CLI::Option* option : app.get_options())
      if (option->get_group() == information) option->group("");
    CLI::Formatter formatter;
    formatter.column_width(help_column);
    text += "\n" + formatter.make_groups(&app, CLI::AppFormatMode::Normal);
  }
  return without_double_gaps(text);
}

CommandText Parser::describe() const {
  CommandText program = pt::describe(app);
  for (CommandText& one : program.subcommands) {
    for (const CLI::App* renders : {resume, verify, view, advise})
      one.takes_render_options |= one.name == renders->get_name();
  }
  return program;
}

}  // namespace pt
