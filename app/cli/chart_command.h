// foci chart: every method's time against its distance from the reference; with --stability where
// each gives way.
#pragma once

namespace CLI {
class App;
}

namespace foci {

/// Adds `chart` to the command line; it runs as the arguments are parsed.
void addChartCommand(CLI::App& app);

}  // namespace foci
