// `foci events`: labels and events of a recording, or how well they agree with people's.
#pragma once

namespace CLI {
class App;
}

namespace foci {

/// Adds the sub-command; it runs while the command line is parsed. Bad input leaves as InputError.
void addEventsCommand(CLI::App& app);

}  // namespace foci
