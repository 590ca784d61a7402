// Ctrl-C and termination end a run as an error does: nothing half-written stays.
#pragma once

namespace foci {

/// From now on SIGINT and SIGTERM are noted rather than deadly; a second one is deadly again.
void noteInterrupts();

bool isInterrupted();

/// @throws std::runtime_error once a signal has been noted
void throwIfInterrupted();

}  // namespace foci
