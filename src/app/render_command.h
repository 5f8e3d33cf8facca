// `ptexp [options]`: renders, writes the image and reports.
#pragma once

#include <optional>
#include <string>

#include "app/options/command_line.h"
#include "common/film/checkpoint.h"
#include "common/mpi/ranks.h"

namespace pt {

/// A film that a render goes on with, and the file that it was in.
struct Resumption {
  std::string file;
  Checkpoint checkpoint;
};

/// Returns the exit code: 0, or 128 + N after signal N, the image and the checkpoint then holding
/// the samples that were finished. Throws Error; outputs that cannot be written are refused before
/// any work.
/// `ranks`: of the job; the first one prints and writes, the others work for it.
int render_command(const RenderCommand& command, Ranks& ranks,
                   const Resumption* resumption = nullptr);

}  // namespace pt
