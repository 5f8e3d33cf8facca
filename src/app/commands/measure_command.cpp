#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/commands.h"
#include "app/render/render_outputs.h"
#include "app/render/render_session.h"
#include "app/report/film_header.h"
#include "app/terminal/process.h"
#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/error/terminal.h"

namespace pt {
namespace {

using AnswerJson = nlohmann::ordered_json;

/// A line of the standard input without its end; none at the end of the input. Throws Error.
std::optional<std::string> read_line() {
  char* text = nullptr;
  std::size_t capacity = 0;
  const ssize_t length = ::getline(&text, &capacity, stdin);
  const std::unique_ptr<char, decltype(&std::free)> owner(text, std::free);
  if (length < 0 && std::ferror(stdin)) throw Error("measure: the standard input cannot be read");
  if (length < 0) return std::nullopt;
  std::string line(text, static_cast<std::size_t>(length));
  if (line.ends_with('\n')) line.pop_back();
  return line;
}

/// Throws Error for everything but a render that one process makes and measures.
RenderCommand read_configuration(const std::string& line) {
  const AnswerJson json = AnswerJson::parse(line, nullptr, false);
  const bool is_object = json.is_object() && json.size() == 1 && json.contains("arguments");
  const AnswerJson words = is_object ? json["arguments"] : AnswerJson();
  bool are_words = words.is_array();
  for (const AnswerJson& word : words) are_words &= word.is_string();
  if (!are_words) {
    throw Error(R"(measure: expected a line {"arguments": ["--scene", "cornell", ...]}, the )"
                "options of a render as strings");
  }
  const Command command = parse_command_line(words.get<std::vector<std::string>>());
  const auto* render = std::get_if<RenderCommand>(&command);
  if (render == nullptr)
    throw Error("measure: these arguments ask for no render; expected options of one");
  for (const char* name : {"checkpoint", "part", "explain"}) {
    if (render->given.contains(name))
      throw Error(fmt::format("--{}: has no effect together with measure", name));
  }
  return *render;
}

/// The scene that was rendered last.
class KeptScene {
 public:
  /// A session with the scene that the command names, which is loaded unless it is the last one and
  /// its files are as they were. What it takes is added to `load_ms`.
  RenderSession& get(const RenderCommand& command, double& load_ms) {
    const std::string options = loading_options(command.options);
    if (session_ && options == options_ && files_ == state_of_files()) return *session_;
    ProcessClock clock;
    session_.reset();  // its memory is needed
    session_ = std::make_unique<RenderSession>(
        command, command.options.quiet ? RenderSession::Warn() : print_warning);
    options_ = options;
    files_ = state_of_files();
    clock.end(&ProcessTimes::scene);
    load_ms += clock.times().scene;
    return *session_;
  }

 private:
  /// The camera, too: some default lighting follows it.
  static std::string loading_options(const Options& options) {
    std::string text;
    for (const OptionEntry& entry : option_list()) {
      if (entry.group == OptionGroup::scene || entry.group == OptionGroup::camera)
        text += entry.name + ' ' + entry.text(options) + '\n';
    }
    return text;
  }

  /// Size and time of each.
  std::string state_of_files() const {
    std::string text;
    for (const std::string& file : session_->scene().source_files) {
      std::error_code missing;
      const auto time = std::filesystem::last_write_time(file, missing).time_since_epoch().count();
      text += fmt::format("{} {}\n", std::filesystem::file_size(file, missing), time);
    }
    return text;
  }

  std::unique_ptr<RenderSession> session_;
  std::string options_, files_;
};

struct Interrupted {};

/// Renders and writes what the command says. Throws Error, or Interrupted by a signal.
AnswerJson measure_one(const RenderCommand& command, KeptScene& kept) {
  const bool writes_image = command.given.contains("output");
  check_outputs(command.options, writes_image);
  double load_ms = 0;
  RenderSession& session = kept.get(command, load_ms);
  const SceneData& scene = session.scene();
  check_not_of_scene(command.options, scene.source_files);
  MeasureHooks hooks;
  hooks.begin = [](const std::string&) { note_signals(); };
  hooks.stop = interrupted;
  RenderResult result = session.render(command, hooks, print_warning);
  if (result.interrupted) throw Interrupted();
  const Options& options = result.options;
  RenderReport& report = result.report;
  report.scene_ms += load_ms;
  report.process_ms.scene += load_ms;
  if (const auto exposure =
          exposure_for(options.output, options.exposure, result.image, result.measures_exposure))
    report.exposure = exposure->stops;
  if (writes_image) {
    ProcessClock clock;
    const ImageMetadata header = image_header(options, report, scene.source_hash);
    write_image(options.output, result.image, header, {report.exposure.value_or(0.0f)});
    clock.end(&ProcessTimes::image);
    report.image_write_ms = clock.times().image;
    report.process_ms.image += report.image_write_ms;
  }
  Attempts attempts;
  write_statistics(options, report, attempts);
  attempts.check();
  AnswerJson answer;
  answer["statistics"] = AnswerJson::parse(report_json(options, report));
  for (const auto& [column, value] : report_csv_row(options, report)) answer["row"][column] = value;
  return answer;
}

AnswerJson error_answer(const std::string& message, int exit_code) {
  return {{"error", message}, {"exit_code", exit_code}};
}

}  // namespace

int measure_command() {
  KeptScene kept;
  while (const std::optional<std::string> line = read_line()) {
    AnswerJson answer;
    try {
      answer = measure_one(read_configuration(*line), kept);
    } catch (const Interrupted&) {
      answer = error_answer("interrupted", exit_code_of_signal());
    } catch (const std::exception& error) {
      answer = error_answer(message_of(error), 2);
    }
    print_text(answer.dump(-1, ' ', true, AnswerJson::error_handler_t::replace) + '\n');
    flush_output();
    end_on_signal();
    if (interrupted()) return exit_code_of_signal();
  }
  return 0;
}

}  // namespace pt
