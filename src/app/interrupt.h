// Ctrl-C ends a render early but keeps what it has.
#pragma once

namespace pt {

/// From now on the first SIGINT only makes interrupted() true; a second one ends the program as
/// usual.
void catch_interrupt();

bool interrupted();

}  // namespace pt
