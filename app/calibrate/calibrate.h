// `foci calibrate screen | gaze | camera`.
#pragma once

namespace CLI {
class App;
}

namespace foci {

/// Adds the sub-command; it runs while the command line is parsed. Bad input leaves as InputError.
void addCalibrateCommand(CLI::App& app);

}  // namespace foci
