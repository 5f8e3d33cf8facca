// `ptexp [options]`: renders, writes the image and reports.
#pragma once

#include "app/options/command_line.h"
#include "app/render/rendering.h"

namespace pt {

/// Returns the exit code: 0, or 128 + N after signal N, the image and the checkpoint then holding
/// the samples that were finished. Throws Error; outputs that cannot be written are refused before
/// any work.
/// `ranks`: of the job; the first one prints and writes, the others work for it.
int render_command(const RenderCommand& command, Ranks& ranks,
                   const Resumption* resumption = nullptr);

}  // namespace pt
