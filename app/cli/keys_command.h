// `foci keys`: what a study may hold.
#pragma once

namespace CLI {
class App;
}

namespace foci {

void addKeysCommand(CLI::App& app);

}  // namespace foci
