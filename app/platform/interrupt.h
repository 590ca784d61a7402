// Ctrl-C and termination end a run like an error: no half-written file stays.
#pragma once

namespace foci {

/// From now on the first SIGINT or SIGTERM only sets a flag. A second signal ends the process.
void noteInterrupts();

bool isInterrupted();

/// @throws std::runtime_error after a signal
void throwIfInterrupted();

}  // namespace foci
