// `foci methods`: the depth-of-field methods, a line and a source each.
#pragma once

namespace CLI {
class App;
}

namespace foci {

/// Adds the sub-command; it runs while the command line is parsed.
void addMethodsCommand(CLI::App& app);

}  // namespace foci
