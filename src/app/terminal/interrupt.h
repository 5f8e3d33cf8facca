// SIGINT (Ctrl-C), SIGTERM and, where it is wanted, SIGUSR1 (a cluster's warnings) end the program
// early but keep what it has.
#pragma once

namespace pt {

/// From now on they end the program at once, with 128 and their number as the exit code: nothing is
/// there yet that could be kept, and half a file is removed. "interrupted" and `what_is_lost`, a
/// literal, are printed.
void end_on_signal(const char* what_is_lost = "");

/// From now on SIGINT and SIGTERM only make interrupted() true, however often they come: what there
/// is will be saved, and nothing must stop that but the reader of a pipe who does not come. `usr1`:
/// SIGUSR1, too, which Slurm sends before a time limit; else it still ends the program at once.
void note_signals(bool usr1 = false);

/// From now on they do nothing: another process of the job, which gets them, too, says what
/// happens.
void ignore_signals();

bool interrupted();

/// 128 and the signal's number, as shells have it: 130 after SIGINT, 143 after SIGTERM.
int exit_code_of_signal();

}  // namespace pt
