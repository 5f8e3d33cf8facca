// What is printed counts as a result: if it cannot be written, the program has failed.
#pragma once

namespace pt {

/// To be called first: a stream that is closed stays so, and no file takes its place and gets the
/// messages; a limit of a file's size (SIGXFSZ) and a reader that has gone (SIGPIPE) are errors of
/// the one write, not the end of the program.
void guard_streams();

/// Writes what was printed so far. Throws Error when that, or a print before, did not succeed.
/// Where the reader has gone, the program ends by SIGPIPE, as others do.
void flush_output();

}  // namespace pt
