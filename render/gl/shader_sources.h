// The texts of shaders/, which the build compiles in.
#pragma once

#include <string>

namespace foci {

/// @param stage  a file of shaders/ without its ending; must exist (asserted)
std::string shaderSource(const std::string& stage);

}  // namespace foci
