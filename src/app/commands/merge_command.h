// `ptexp merge OUT IN...`: joins the checkpoints of an image's parts.
#pragma once

#include "app/options/command_line.h"

namespace pt {

/// Writes the image that one render of all parts would have written. Pixels that several files have
/// must have the same bits: a device that computes wrongly is found so. Throws Error, naming files
/// and pixels, where they have not, where samples are missing, and for files of other renders.
int merge_command(const MergeCommand& command);

}  // namespace pt
