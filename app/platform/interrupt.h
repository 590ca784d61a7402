// Ctrl-C, termination and a closed terminal end a run like an error: no half-written file stays.
#pragma once

namespace foci {

/// From now on the first SIGINT, SIGTERM or SIGHUP only sets a flag. Another one, two seconds later
/// or more, ends the process.
void noteInterrupts();

bool isInterrupted();

/// @throws std::runtime_error after a signal
void throwIfInterrupted();

}  // namespace foci
