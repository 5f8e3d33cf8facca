#include "app/commands/resume_command.h"

#include <fmt/format.h>

#include "app/report/film_header.h"
#include "common/error/error.h"
#include "common/image/atomic_file.h"
#include "common/options/option_names.h"

namespace pt {
namespace {

/// What the film has, and what more is wanted, go together.
void check_samples(const ImageFilm& film, const Options& before, const Options& options,
                   const std::string& file) {
  std::uint32_t most = 0;
  for (const FilmPart& part : film.parts) most = std::max(most, part.next_sample);
  if (most > static_cast<std::uint32_t>(options.spp)) {
    throw Error(fmt::format("--spp {}: {} has pixels with {} samples; expected at least as many",
                            options.spp, file, most));
  }
  if (options.spp != before.spp && options.sampler == SamplerKind::stratified) {
    throw Error(
        fmt::format("--spp {}: {} was begun for {} samples, over which --sampler stratified "
                    "spreads them; expected the same",
                    options.spp, file, before.spp));
  }
}

}  // namespace

int resume_command(const ResumeCommand& command, Ranks& ranks) {
  const Resumption resumption{command.file, read_checkpoint(command.file)};
  const Options before = options_in_header(resumption.checkpoint.metadata, command.file);
  RenderCommand render;
  render.options = before;
  // How it was measured and where it ended are no part of what is continued.
  render.options.checkpoint.file = command.file;
  render.options.explain = false;
  apply_settings(command.settings, command.file, render.options);
  for (const Setting& setting : command.settings) render.given.insert(setting.entry->name);
  check_consistent(render.options, render.given);
  if (render.options.part.count == 1)
    check_not_read("--output", render.options.output, command.file);
  check_samples(resumption.checkpoint.film, before, render.options, command.file);
  // The file's own defaults were applied when the render was begun.
  for (const char* name : {"width", "height", "spp", "max-depth", "rr"}) render.given.insert(name);
  return render_command(render, ranks, &resumption);
}

void check_resumption(const Resumption& resumption, const Options& options,
                      const std::string& scene_hash, const std::vector<DeviceInfo>& devices) {
  const std::string kind = to_string(devices.front().choice.kind);
  check_same_render(resumption.checkpoint.metadata, resumption.file,
                    film_header(options, scene_hash, kind), "this render");
}

}  // namespace pt
