// Ctrl-C, termination and a closed terminal end a run like an error: no half-written file stays.
#pragma once

namespace foci {

/// From now on SIGINT, SIGTERM and SIGHUP remove the outputs that are not committed
/// (output_files.h), print a line, and end the process with exit code 1. A signal that is ignored
/// stays so. Also keeps up the heartbeat of those outputs. Call it before other threads begin.
void endCleanlyOnInterrupts();

/// For a loop that ends by itself: from now on the first signal only sets a flag. Another one, two
/// seconds later or more, ends the process as above.
void noteInterrupts();

bool isInterrupted();

}  // namespace foci
