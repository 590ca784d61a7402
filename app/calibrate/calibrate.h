// `foci calibrate screen | gaze | binocular | camera`.
#pragma once

namespace CLI {
class App;
}

namespace foci {

/// Adds the sub-command, which runs while CLI11 parses the command line. Bad input throws
/// InputError.
void addCalibrateCommand(CLI::App& app);

}  // namespace foci
