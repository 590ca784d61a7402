// `foci trace info|convert`: what a recording is, and the same as BIDS.
#pragma once

namespace CLI {
class App;
}

namespace foci {

/// Adds the sub-command; it runs while the command line is parsed. Bad input leaves as InputError.
void addTraceCommand(CLI::App& app);

}  // namespace foci
