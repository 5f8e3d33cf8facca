// Signals, standard streams and the age of the process.
#pragma once

namespace pt {

// SIGINT (Ctrl-C), SIGTERM and, on request, SIGUSR1 (a cluster's warning) end the program early but
// keep what it has.

/// From now on these signals end the program at once with exit code 128 + their number: there is
/// nothing yet to keep, and an unfinished file is removed. Prints "interrupted" and `what_is_lost`,
/// a literal.
void end_on_signal(const char* what_is_lost = "");

/// From now on SIGINT and SIGTERM, however often they come, only make interrupted() true: results
/// are saved, and only the reader of a pipe who does not read stops that. `usr1`: the same for
/// SIGUSR1, which Slurm sends before a time limit; else it still ends the program at once.
void note_signals(bool usr1 = false);

/// From now on signals do nothing: another process of the job gets them, too, and handles them.
void ignore_signals();

bool interrupted();

/// 128 and the signal's number, as shells have it: 130 after SIGINT, 143 after SIGTERM.
int exit_code_of_signal();

/// Seconds since the process was begun, in steps of the kernel's clock (10 ms); 0 where /proc is
/// not there.
double process_age_s();

// What is printed is a result: if it cannot be written, the program has failed.

/// To be called first. A closed stream stays closed: no file takes its place and gets the messages.
/// A file size limit (SIGXFSZ) and a reader that has gone (SIGPIPE) are errors of one write and do
/// not end the program.
void guard_streams();

/// Writes what was printed so far. Throws Error when that, or a print before, did not succeed. If
/// the reader has gone, the program ends by SIGPIPE, as others do.
void flush_output();

}  // namespace pt
