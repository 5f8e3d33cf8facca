// SIGINT (Ctrl-C) and SIGTERM (a cluster's warning) end the program early but keep what it has.
#pragma once

namespace pt {

/// From now on both signals end the program at once, with 128 and its number as the exit code:
/// nothing is there yet that could be kept, and half a file is removed. "interrupted" and
/// `what_is_lost`, a literal, are printed.
void end_on_signal(const char* what_is_lost = "");

/// From now on they only make interrupted() true, however often they come: what there is will be
/// saved, and nothing must stop that.
void note_signals();

bool interrupted();

/// 128 and the signal's number, as shells have it: 130 after SIGINT, 143 after SIGTERM.
int exit_code_of_signal();

}  // namespace pt
