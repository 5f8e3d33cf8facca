// What is printed counts as a result: if it cannot be written, the program has failed.
#pragma once

namespace pt {

/// Writes what was printed so far. Throws Error when that, or a print before, did not succeed.
void flush_output();

}  // namespace pt
