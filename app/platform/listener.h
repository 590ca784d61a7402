// Who hears what foci says to the user (`say`): standard error, unless a program takes its place.
#pragma once

#include <string>

namespace foci {

void sayTo(void (*listener)(const std::string& text));

}  // namespace foci
