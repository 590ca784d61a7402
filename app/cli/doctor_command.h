// `foci doctor`: what this machine offers, and what it lacks.
#pragma once

namespace CLI {
class App;
}

namespace foci {

void addDoctorCommand(CLI::App& app);

}  // namespace foci
